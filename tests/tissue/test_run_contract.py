"""A run of any tissue has the same bits alone, in company, in threads and from each saved state; how runs go on."""

import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from dincl.status import Status
from tests.tissue.bits import same, same_end
from tests.tissue.space.in_space import SURFACES, of_surface
from tests.tissue.test_types import MIXED
from tests.tissue.users import LAYERS, LIVELY, SHORT, own_module
from tissue.events.known import bit
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.runs.simulate import simulate, simulate_many
from tissue.state.cells import NAMED

# A run that goes on later may end before an event.
pytestmark = pytest.mark.filterwarnings("ignore:.* never begins")

EMT = {"emt.cells": 5, "emt.inm": 0.5, "emt.a": "0 h to 3 h", "emt.b": "0.5 h to 2 h", "emt.s": "1 h", "emt.p": "2 h"}
LEAVING = {"cells": 3, "place": 0.9, "divides": False, "inm": 0.5, "a": "2 h", "alpha_ax": 3}
QUICK = {"cells": 6, "place": "scattered", "min_cycle": "1 h", "max_cycle": "1.5 h", "g2": "0.2 h", "b": "1 h"}
BIG = {"cells": 6, "place": 0.2, "soft_radius": "7 um", "alpha_xx": 4, "max_basal_distance": "2/3 R_soft"}
TUBE = {"layer.shape": "circle", "layer.perimeter": "60 R_soft", "layer.closed": True, "tissue.cells": 180}
TYPES = {f"types.{name}.{key}": value for name, one in
         (("leaving", LEAVING), ("quick", QUICK), ("big", BIG)) for key, value in one.items()}  # fmt: skip
SLICES = {
    "divisions": {},
    "EMT": EMT,
    "noise in substeps": EMT | {"numerics.noise": "substep"},
    "constriction": {"emt.cells": 6, "emt.ac": "1 h to 3 h", "emt.a": "2 h, 50 %"},
    "a cap": EMT | {"cell.max_cytoskeleton": "4 R_soft"},
    "types": TYPES | {"emt.cells": 2, "emt.s": "1 h"},
    "no cores": EMT | {"cell.hard_radius": "0 um", "cell.enlarged_radius": "0 um", "cell.alpha_xx": 0},
    "arc": EMT | TUBE | {"layer.closed": False, "tissue.cells": 60},
    "tube": EMT | TUBE | {"layer.side": "outside"},
}
FORCES = {"forces.wall": 2.0, "forces.straight": 3.0}
USERS = {f"forces on a {name}": EMT | FORCES | layer for name, layer in LAYERS.items()}
USERS["an event and a rule"] = {"emt.cells": 4, "emt.squeeze": "2 h", "emt.a": "1 h", "division.rule": "always"}
IN_SPACE = {
    "emt__cells": 3,
    "emt__a": "0.5 h",
    "emt__b": "1 h",
    "emt__s": "1 h",
    "emt__p": "1.5 h",
    "numerics__keep": "0.5 h",
}
NAMES = [f"{name}, {of}" for name in ("thesis", "published") for of in SLICES] + [*USERS, *SURFACES]


@pytest.fixture(scope="module", autouse=True)
def modules(tmp_path_factory):
    with own_module(tmp_path_factory.mktemp("own"), "module_of_contract") as file:
        yield [str(file)]


@pytest.fixture(params=NAMES)
def parameters(request, modules):
    if request.param in SURFACES:
        return of_surface(request.param, **IN_SPACE)
    name, _, of = request.param.partition(", ")
    given = preset(name if of else "published").changed({**SHORT, **LIVELY, "tissue.two_daughters": 0.5})
    return given.changed(SLICES[of] if of else {"own.modules": modules, **USERS[name]})


@pytest.mark.slow_with("published, tube", "forces on a tube", "cylinder", "sphere")
def test_alone_in_company_and_in_threads(parameters):
    """A run is a function of (parameters, seed); saved states that are left out change nothing."""
    company = simulate_many(parameters, [5, 2, 9])
    with ThreadPoolExecutor(2) as threads:
        alone = list(threads.map(lambda run: simulate(parameters, run.seed), company))
    for one, other in zip(company, alone, strict=True):
        assert one.status is Status.SUCCESS
        assert same_end(one, other)
        assert len(one.final.cells.x) > len(one.frames[0].cells.x)
    assert not np.array_equal(alone[0].final.cells.cycle[:20], alone[1].final.cells.cycle[:20])
    ends = simulate(parameters.changed({"numerics.keep": parameters.as_dict()["numerics"]["t_end"]}), 5)
    assert len(ends.frames) == 2
    assert same(ends.final, company[0].final)


