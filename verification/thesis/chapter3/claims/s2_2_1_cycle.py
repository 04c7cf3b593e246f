"""Chapter 3, sections 2.2.1 to 2.2.5: the phases of a cell, its rest lengths, and its division."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.model.division import divide
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.simulate import simulate
from tissue.state.numbers import numbers_pointer
from tissue.state.running import contents, new_state
from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.thesis.chapter3.claims.s1_3_model import grown, runs_for
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.text.quoted import claim

SEEDS = tuple(range(4))
# Table 2, in hours and 1/h.
G2, MITOSIS, SHORTEST, LONGEST = 0.5, 0.5, 10.0, 21.0
DT = 0.1
# p^div of Table 1; cells after 48 h over those at the start.
ADDED, TOO_FAST, MODERATE = 0.2, 4.0, 2.5
# How near the mean cycle of 50 cells or so in a run comes to that of (3.1) [h].
SPREAD = 1.0


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
    "section 2.2.1, (3.1)",
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


@claim(
    "c3.adaptation",
    "Rest lengths approach the desired ones exponentially at the rates k.",
    "(3.2), (3.3), (3.6)",
    Verdict.PROVED,
    chosen="desired lengths stand still within a step",
)
def _adaptation() -> Evidence:
    sp = library()
    t, k = sp.symbols("t k", positive=True)
    start, wanted = sp.symbols("eta0 eta1")

    def residuals(s: Any) -> Any:
        eta = wanted + (start - wanted) * sp.exp(-s * k * t)
        return [eta.diff(t) + k * (eta - wanted), eta.subs(t, 0) - start]

    return proved(
        identity("η = η* + (η(0) − η*)e^{−kt} solves η̇ = −k(η − η*), for all k, η* and starts", residuals, "e^{+kt}")
    )


@claim(
    "c3.passive-springs",
    "At the desired rest lengths of G1 and S the cytoskeleton exerts no force.",
    "section 2.2.2",
    Verdict.PROVED,
)
def _passive() -> Evidence:
    d, alpha, R, eta = library().symbols("d alpha R eta", positive=True)
    energy = alpha / (R + eta) * (d - R - eta) ** 2
    return proved(
        identity(
            "the force of (3.9) is 0 at η = ‖X − A‖ − R^soft, for every extension",
            lambda s: energy.diff(d).subs(eta, d - s * R),
            "‖X − A‖ + R^soft",
        )
    )


@claim(
    "c3.inm-equilibrium",
    "With the desired lengths of G2 both springs are at rest where the nucleus touches the apical point.",
    "sections 2.1 and 2.2.3",
    Verdict.PROVED,
)
def _equilibrium() -> Evidence:
    """A straight cell of the height h, the nucleus at y above B: W^ax + W^bx >= 0 is 0 at y = h - R."""
    h, y, a, b, R, rest = library().symbols("h y a b R eta", positive=True)

    def residuals(s: Any) -> Any:
        apical, basal = a / R * (h - y - R) ** 2, b / (R + rest) * (y - R - rest) ** 2
        energies = [each.subs({rest: h - 2 * R}).subs(y, h - s * R) for each in (apical, basal)]
        return [*energies, *(each.diff(y).subs({rest: h - 2 * R}).subs(y, h - s * R) for each in (apical, basal))]

    return proved(
        identity(
            "with η^ax = 0, η^bx = ‖A − B‖ − 2R^soft both springs have energy 0, their least, and no force where "
            "the nucleus "
            "touches A, for every height",
            residuals,
            "2R^soft below A",
            2,
        )
    )


def cells_after(share: float, seed: int) -> float:
    """Cells after 48 h over those at the start, if such a share of divisions adds one."""
    changes = {"tissue.two_daughters": share, "numerics.t_end": "48 h", "numerics.keep": "48 h"}
    run = simulate(preset("thesis").changed(changes), seed)
    return len(run.final.cells.x) / len(run.frames[0].cells.x)


@claim(
    "c3.slice",
    "With cycles of 10 to 21 hours a slice of tissue grows too fast if each division adds a cell to it.",
    "section 2.2.5",
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
    "section 2.2.5",
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
        held = new_state(cells, frame.layers, capacity=n + 1, space=in_plane())
        divide(held, frame.t, numbers_pointer(numbers), rules_pointer([held]), np.random.default_rng(0))
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
