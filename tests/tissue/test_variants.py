"""Each rule of the table of model variants changes what it names, by the factor it names, and nothing else.

Every force, rest length, radius, event and draw is measured by itself, in small tissues. Then one key of the parameters
is changed: what is listed here must change so, and all the rest must stay as it is.
"""

from fnmatch import fnmatch

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue.kernel_calls import Tissue, make_substeps, upright, with_emt
from tissue.files.keys import all_keys
from tissue.files.parameters import Parameters, preset
from tissue.runs.start import first_state
from tissue.state.running import contents

BASE = preset("published")
# Of the five cells of ``in_all_phases``, in this order; the last one is in mitosis and has no INM.
PHASES, AGES = ("G1", "G1 again", "G2", "mitosis", "resting"), (5.0, 5.0, 11.25, 11.75, 11.75)
CYCLE = 12.0
JUNCTIONS = ("G1-G1", "G1-G2", "G2-mitosis", "mitosis-resting")
STIFF = ("stiff_ax", "stiff_bx", "stiff_axb", "stiff_aa")
# Displacements of 1e-3 of points that are some 10 away have lost four digits; factors differ by far more.
ROUNDING = 1e-10
REST = {"rest_ax": 1.2, "rest_bx": 1.3, "rest_aa": 0.2}


def started(parameters, **changes):
    """Cells as they start, without discs to part."""
    start = parameters.start_numbers()._replace(**changes)
    numbers = parameters.numbers()._replace(hard_radius=0.0, enlarged_radius=0.0)
    return contents(first_state(start, numbers, np.random.default_rng(7)))


def in_all_phases(parameters):
    """Five cells as they start, put where soft discs meet and hard ones do not, in the phases above."""
    cells, network = started(parameters, cells=5, nuclei="own_basal")
    k = np.arange(5)
    points = {"x": 0.25 * k, "y": 0.8 + 1.6 * k, "ax": 0.4 * k + 0.1, "ay": np.full(5, 9.0), "bx": 0.25 * k}
    ages = {"birth": -np.array(AGES), "cycle": np.full(5, CYCLE), "moves": k < 4}
    rests = {"rest_ax": np.full(5, 2.0), "rest_bx": np.full(5, 2.5), "rest_aa": np.full(5, 0.3)}
    return Tissue(cells._replace(**points, **ages, **rests), network, 5)


def ruled(state, given):
    """The tissue after the rules of t = 0, without noise."""
    return kernels.ruled(state, 0.0, given._replace(variance=0.0), 3)


def pushed(state, given, *acting):
    """By how much one substep moves the points where only these stiffnesses act, or the repulsion, at fixed rests."""
    n = len(state.cells.x)
    fixed = REST | {name: 0.0 for name in STIFF if name not in acting}
    cells = state.cells._replace(**{name: np.full(n, value) for name, value in fixed.items()})
    once = given._replace(dt=given.dt / given.substeps, substeps=1, noise_in_substeps=False)
    once = once._replace(repulsion=once.repulsion * ("repulsion" in acting))
    after = make_substeps(cells, state.layers, once)
    return {name: getattr(after, name) - getattr(cells, name) for name in kernels.COORDINATES}


def cycle(parameters):
    """Rest lengths, radii and forces by phase."""
    given = parameters.numbers()
    after = ruled(in_all_phases(parameters), given)
    springs = [pushed(after, given, part) for part in ("stiff_ax", "stiff_bx", "stiff_axb")]
    junctions = pushed(after, given, "stiff_aa")["ax"]
    found = {"repulsion": pushed(after, given, "repulsion")["y"][0]}
    found |= {f"junction {pair}": pull for pair, pull in zip(JUNCTIONS, np.cumsum(junctions), strict=False)}
    for i, phase in enumerate(PHASES):
        found |= {f"rest {name} {phase}": getattr(after.cells, f"rest_{name}")[i] for name in ("ax", "bx", "aa")}
        found |= {f"radius {phase}": after.cells.radius[i], f"spring ax {phase}": springs[0]["ay"][i]}
        found |= {f"spring bx {phase}": springs[1]["y"][i], f"bending {phase}": springs[2]["ax"][i]}
    return found


