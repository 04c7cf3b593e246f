"""Chapter 3, sections 2.2.1 to 2.2.5: the phases of a cell, its rest lengths, and its division."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from tissue.files.frame import Frame
from tissue.files.parameters import preset
from tissue.kernels.numbers import handed_numbers
from tissue.model.cycle import adapt_rest_lengths
from tissue.model.division import divide
from tissue.runs.compiled_rules import handed_rules
from tissue.runs.simulate import simulate
from tissue.state.cells import Cells
from tissue.state.store import contents, stored
from verification.claims import claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter3.claims.s1_3_model import grown, runs_for
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.chapter3.terms import slope, spring

SEEDS = tuple(range(4))
# Table 2, in hours and 1/h.
G2, MITOSIS, SHORTEST, LONGEST = 0.5, 0.5, 10.0, 21.0
RATE = {"rest_ax": 5.0, "rest_bx": 5.0, "rest_aa": 1.0}
DT = 0.1
# p^div of Table 1; cells after 48 h over those at the start.
ADDED, TOO_FAST, MODERATE = 0.2, 4.0, 2.5
# How near the mean cycle of 50 cells or so in a run comes to that of (3.1) [h].
SPREAD = 1.0
# Lengths in R_soft: a cell as high as the tissue at the start, and the radius that a spring of the cytoskeleton skips.
SIDE, RADIUS = 8.0, 1.0
TOL = 1e-6


class Cycle(NamedTuple):
    """What a run shows of the cycles of its cells."""

    duration: float  # mean of t_cycle over the cells that were born in it [h]
    shortest: float
    longest: float
    enlarged: float  # mean of the time before division with the larger radius [h]


def cycles(seed: int) -> Cycle:
    """Of the cells that are born and of those that divide within the run."""
    table = grown(seed)
    born = table.loc[table["age_h"] < table["time_h"]].drop_duplicates(["id", "cycle_h"])["cycle_h"]
    ends = table["time_h"] - table["age_h"] + table["cycle_h"]
    over = table[(ends < table["time_h"].max()) & (ends > 1.5 * (G2 + MITOSIS))]
    large = over["hard_radius_um"] > over["hard_radius_um"].min()
    kept = large.groupby([over["id"], over["cycle_h"]]).sum() * DT
    return Cycle(float(born.mean()), float(born.min()), float(born.max()), float(kept.mean()))


@claim(
    "c3.phases",
    "Cycles last 10 to 21 hours, evenly distributed, and mitosis is the last 30 minutes of each.",
    source="section 2.2.1, (3.1)",
    quote="t_i^cycle ∼ U(T^min-age, T^max-age) … the mitosis phase starts at t_i^age = t_i^cycle − T^mitosis",
    chosen="ages at the start, uniform on the cycle",
)
def _phases() -> Evidence:
    found = [cycles(seed) for seed in SEEDS]
    mean = over_seeds([one.duration for one in found])
    enlarged = over_seeds([one.enlarged for one in found])
    middle = (SHORTEST + LONGEST) / 2
    shortest, longest = min(one.shortest for one in found), max(one.longest for one in found)
    return Evidence(
        f"cells born in {len(SEEDS)} runs of 16 h have cycles of {shortest:.2f} to {longest:.2f} h, {mean.mean:.2f} h "
        f"on average; those that divide had the radius of mitosis for the last {60 * enlarged.mean:.0f} min",
        printed=(
            equal("mean cycle [h]", mean.mean, middle, SPREAD, (mean.low, mean.high)),
            at_least("shortest cycle [h]", shortest, SHORTEST),
            at_most("longest cycle [h]", longest, LONGEST),
            equal("time in mitosis [h]", enlarged.mean, MITOSIS, DT, (enlarged.low, enlarged.high)),
        ),
        seed=SEEDS[0],
        runs_needed=runs_for([one.duration for one in found], SPREAD - abs(mean.mean - middle)),
    )


def _settled() -> Frame:
    return simulate(preset("thesis").changed({"numerics.t_end": "2 h"}), 0).final


def printed_rate(eta: np.ndarray, wanted: np.ndarray, rate: float) -> np.ndarray:
    """The right-hand side of (3.2), (3.3), and of (3.6) with the desired length 0."""
    return np.asarray(-rate * (eta - wanted))


def passive_rest_lengths(cells: Cells) -> dict[str, np.ndarray]:
    """The desired rest lengths before G2, and 0 for the junctions."""
    return {
        "rest_ax": np.hypot(cells.x - cells.ax, cells.y - cells.ay) - RADIUS,
        "rest_bx": np.hypot(cells.x - cells.bx, cells.y - cells.by) - RADIUS,
        "rest_aa": np.zeros(len(cells.x)),
    }


def solved(eta: np.ndarray, wanted: np.ndarray, rate: float) -> np.ndarray:
    """The rest lengths after a step, by a Runge-Kutta method."""
    found = solve_ivp(lambda _, y: printed_rate(y, wanted, rate), (0.0, DT), eta, rtol=1e-9, atol=1e-11)
    return np.asarray(found.y[:, -1])


@claim(
    "c3.adaptation",
    "Rest lengths approach the desired ones exponentially at the rates k.",
    source="(3.2), (3.3), (3.6)",
    quote="dη^ax/dt = −k^ax (η^ax − η^ax*), dη^aa/dt = −k^aa η^aa, where k denotes the speed of adaptation",
    chosen="desired lengths stand still within a step",
    recorded=Kind.NOT_REFUTED,
    tried_on="62 cells, one step",
)
def _adaptation() -> Evidence:
    """A step of the simulation against the equations."""
    frame = _settled()
    young = frame.cells._replace(birth=np.full(len(frame.cells.x), frame.t))
    held = stored(young, frame.layers, capacity=len(young.x))
    adapt_rest_lengths(held, frame.t, handed_numbers(preset("thesis").numbers()), handed_rules([held]))
    after, _ = contents(held)
    off = max(
        float(np.abs(solved(getattr(young, name), wanted, RATE[name]) - getattr(after, name)).max())
        for name, wanted in passive_rest_lengths(young).items()
    )
    left = math.exp(-RATE["rest_ax"] * (G2 + MITOSIS))
    return Evidence(
        f"{len(young.x)} cells, one step: (3.2), (3.3), (3.6) solved by Runge-Kutta and the relaxation of the "
        f"simulation differ by {off:.0e} R_soft at most. In the last hour of a cycle all but {100 * left:.1f} % of the "
        "way to the new rest length is done",
        printed=(
            at_most("largest difference [R_soft]", off, 0.0, TOL),
            at_most("part of the way that is left at division", left, 0.01),
        ),
        seed=0,
    )


@claim(
    "c3.passive-springs",
    "At the desired rest lengths of G1 and S the cytoskeleton exerts no force.",
    source="section 2.2.2",
    quote=(
        "During the G1 and the S phase, the cytoskeleton of the cell will adapt to the current extension: η^ax* := ‖X −"
        " A‖ − R^soft"
    ),
    recorded=Kind.NOT_REFUTED,
    tried_on="extensions of 0.5 to 12 R_soft",
)
def _passive() -> Evidence:
    """The force of a spring of (3.9) at the desired rest length of G1 and S, for many extensions."""
    extensions = np.linspace(0.5, 12.0, 24)
    forces = [abs(slope(partial(spring, rest=d - RADIUS, stiffness=2.0), d)) for d in extensions]
    return Evidence(
        f"with η = ‖X − A‖ − R^soft the force of (3.9) is {max(forces):.0e} at most for extensions of 0.5 to 12 R_soft:"
        " the cytoskeleton keeps what extension it has",
        printed=(at_most("largest force [1/R_soft]", max(forces), 0.0, TOL),),
    )


def active_rest_lengths(side: float) -> tuple[float, float]:
    """The desired rest lengths from G2 on, of a cell with ‖A − B‖ = side."""
    return 0.0, side - 2 * RADIUS


@claim(
    "c3.inm-equilibrium",
    "With the desired lengths of G2 both springs are at rest where the nucleus touches the apical point.",
    source="sections 2.1 and 2.2.3",
    quote=(
        "η^ax* := 0 μm, η^bx* := ‖A − B‖ − 2R^soft … such that the most apical position is the equilibrium for both"
        " springs"
    ),
    recorded=Kind.NOT_REFUTED,
    tried_on="cells 4, 8 and 16 R_soft high",
)
def _equilibrium() -> Evidence:
    """W^ax + W^bx on the line from B to A; the other springs do not ask for another place on it."""
    found, force = [], []
    for side in (4.0, SIDE, 16.0):
        apical, basal = active_rest_lengths(side)

        def energy(y: float, side: float = side, apical: float = apical, basal: float = basal) -> float:
            return spring(side - y, apical, 2.0) + spring(y, basal, 2.0)

        y = float(minimize_scalar(energy, bounds=(0.1, side - 0.1), method="bounded", options={"xatol": 1e-9}).x)
        found.append(abs(side - y - RADIUS))
        force += [abs(slope(partial(spring, rest=apical, stiffness=2.0), side - y))]
        force += [abs(slope(partial(spring, rest=basal, stiffness=2.0), y))]
    return Evidence(
        f"cells 4, 8 and 16 R_soft high: W^ax + W^bx is least where the nucleus touches the apical point, within "
        f"{max(found):.0e} R_soft, and there each spring by itself pulls with {max(force):.0e} at most",
        printed=(
            at_most("distance of the minimum from ‖X − A‖ = R^soft [R_soft]", max(found), 0.0, 1e-4),
            at_most("force of each spring there [1/R_soft]", max(force), 0.0, 1e-3),
        ),
    )


def cells_after(share: float, seed: int) -> float:
    """Cells after 48 h over those at the start, if such a share of divisions adds one."""
    changes = {"tissue.two_daughters": share, "numerics.t_end": "48 h", "numerics.keep": "48 h"}
    run = simulate(preset("thesis").changed(changes), seed)
    return len(run.final.cells.x) / len(run.frames[0].cells.x)


@claim(
    "c3.slice",
    "With cycles of 10 to 21 hours a slice of tissue grows too fast if each division adds a cell to it.",
    source="section 2.2.5",
    quote=(
        "since we only model a 2D slice of a three-dimensional tissue, the growth of the tissue would be too fast if "
        "cells divide at a realistic rate"
    ),
    chosen="too fast: more than 4 times the cells in 48 h, and not more than 2.5 times with p^div = 20 %",
)
def _slice() -> Evidence:
    values = [[cells_after(share, seed) for seed in SEEDS[:3]] for share in (ADDED, 1.0)]
    some, every = map(over_seeds, values)
    gaps = MODERATE - some.mean, every.mean - TOO_FAST
    return Evidence(
        f"60 cells, 48 h: if every division adds a cell they become {60 * every.mean:.0f}, {every.mean:.1f} "
        f"[{every.low:.1f}, {every.high:.1f}] times as many; if 20 % do {60 * some.mean:.0f}, {some.mean:.2f} "
        f"[{some.low:.2f}, {some.high:.2f}] times. In vivo the tissue at most doubles its height in that time. "
        f"All limits from {some.high:.1f} to {every.low:.1f} times decide alike",
        printed=(
            at_least(
                "cells if every division adds one, over those at the start", every.mean, TOO_FAST, interval=every[1:]
            ),
            at_most("cells if 20 % do, over those at the start", some.mean, MODERATE, interval=some[1:]),
        ),
        seed=SEEDS[0],
        runs_needed=max(runs_for(one, gap) for one, gap in zip(values, gaps, strict=True)),
    )


def printed_edges(edges: set[tuple[int, int]], mother: int, new: int) -> set[tuple[int, int]]:
    """Section 2.2.5: add (i, N + 1), and connect the former right neighbour of i with N + 1."""
    right = {edge for edge in edges if edge[0] == mother}
    return (edges - right) | {(mother, new)} | {(new, k) for _, k in right}


@claim(
    "c3.daughters",
    "The new chain of cells is ordered from left to right, as the daughters are placed.",
    source="section 2.2.5",
    quote=(
        "adding the edge (i, N + 1) and by connecting the former right apical neighbour of the i th cell with the new"
        " N + 1 th cell"
    ),
    chosen="rest lengths of the new cell and of its junction: those of the mother, and R^soft/3",
)
def _division() -> Evidence:
    """Every cell of a chain divides once, in turn; by the text, and by the rule of the simulation."""
    frame, numbers = _settled(), preset("thesis").numbers()._replace(two_daughters=1.0)
    n = len(frame.cells.x)
    crossed = different = 0
    for mother in range(n):
        due = np.where(np.arange(n) == mother, 100.0, 0.0)
        cells = frame.cells._replace(birth=frame.t - due, cycle=np.full(n, 50.0), id=np.arange(n))
        held = stored(cells, frame.layers, capacity=n + 1)
        divide(held, frame.t, handed_numbers(numbers), handed_rules([held]), np.random.default_rng(0))
        after, layers = contents(held)
        chain = after.id[layers.apical].tolist()
        edges = printed_edges({(k, k + 1) for k in range(n - 1)}, mother, n)
        places = dict(zip(after.id.tolist(), after.bx.tolist(), strict=True))
        crossed += places[mother] >= places[n]
        different += edges != set(pairwise(chain))
    return Evidence(
        f"each of {n} cells divided once: in {different} cases the chain of the text is not that of the simulation, in "
        f"{crossed} the daughter N + 1, joined to the right neighbour, is not right of the daughter i; N − 1 junctions "
        "become N",
        printed=(
            at_most("chains that differ", different, 0),
            at_most("daughters in the wrong order", crossed, 0),
        ),
        seed=0,
    )
