"""Chapter 1, section 5 and introduction: whether the theorems cover the models of chapters 3 and 4."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

import dincl
from verification.claims import Evidence, Verdict, at_most
from verification.thesis.chapter1.cells import TOL, State, divided, in_mitosis, nearest, overlap, problem
from verification.thesis.text.quoted import claim

# Of catch-up from a feasible state, in units of the time in which the pull to the middle acts.
DT, END = 0.1, 1.0


def followed(start: State, dt: float) -> tuple[dincl.Trajectory, float]:
    """Catch-up from a state, and its largest overlap."""
    times = np.arange(1, round(END / dt) + 1) * dt
    path = dincl.solve(problem(*start), dincl.CatchUp(dt=dt, projection=dincl.Daqp(tol=TOL)), t=times)
    return path, float(path.violation().max())


def refined(start: State) -> tuple[float, float]:
    """The largest overlap of catch-up, and how much less the end moves when the step is halved a second time."""
    paths = [followed(start, DT / 2**k) for k in range(3)]
    first, second = (float(np.linalg.norm(b.final - a.final)) for (a, _), (b, _) in pairwise(paths))
    return max(overlapping for _, overlapping in paths), second / first


@claim(
    "c1.applications",
    "The existence and uniqueness of solutions is shown for the tissues of later chapters, too.",
    "section 5, and introduction, Part I",
    Verdict.CORRECTED,
    chosen="nuclei in a row that touch, pulled to the middle, without noise",
)
def _applications() -> Evidence:
    events = (divided(), in_mitosis())
    found = [overlap(event) for event in events]
    starts = [nearest(event) for event in events]
    left = max(overlap(start) for start in starts)
    later, moves = (max(values) for values in zip(*(refined(start) for start in starts), strict=True))
    return Evidence(
        f"Right after a division (3.7) daughters overlap by {found[0]:.2f} μm; when mitosis begins (3.4), a nucleus "
        f"and one that it touches do by {found[1]:.2f} μm. Neither state is in S, where solutions start. From their "
        f"projections (overlap {left:.0e}) catch-up converges: each halved step changes the end {moves:.2f} times as "
        "much.",
        printed=(
            at_most("overlap after a division [μm]", found[0], 0.0, TOL),
            at_most("overlap when mitosis begins [μm]", found[1], 0.0, TOL),
        ),
        corrected=(
            at_most("overlap of the projected states [μm]", left, 0.0, 10 * TOL),
            at_most("overlap of catch-up from there [μm]", later, 0.0, 10 * TOL),
            at_most("change of the end over that before", moves, 1.0),
        ),
    )
