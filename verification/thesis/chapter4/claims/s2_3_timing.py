"""Chapter 4, section 2.3: the random times of the events."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain, combinations
from typing import Any

import numpy as np

from tissue.events.known import row, settled
from tissue.files.timing import timing
from tissue.state.cells import Floats
from tissue.study.plan import load_study
from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, equal, proved
from verification.formal.algebra import identity, library
from verification.thesis.chapter4.claims.s4_3_tables import NEVER, TABLE_3, TABLE_4

SEED = 231
CELLS = 50_000
SHARE = 70.0
# Of the figures of section 4.
STUDIES = ("figure10", "figure12", "figure14", "figure15", "table5_63", "table5_35", "table5_7")
# Tables 1 and 2: the finite times of events [h] (lines 2749 to 2752 and 2804 to 2807).
TABLES_1_2 = (12, 24)
# "Roughly proportional": the chances per possible order differ by less than this factor.
ROUGHLY = 2.0


@claim(
    "c4.mixture",
    "The printed probabilities of U^{70%} are those of a distribution: they add up, and to one.",
    source="section 2.3.1",
    quote="P[T = ∞] = 0.3 and P[T ∈ (a, b)] = 0.7 (b − a)/(T^max − T^min)",
    recorded=Verdict.PROVED,
)
def _mixture() -> Evidence:
    sp = library()
    a, b, c, least, most = sp.symbols("a b c T0 T1", real=True)

    def chance(low: Any, high: Any) -> Any:
        """P[T in (low, high)], as printed."""
        return sp.Rational(7, 10) * (high - low) / (most - least)

    return proved(
        identity(
            "P[T ∈ (a, b)] + P[T ∈ (b, c)] = P[T ∈ (a, c)], and P[T = ∞] + P[T ∈ (T^min, T^max)] = 1",
            lambda s: [chance(a, b) + chance(b, c) - chance(a, c), s * sp.Rational(3, 10) + chance(least, most) - 1],
            "P[T = ∞] = −0.3",
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


# Possible orders of one, two and three of the events, [P] after [B]; possible sets of them, [P] only beside [B].
POSSIBLE = {"ABSP": np.array([3.0, 7.0, 12.0]), "ABP": np.array([2.0, 3.0, 3.0])}
SETS = {"ABSP": np.array([3.0, 4.0, 3.0]), "ABP": np.array([2.0, 2.0, 1.0])}


def spread(p: float, events: str, possible: Mapping[str, Floats] = POSSIBLE) -> float:
    """Chance over number of orders (or sets) for one, two and three steps: the largest over the smallest."""
    each = steps(p, events)[1:4] / possible[events]
    return float(each.max() / each.min())


@claim(
    "c4.seventy",
    (
        "With 70 % the chances of one, two and three events are as the numbers of their possible orders, up "
        "to a factor of 1.9."
    ),
    source="section 2.3.1",
    quote=(
        "70 % ensures that the number of one-step, two-step and three-step EMT events is roughly proportional"
        " to the number of possible combinations"
    ),
    rests_on=(
        "c4.mixture",
        "c4.orders",
    ),
    chosen="combinations: orders, which footnote 1 of (Q4) lists as one-step to four-step EMT; roughly: within a "
    f"factor of {ROUGHLY:g}, our limit, as the thesis gives none",
)
def _seventy() -> Evidence:
    """By orders; the remark has the factors by sets, as (Q2) groups events, too."""
    orders, sets = ([spread(SHARE / 100, events, each) for events in POSSIBLE] for each in (POSSIBLE, SETS))
    return Evidence(
        f"By orders the chances differ by factors of {orders[0]:.2f} (four events) and {orders[1]:.2f} (A, B, P), "
        f"within our limit of {ROUGHLY:g}. By sets of events they differ by {sets[0]:.2f} and {sets[1]:.2f}: by that "
        f"reading, or with a limit below {max(orders):.2f}, the claim does not hold.",
        printed=tuple(
            at_most(
                f"chance per order, largest over smallest, of {', '.join(events)}", spread(SHARE / 100, events), ROUGHLY
            )
            for events in POSSIBLE
        ),
    )


@claim(
    "c4.range",
    "The times of all tables lie between 6 h and 24 h, and reach both; so do those of the runs.",
    source="section 2.3.1",
    quote="All simulations in this thesis will use T^min = 6 h and T^max = 24 h.",
)
def _range() -> Evidence:
    found = []
    for study in STUDIES:
        for scenario in load_study(study).scenarios.values():
            (group,) = scenario.groups()
            found += [
                (time.low.value, time.high.value) for time in group.scenario.times.values() if time.low and time.high
            ]
    printed = [t for t in (*TABLES_1_2, *chain(*TABLE_3, *TABLE_4)) if t < NEVER]
    return Evidence(
        printed=(
            *(
                equal(f"{what} time of {where} [h]", choose(times), wanted)
                for where, times in (
                    ("Tables 1 to 4", printed),
                    ("the studies of Figures 10 to 22", list(chain(*found))),
                )
                for what, choose, wanted in (("earliest", min, 6), ("latest", max, 24))
            ),
            equal(
                "random times of the studies not from 6 h to 24 h",
                len({t for t in found if t[0] < t[1]} - {(6.0, 24.0)}),
                0,
            ),
        )
    )


@claim(
    "c4.onset",
    "The two definitions of the onset, over four events and over three, are the same.",
    source="(Q3), (4.8)",
    quote=(
        "The timing of onset of EMT … is the minimum of T^A, T^B, T^S and T^P; T_i^EMT is that of T_i^A, T_i^B, T_i^S"
    ),
    correction=Correction(
        "in (Q3) max(T^P, T^B) in place of T^P, or as in (4.8) without it",
        Effect.NUMBER,
        "the onset of a quarter of the cells with times from (4.2); Figures 21 and 22 are by (4.8)",
        why=(
            "section 2.3.1 draws T^P and T^B independently, and [P] waits for [B] (section 2.2.4): a T^P before "
            "all other times is the time of no event"
        ),
        place=2532,
    ),
)
def _onset() -> Evidence:
    """The times as drawn, and those at which the events happen."""
    each, rng = timing(f"6 h to 24 h, {SHARE:g} %"), np.random.default_rng(SEED)
    times = {name: each.times(*rng.random((2, CELLS))) for name in "absp"}
    three = np.minimum.reduce([times[name] for name in "abs"])
    first = (times["p"], settled(times)[row("p")])
    apart, later = (int((np.minimum(three, p) != three).sum()) for p in first)
    what = f"cells of {CELLS} with times from (4.2) whose two onsets differ,"
    return Evidence(
        printed=(at_most(f"{what} T^P as drawn", apart, 0),),
        corrected=(at_most(f"{what} max(T^P, T^B)", later, 0),),
        seed=SEED,
    )
