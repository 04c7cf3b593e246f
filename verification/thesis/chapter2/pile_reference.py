"""The reference of the pile of a thousand discs, computed once.

``python -m verification.thesis.chapter2.pile_reference`` makes it again.

It takes some six minutes and writes ``verification/thesis/data/pile_1000.parquet``.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from verification.thesis.chapter2.work_references import FILES
from verification.thesis.kept import keep

NAME, COUNT = "pile_1000", 1000
# Kept times [time].
TIMES = np.arange(1, 11) / 10
# Steps to the end of the finer run; the other one has half as many. Projections are so accurate that steps alone count.
STEPS = 32_000
TOL = 1e-11
# The stated error over the largest distance between the two runs: contacts that decide over contacts leave order 1, so
# that the distance is about the error of the finer run, and is as irregular.
SAFETY = 2.0


def path(steps: int) -> NDArray[np.float64]:
    """The states at TIMES by catch-up of second order, shape (K, N, 2)."""
    scheme = dincl.MidpointCatchUp(dt=float(TIMES[-1]) / steps, projection=dincl.ProjectedCG(tol=TOL))
    return dincl.solve(dincl.scenes.pile(COUNT), scheme, t=TIMES).x


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
    made = table(path(STEPS // 2), path(STEPS))
    FILES[NAME].parent.mkdir(exist_ok=True)
    keep(made, FILES[NAME], main)
    print(made.groupby("t")["error"].first())


if __name__ == "__main__":
    main()