def division(parameters):
    """How many divide, how far their daughters are apart, and what they begin with."""
    given = parameters.numbers()
    many = ruled(upright(200, birth=-12.0, cycle=12.0), given)
    two = ruled(upright(1, birth=-12.0, cycle=12.0), given._replace(two_daughters=1.0)).cells
    return {
        "daughters": len(many.cells.x) - 200,
        "cycles": many.cells.cycle.sum(),
        "offset": two.x[1] - two.x[0],
        "daughter junction": two.rest_aa[0],
    }


def draws_and_sweeps(parameters):
    """Noise of nuclei without forces; hard discs and the basal layer after a sweep from a wrong state."""
    given = parameters.numbers()._replace(two_daughters=0.0, repulsion=0.0, junction_factor=0.0)
    still = dict.fromkeys(STIFF, 0.0)
    state = upright(20, **still)
    end = kernels.steps(state, 0, 1, given, *kernels.generators(5)).cells
    pair = upright(2, spacing=0.1, **still)
    swept = make_substeps(ruled(pair, given).cells, pair.layers, given._replace(noise_in_substeps=False))
    row = upright(2, spacing=5.0, **still)
    basal = make_substeps(row.cells, row.layers, given._replace(substeps=1, noise_in_substeps=False))
    return {"noise": end.x - state.cells.x, "contact": swept.x[1] - swept.x[0], "basal": basal.bx[1] - basal.bx[0]}


def start(parameters):
    """Places, ages and springs of the first state."""
    cells, _ = started(parameters)
    return {
        "start cells": len(cells.x),
        "start ages": np.concatenate((cells.birth, cells.cycle)),
        "start nuclei x": cells.x,
        "start nuclei y": cells.y,
        "start apical x": cells.ax,
        "start apical y": cells.ay,
        "start basal x": cells.bx,
        "start rest": np.concatenate((cells.rest_ax, cells.rest_bx)),
        "start junction": cells.rest_aa,
    }


def events(parameters):
    """What [A], [B], [S] and [P] make of the springs of the middle one of three cells, and of its basal point."""
    given, found = parameters.numbers(), {}

    def after(basal_y=0.0, **times):
        return ruled(with_emt(_three_cells(parameters, basal_y), [1], **times), given)

    freed = after(a=0.0)
    found |= {"[A] rest": freed.cells.rest_ax[1], "[A] bridge": freed.cells.rest_aa[0]}
    found["[A] spring"] = pushed(freed, given, "stiff_ax")["ay"][1]
    freed = after(b=0.0)
    found |= {"[B] rest": freed.cells.rest_bx[1], "[B] spring": pushed(freed, given, "stiff_bx")["y"][1]}
    found["[S] bending"] = pushed(after(s=0.0), given, "stiff_axb")["ax"][1]
    for where, y in (("above", 0.5), ("below", -0.5), ("at depth", -2.2)):
        freed = after(y, b=0.0, p=0.0)
        found |= {f"[P] rest {where}": freed.cells.rest_bx[1], f"[P] way {where}": way(freed, given)}
        found[f"[P] spring {where}"] = pushed(freed, given, "stiff_bx")["y"][1]
    return found


def _three_cells(parameters, basal_y):
    """Bent a little, in the layers, the basal point of the middle one at this height."""
    cells, network = started(parameters, cells=3, nuclei="own_basal")
    k = np.arange(3)
    points = {"x": 4.0 * k, "y": np.full(3, 4.0), "ax": 4.0 * k + 0.5, "ay": np.array([8.0, 9.0, 8.0]), "bx": 4.0 * k}
    rests = {"rest_ax": np.full(3, 1.5), "rest_bx": np.full(3, 2.5), "rest_aa": np.array([0.3, 0.4, 0.5])}
    basal = {"by": np.where(k == 1, basal_y, 0.0), "birth": np.full(3, -5.0), "cycle": np.full(3, CYCLE)}
    return Tissue(cells._replace(**points, **rests, **basal), network, 3)


