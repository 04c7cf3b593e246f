"""Chapter 1, sections 4.6.3 and 5: the proof of uniqueness, and whether the theorems cover the later models."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

import dincl
from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.thesis.chapter1.cells import TOL, State, divided, in_mitosis, nearest, overlap, problem

# Of catch-up from a feasible state, in units of the time in which the pull to the middle acts.
DT, END = 0.1, 1.0


def refined(start: State) -> tuple[float, float]:
    """Return the largest overlap of catch-up, and how much less the end moves when the step is halved a second time."""
    paths = [
        dincl.solve(problem(*start), dincl.CatchUp(dt, dincl.Daqp(tol=TOL)), t=np.arange(1, round(END / dt) + 1) * dt)
        for dt in (DT, DT / 2, DT / 4)
    ]
    first, second = (float(np.linalg.norm(b.final - a.final)) for a, b in pairwise(paths))
    return max(float(path.violation().max()) for path in paths), second / first


@claim(
    "c1.applications",
    "The theorems also cover the tissue models of chapters 3 and 4.",
    source="section 5, and introduction, Part I",
    quote="the presented theorems also cover our applications in Chapters 3 and 4.",
    correction=Correction(
        (
            "they cover the motion from one cell event to the next, if it starts in S; after a division, and when "
            "mitosis begins, the state is not in S, and has to be projected or set anew, e.g. with daughters 2R^hard "
            "apart"
        ),
        Effect.CONCLUSION,
        (
            "“which fulfil the assumptions needed for well-posedness” in the introduction; section 3.2 of chapter 3, "
            "which takes Theorem 1.31 for its model"
        ),
        why=(
            "Theorem 1.31 needs xⁱⁿⁱᵗ ∈ S; by (3.7) daughters are set nearer to each other than twice the hard radius,"
            " and by (3.4) that radius jumps"
        ),
        place=1129,
    ),
    rests_on=("c1.existence", "c1.dependence", "c1.time-independent"),
    chosen="nuclei in a row that touch, pulled to the middle, without noise",
)
def _applications() -> Evidence:
    events = (divided(), in_mitosis())
    starts = [nearest(event) for event in events]
    left = max(overlap(start) for start in starts)
    later, moves = (max(values) for values in zip(*(refined(start) for start in starts), strict=True))
    return Evidence(
        printed=(
            at_most("overlap of daughters after a division (3.7) [μm]", overlap(events[0]), 0.0, TOL),
            at_most("overlap of neighbours when mitosis begins (3.4) [μm]", overlap(events[1]), 0.0, TOL),
        ),
        corrected=(
            at_most("overlap of the states projected onto S [μm]", left, 0.0, 10 * TOL),
            at_most("overlap of catch-up from there [μm]", later, 0.0, 10 * TOL),
            at_most("change of its end when the step is halved again, over that before", moves, 1.0),
        ),
    )
