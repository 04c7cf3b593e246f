"""The reference of the pile of a thousand discs, computed once.

``python -m verification.thesis.chapter2.pile_reference`` makes it again.

It takes some nine minutes and writes ``verification/thesis/data/pile_1000.parquet``.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.norms import longest
from verification.thesis.chapter2.work_references import FILES
from verification.thesis.kept import keep

NAME, COUNT = "pile_1000", 1000
# Kept times [time].
TIMES = np.arange(1, 11) / 10
# Projections are so accurate that steps alone count [length].
TOL = 3e-13
# Of the coarser and the finer run: the longest step [time], and what a jump of velocities may do to a step [length].
RUNS = ((1e-4, 1e-9), (5e-5, 1e-10))
# Accelerations [length / time^2] below this are no jumps.
SMOOTH = 10.0
# A step within which velocities jump is repeated with this part of it; one without is followed by so many times it.
SHORTER, LONGER = 0.1, 4.0
# The stated error over the largest distance between the two runs.
SAFETY = 2.0


def path(
    scene: dincl.scenes.Scene, times: NDArray[np.float64], longest_step: float, jump: float
) -> NDArray[np.float64]:
    """The states at ``times`` by catch-up of second order with jumps of the velocities enclosed, shape (K, N, d).

    Where a contact is made, velocities jump, and a step with the contact inside is wrong by up to its length times the
    jump: what pushes after the contact decides over what pushed before it. A step h is made of two halves; it stands if

        |x(t + h) - 2 x(t + h/2) + x(t)| <= max(jump, SMOOTH h^2),

    and is repeated ten times shorter if not. The scheme is of second order between jumps, and each of them leaves about
    as much as stands on the right.
    """
    scheme = dincl.MidpointCatchUp(dt=longest_step / 2, projection=dincl.ProjectedNewton(tol=TOL))
    stepper = scheme.stepper(scene)
    t, h, state, kept = 0.0, longest_step, stepper.start(), []
    for end in times:
        while t < end:
            reaches = h >= end - t
            step = end - t if reaches else h
            half = stepper.step(t, step / 2, state)
            full = stepper.step(t + step / 2, step / 2, half)
            if longest(full.x - 2 * half.x + state.x) <= max(jump, SMOOTH * step**2):
                t, state, h = end if reaches else t + step, full, min(longest_step, max(h, LONGER * step))
            else:
                h = SHORTER * step
        kept.append(state.x)
    return np.array(kept)


def table(coarse: NDArray[np.float64], fine: NDArray[np.float64]) -> pd.DataFrame:
    """One row for each time and particle: t, particle, x, y, and the error of all particles until that time."""
    distance = np.sqrt(((coarse - fine) ** 2).sum(axis=-1)).max(axis=-1)
    error = SAFETY * np.maximum.accumulate(distance)
    count = fine.shape[1]
    return pd.DataFrame(
        {
            "t": np.repeat(TIMES, count),
            "particle": np.tile(np.arange(count), len(TIMES)),
            "x": fine[..., 0].ravel(),
            "y": fine[..., 1].ravel(),
            "error": np.repeat(error, count),
        }
    )


def main() -> None:
    """Compute both runs and write the table."""
    scene = dincl.scenes.pile(COUNT)
    coarse, fine = (path(scene, TIMES, *run) for run in RUNS)
    made = table(coarse, fine)
    FILES[NAME].parent.mkdir(exist_ok=True)
    keep(made, FILES[NAME], main)
    print(made.groupby("t")["error"].first())


if __name__ == "__main__":
    main()