def way(state, given):
    """How far a free basal point goes in one dt, by itself and by its spring, upright below its nucleus."""
    quiet = given._replace(variance=0.0, repulsion=0.0, junction_factor=0.0)
    alone = state._replace(cells=state.cells._replace(stiff_ax=np.zeros(3), stiff_axb=np.zeros(3)))
    return kernels.steps(alone, 0, 1, quiet, *kernels.generators(0)).cells.by[1] - state.cells.by[1]


def probes(parameters):
    """All that is measured, by name."""
    parts = (cycle, division, draws_and_sweeps, start, events)
    return {name: value for part in parts for name, value in part(parameters).items()}


# What one dt or substep does, all of it: what moves by itself, by forces, by relaxation or by noise.
RELAXED = ["rest *", "daughter junction", "[[]A] rest", "[[]A] bridge", "[[]B] rest", "[[]P] rest *"]
FORCES = ["spring *", "bending *", "junction *", "repulsion", "[[]?] spring*", "[[]S] bending"]
WAYS = ["[[]P] way *"]
DEPTH = {"[[]P] way at depth": None}  # where the point follows its spring
# Key: the new value, and by what factor each probe changes whose name is like this; None: it changes.
CHANGES = {
    "tissue.cells": (30, {"start *": None}),
    "tissue.height": ("9 R_soft", {"start apical y": 9 / 8, "start nuclei y": 9 / 8}),
    "tissue.width": ("20 R_soft", {"start nuclei x": None}),
    "tissue.apical_spacing": ("1/6 R_soft", {"start apical x": 1 / 2}),
    "tissue.basal_spacing": ("1/6 R_soft", {"start basal x": 1 / 2}),
    "tissue.max_basal_distance": ("2/3 R_soft", {"basal": 2}),
    "tissue.two_daughters": ("1/2", {"daughters": None, "cycles": None}),
    "tissue.diffusion": ("0.4 R_soft^2/h", {"noise": 2}),
    "cell.hard_radius": (
        "0.4 R_soft",
        {"radius G1*": 4 / 3, "radius G2": 4 / 3, "radius resting": 4 / 3, "contact": 4 / 3},
    ),
    "cell.enlarged_radius": ("0.75 R_soft", {"radius mitosis": 75 / 70}),
    "cell.initial_rest_length": ("4 R_soft", {"start rest": 8 / 3}),
    "cell.max_cytoskeleton": (
        "0.5 R_soft",
        {
            "rest ax G1*": None,
            "rest ax resting": None,
            "rest bx G1 again": None,
            "rest bx [!G]*": None,
            "rest bx G2": None,
        },
    ),
    "cell.g2": ("0.2 h", {"junction G1-G2": 2 / 3, "junction G2-mitosis": 3 / 4, "rest ?x G2": None}),
    "cell.mitosis": (
        "0.2 h",
        {"radius mitosis": 3 / 7, "junction G1-G2": 2 / 3, "junction G2-mitosis": 3 / 4, "rest ?x G2": None},
    ),
    "cell.min_cycle": ("12 h", {"cycles": None, "start ages": None}),
    "cell.max_cycle": ("30 h", {"cycles": None, "start ages": None}),
    "cell.rate_aa": (
        "2 1/h",
        {"rest aa *": np.exp(-0.05), "daughter junction": np.exp(-0.05), "[[]A] bridge": np.exp(-0.05)},
    ),
    "cell.rate_ax": ("10 1/h", {"rest ax *": None, "[[]A] rest": np.exp(-0.25)}),
    "cell.rate_bx": ("10 1/h", {"rest bx *": None, "[[]B] rest": np.exp(-0.25)}),
    "cell.alpha_aa": (15, {"junction *": 3}),
    "cell.alpha_ax": (6, {"spring ax *": 3, "[[]A] spring": 3}),
    "cell.alpha_bx": (6, {"spring bx *": 3, "[[]B] spring": 3, "[[]P] spring *": 3, **DEPTH}),
    "cell.alpha_xx": (3, {"repulsion": 3}),
    "cell.alpha_axb": (45, {"bending *": 3}),
    "numerics.mu": ("0.4 h", dict.fromkeys(FORCES, 1 / 2) | DEPTH),
    "numerics.dt": (
        "0.1 h",
        dict.fromkeys(FORCES, 2) | dict.fromkeys((*RELAXED, "[[]P] way *")) | {"noise": np.sqrt(2)},
    ),
    "numerics.substeps": (80, dict.fromkeys(FORCES, 1 / 2) | DEPTH),
    "numerics.noise": ("substep", {"noise": None}),
    "rules.spring_power": (
        1,
        {"spring ax *": 2.2, "[[]A] spring": 2.2, "spring bx *": 2.3, "[[]B] spring": 2.3, "[[]P] spring *": 2.3}
        | DEPTH,
    ),
    "rules.junction_factor": (1, {"junction *": 4}),
    "rules.repulsion_factor": (2, {"repulsion": 4}),
    "rules.floor_rest_length": (False, {"rest bx G1": None}),
    "rules.enlarge_from": ("G2", {"radius G2": 7 / 3}),
    "rules.g2_stiffening": (4, {"junction G1-G2": 5 / 3, "junction G2-mitosis": 2, "junction mitosis-resting": 5 / 3}),
    "rules.resting_cells_enlarge": (True, {"radius resting": 7 / 3, "junction mitosis-resting": 4 / 3}),
    "division.offset": ("0.01 R_soft", {"offset": 1 / 5}),
    "division.new_junction": ("2/3 R_soft", {"daughter junction": 2, "start junction": 2}),
    "start.nuclei": ("own_basal", {"start nuclei *": None}),
    "start.nuclei_height": (["1/3", "2/3"], {"start nuclei y": None}),
    "events.freed_stiffness": (
        0.3,
        {"[[]A] spring": 3, "[[]B] spring": 3, "[[]P] spring *": 3, **DEPTH},
    ),
    "events.bridge": ("distance", {"[[]A] bridge": 8 / 0.7}),
    "events.bent_stiffness": (3, {"[[]S] bending": 3}),
    "events.run_speed": (
        "3 R_soft/h",
        {"[[]P] rest above": 2.65 / 2.55, "[[]P] way above": None, "[[]P] way below": None},
    ),
    "events.run_depth": ("3 R_soft", DEPTH),
    "events.spring_above": ("no force", {"[[]P] rest above": None, "[[]P] spring above": 0}),
    "events.contraction": (
        "1 h",
        {"[[]P] rest below": np.exp(0.1), "[[]P] rest at depth": np.exp(0.1), **DEPTH},
    ),
    "events.at_depth": ("stays", {"[[]P] way at depth": 0}),
}
# Keys that no step depends on, and those with tests of their own: times of events, [AC], divisions.
WHOLE = ("emt", "layer", "own", "space", "types")
ASIDE = (
    "tissue.dimension",
    "cell.soft_radius",
    "numerics.t_end",
    "numerics.keep",
    "numerics.folded",
    "division.rule",
    *(f"{name}.*" for name in WHOLE),
)


def expected(name, changes):
    """Whether a probe changes, and by what factor."""
    found = [factor for pattern, factor in changes.items() if fnmatch(name, pattern)]
    return bool(found), found[0] if found else None


@pytest.fixture(scope="module")
def before():
    return probes(BASE)


@pytest.mark.parametrize("key", CHANGES)
def test_a_rule_changes_what_it_names(before, key):
    value, changes = CHANGES[key]
    after = probes(BASE.changed({key: value}))
    for name, old in before.items():
        changed, factor = expected(name, changes)
        same = np.shape(after[name]) == np.shape(old) and np.allclose(after[name], old, rtol=ROUNDING, atol=0.0)
        assert changed == (not same), f"{name}: {old} -> {after[name]}"
        if factor is not None:
            np.testing.assert_allclose(after[name], factor * np.asarray(old), rtol=1e-9, atol=0.0, err_msg=name)
    assert all(any(fnmatch(name, pattern) for name in before) for pattern in changes)


def test_every_key_is_tried():
    assert set(CHANGES) == {key for key in all_keys(Parameters) if not any(fnmatch(key, rule) for rule in ASIDE)}