@pytest.mark.slow_with("published, tube", "forces on a tube", "cylinder", "sphere")
def test_side_by_side_each_with_parameters_of_its_own(parameters):
    """The bits of each run are those that it has alone, also where another one cannot be beside it."""
    cell, numerics, mu = parameters.cell, parameters.numerics, parameters.numerics.mu.value
    given = [parameters]
    for k in (1, 2):
        own: dict[str, object] = {
            "numerics.mu": f"{(1 + k / 4) * mu:g} h",
            "cell.alpha_ax": cell.alpha_ax * (1 - k / 8),
        }
        own |= {"cell.alpha_xx": cell.alpha_xx * (1 + k / 4), "tissue.two_daughters": 0.4 * k}
        own |= {f"forces.{name}": strength * (1 + k / 4) for name, strength in parameters.forces}
        own |= {"tissue.diffusion": f"{0.7 * k} um^2/h"}
        given.append(parameters.changed(own))
    given.append(given[1].changed({"numerics.substeps": numerics.substeps + 1}))
    for several in (given[:3], given[2:]):
        for k, run in enumerate(simulate_many(several, range(len(several)))):
            assert same_end(run, simulate(several[k], k))
            assert run.parameters == several[k]
            assert run.final.checkpoint.parameters == several[k].as_toml()


def test_parameters_of_runs_side_by_side_must_have_the_same_times():
    """One for each seed, and the message says what differs."""
    given = preset("published").changed(SHORT)
    for several, seeds, says in (
        (
            [given, given.changed({"numerics.t_end": "5 h"})],
            [1, 2],
            'numerics.t_end = "4 h" and "5 h": must be the same',
        ),
        ([given, given.changed({"numerics.keep": ["2 h"]})], [1, 2], "numerics.keep"),
        ([given], [1, 2], "parameters = 1 of them: must be one for each of 2 seeds"),
        ([given, 3], [1, 2], "must be tissue.Parameters"),
    ):
        with pytest.raises(InvalidProblem, match=says):
            simulate_many(several, seeds)


@pytest.mark.slow_with("forces on a tube", "cylinder")
def test_from_each_saved_state_the_same_bits(parameters, tmp_path):
    """Handed over, from disk, and through pickle in turn; a run leaves its start as it was."""
    run = simulate(parameters, 3)
    for number, frame in enumerate(run.frames):
        start = frame
        if number % 3 == 1:
            frame.save(tmp_path / "state.npz")
            start = Frame.load(tmp_path / "state.npz")
        elif number % 3 == 2:
            start = pickle.loads(pickle.dumps(frame))
        before = pickle.loads(pickle.dumps(start))
        rest = simulate(parameters, 3, start)
        assert len(rest.frames) == len(run.frames) - number
        assert same_end(run, rest)
        assert same(start, before)


def parameters_of(name):
    return preset(name).changed({**SHORT, **LIVELY, "numerics.keep": "0.5 h"})


# Branches


def test_one_state_and_many_seeds():
    """Seeds part from the state on, abreast; that of the run before goes on, and so does each branch alone."""
    parameters = parameters_of("published")
    run = simulate(parameters, 3)
    branches = simulate_many(parameters, [3, 4, 5], run.frames[4])
    assert same_end(run, branches[0])
    assert not np.array_equal(branches[1].final.cells.y[:30], branches[2].final.cells.y[:30])
    assert all(np.array_equal(branch.frames[0].cells.x, run.frames[4].cells.x) for branch in branches)
    assert same_end(branches[1], simulate(parameters, 4, branches[1].frames[2]))


