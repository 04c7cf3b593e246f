"""Chapter 4, section 2.3: the random times of the events."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import chain, combinations

import numpy as np

from tissue.events.known import row, settled
from tissue.files.timing import timing
from tissue.state.cells import Floats
from verification.claims import Evidence, Verdict, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.thesis.chapter4.claims.s4_3_tables import NEVER, TABLE_3, TABLE_4, TABLE_5
from verification.thesis.text.quoted import claim

SEED = 231
CELLS = 50_000
SHARE = 70.0
# Tables 1 and 2: the finite times of events [h] (lines 2749 to 2752 and 2804 to 2807).
TABLES_1_2 = (12, 24)
# "Roughly proportional": the shares per possible order differ by less than a factor; reasonable limits for it.
ROUGHLY = (1.5, 3.0)


@claim(
    "c4.mixture",
    "The distribution U^{70%} skips an event in 30 % of the cases and is uniform otherwise.",
    "section 2.3.1",
    Verdict.PROVED,
)
def _mixture() -> Evidence:
    """The density 0.7/(T_max - T_min) on (T_min, T_max), and 0.3 at infinity."""
    sp = library()
    t, a, b, least, most = sp.symbols("t a b T0 T1", real=True)
    density = sp.Rational(7, 10) / (most - least)
    return proved(
        identity(
            "P[T ∈ (a, b)] = 0.7 (b − a)/(T^max − T^min) and P[T < ∞] + 0.3 = 1",
            lambda s: [
                sp.integrate(density, (t, a, b)) - s * sp.Rational(7, 10) * (b - a) / (most - least),
                sp.integrate(density, (t, least, most)) + sp.Rational(3, 10) - 1,
            ],
            "−0.7",
        )
    )


def steps(p: float, events: str) -> Floats:
    """P[0, 1, 2, ... effective events] for independent events, each with chance p; [P] acts only beside [B]."""
    chances = np.zeros(len(events) + 1)
    for k in range(len(events) + 1):
        for had in combinations(events, k):
            effective = k - ("P" in had and "B" not in had)
            chances[effective] += p**k * (1 - p) ** (len(events) - k)
    return chances


# Possible orders of one, two and three of the events, [P] after [B]; and possible sets of them, as (Q2) counts.
POSSIBLE = {"ABSP": np.array([3.0, 7.0, 12.0]), "ABP": np.array([2.0, 3.0, 3.0])}
SETS = {"ABSP": np.array([3.0, 4.0, 3.0]), "ABP": np.array([2.0, 2.0, 1.0])}


def spread(p: float, events: str, possible: Mapping[str, Floats]) -> float:
    """Chance over number of possibilities for one, two and three steps: the largest over the smallest."""
    each = steps(p, events)[1:4] / possible[events]
    return float(each.max() / each.min())


@claim(
    "c4.seventy",
    "With 70 % the chances of one, two and three events are roughly as the numbers of their possible combinations.",
    "section 2.3.1",
    Verdict.OPEN,
    chosen=f"combinations: orders, as in (Q4), not sets, as in (Q2); roughly: within a factor between {ROUGHLY[0]:g} "
    f"and {ROUGHLY[1]:g}; the verdict depends on both",
)
def _seventy() -> Evidence:
    found = {events: spread(SHARE / 100, events, POSSIBLE) for events in POSSIBLE}
    half, sets, half_sets = (
        " and ".join(f"{spread(p, events, possible):.2f}" for events in POSSIBLE)
        for p, possible in ((0.5, POSSIBLE), (SHARE / 100, SETS), (0.5, SETS))
    )
    return Evidence(
        f"Chance over number of orders, for one, two and three steps, varies by a factor of {found['ABSP']:.2f} with "
        f"four events at {SHARE:g} %, {found['ABP']:.2f} without [S]; at 50 % by {half}. By sets it is {sets}, at 50 % "
        f"{half_sets}. 'Roughly' has to allow a factor of {max(found.values()):.2f}.",
        printed=tuple(
            at_most(
                f"chance per order of {events}, largest over smallest, over the factor allowed",
                value / math.sqrt(math.prod(ROUGHLY)),
                1.0,
                interval=(value / ROUGHLY[1], value / ROUGHLY[0]),
            )
            for events, value in found.items()
        ),
    )


@claim(
    "c4.range",
    "The times of all tables lie between 6 h and 24 h, and reach both.",
    "section 2.3.1",
)
def _range() -> Evidence:
    fixed = [t for t in (*TABLES_1_2, *chain(*TABLE_3, *TABLE_4)) if t < NEVER]
    random = [timing(text) for times in TABLE_5 for text in times.values()]
    ranges = {(each.low.value, each.high.value) for each in random if each.low and each.high}
    low, high = min(fixed), max(fixed)
    return Evidence(
        f"The earliest time in Tables 1 to 4 is {low} h, the latest {high} h; Table 5 draws from "
        f"{' and '.join(f'{a:g} h to {b:g} h' for a, b in ranges)}.",
        printed=(
            equal("earliest time of Tables 1 to 4 [h]", low, 6),
            equal("latest [h]", high, 24),
            equal("ranges of Table 5 other than 6 h to 24 h", len(ranges - {(6.0, 24.0)}), 0),
        ),
    )


@claim(
    "c4.onset",
    "The two definitions of the onset, over four events and over three, are the same.",
    "(Q3), (4.8)",
    Verdict.CORRECTED,
)
def _onset() -> Evidence:
    """The times as drawn, and those at which the events happen."""
    each, rng = timing(f"6 h to 24 h, {SHARE:g} %"), np.random.default_rng(SEED)
    times = {name: each.times(*rng.random((2, CELLS))) for name in "absp"}
    three = np.minimum.reduce([times[name] for name in "abs"])
    first = (times["p"], settled(times)[row("p")])
    apart, later = (int((np.minimum(three, p) != three).sum()) for p in first)
    return Evidence(
        f"Of {CELLS} cells with times from (4.2) {apart} ({100 * apart / CELLS:.0f} %) have a T^P before the other "
        f"three, though [P] waits for [B]; with max(T^P, T^B) the two onsets differ for {later}.",
        printed=(at_most("cells with another onset", apart, 0),),
        corrected=(at_most("cells with another onset, max(T^P, T^B)", later, 0),),
        seed=SEED,
    )
