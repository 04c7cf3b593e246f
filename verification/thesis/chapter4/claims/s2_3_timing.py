"""Chapter 4, section 2.3: the random times of the events."""

from __future__ import annotations

import numpy as np

from tissue.events.known import row, settled
from tissue.files.timing import timing
from verification.claims import Correction, Effect, Evidence, at_most, claim

SEED = 231
CELLS = 50_000
SHARE = 70.0


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