def test_a_control_tissue_gets_its_emt_cells_in_the_middle_when_it_branches():
    parameters = parameters_of("published")
    start = simulate(parameters, 3).frames[4]
    emt = {"emt.cells": 3, "emt.a": "2.5 h", "emt.b": "3 h", "emt.inm": 0}
    run = simulate(parameters.changed(emt), 3, start)
    n = len(start.cells.x)
    mine = np.flatnonzero(run.frames[0].cells.emt >= 0)
    assert mine.tolist() == [(n - 3) // 2 + k for k in range(3)]
    ends = run.final.cells.emt >= 0
    assert (run.final.cells.events[ends] == bit("a") | bit("b")).all()
    assert not run.final.cells.moves[ends].any()
    assert not run.final.cells.divides[ends].any()
    assert start.cells.emt.max() == -1


def test_stiffnesses_are_those_of_the_new_parameters():
    parameters = parameters_of("published").changed({"emt.cells": 1, "emt.a": "1 h", "emt.b": "1 h", "emt.s": "1 h"})
    start = simulate(parameters, 3).frames[4]
    stiff = {"cell.alpha_ax": 8, "cell.alpha_bx": 6, "cell.alpha_axb": 3, "events.bent_stiffness": 0.5}
    cells = simulate(parameters.changed(stiff), 3, start).frames[0].cells
    for name, freed, other in (("stiff_ax", 0.8, 8), ("stiff_bx", 0.1 * 6.0, 6), ("stiff_axb", 0.5, 3)):
        values = getattr(cells, name)
        np.testing.assert_allclose(values[cells.emt >= 0], freed, rtol=1e-15)
        assert (values[cells.emt < 0] == other).all()


def test_numbers_of_a_type_may_change_from_a_state_on():
    half = simulate(MIXED.changed({"numerics.t_end": "3 h"}), 7).final
    assert half.past.types == ("stiff", "quick", "leaving")
    assert same_end(simulate(MIXED, 7), simulate(MIXED, 7, half))
    cells = simulate(MIXED.changed({"types.stiff.alpha_ax": 2}), 7, half).final.cells
    assert (cells.stiff_ax[cells.kind == NAMED] == 2.0).all()


# What makes no sense

GROUPED = {"emt.cells": 3, "emt.a": "1 h"}
SAME = "must be that of the start, "


@pytest.mark.parametrize(
    ("before", "changes", "message"),
    [
        ({}, {"numerics.t_end": "2 h"}, r'numerics\.t_end = "2 h": must be at least the time of the start, t = 2\.5 h'),
        (
            {},
            {"numerics.dt": "0.2 h", "numerics.keep": "1 h", "numerics.substeps": 40},
            r"numerics\.dt = .* must divide the time of the start",
        ),
        (
            {},
            {"emt.cells": 1, "emt.b": "2 h"},
            r'emt\.b = "2 h": must be after the time of the start, t = 2\.5 h; this',
        ),
        (
            {},
            {"emt.cells": 190, "tissue.cells": 200, "tissue.width": "300 um"},
            r"emt\.cells = 190: must be at most \d+",
        ),
        (GROUPED, {"emt.cells": 4}, rf"emt\.cells = 4: {SAME}3"),
        (GROUPED, {"emt.b": "3 h"}, rf"emt\.b = '3 h': {SAME}'never'"),
        (GROUPED, {"types.more.cells": 1, "types.more.place": 0.9}, rf"types\.more\.cells = 1: {SAME}left out"),
        (GROUPED, {"cell.soft_radius": "4 um"}, rf"cell\.soft_radius = '4 um': {SAME}'5 um'"),
        ({}, {"cell.soft_radius": "5.001 um"}, rf"cell\.soft_radius = '5.001 um': {SAME}'5 um'"),
        ({}, {"layer.shape": "circle", "layer.perimeter": "600 um"}, rf"layer\.shape = 'circle': {SAME}'line'"),
    ],
)
def test_changes_that_make_no_sense(before, changes, message, tmp_path):
    parameters = parameters_of("thesis").changed(before)
    start = simulate(parameters.changed({"numerics.t_end": "2.5 h"}), 3).final
    start.save(tmp_path / "state")
    for one in (start, Frame.load(tmp_path / "state")):
        with pytest.raises(InvalidProblem, match=message):
            simulate(parameters.changed(changes), 3, one)


def test_a_state_that_failed_is_no_start(tmp_path):
    failing = parameters_of("thesis").changed({"tissue.diffusion": "1e12 um^2/h"})
    run = simulate(failing, throw=False)
    assert not run.status
    run.final.save(tmp_path / "failed.npz")
    for start in (run.final, Frame.load(tmp_path / "failed.npz")):
        with pytest.raises(InvalidProblem, match=r"start at t = .* h: cell \d+ has a coordinate that is not finite"):
            simulate(parameters_of("thesis"), start=start)


def test_only_states_of_runs_are_starts(tmp_path):
    parameters = parameters_of("thesis")
    run = simulate(parameters)
    bare = run.final._replace(checkpoint=None)
    for start, what in (
        (bare, "a frame at t = 4 h that no run"),
        (run, "start = Run"),
        (run.final.cells, "start = Cells"),
    ):
        with pytest.raises(InvalidProblem, match=rf"^{what}.*must be a saved state of a run"):
            simulate(parameters, start=start)
    with pytest.raises(InvalidProblem, match="no run has made"):
        bare.save(tmp_path / "bare.npz")
