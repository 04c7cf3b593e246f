"""The reference of the pile of a thousand discs, computed once by the event-driven scheme.

``python -m verification.beyond.chart.pile_reference`` recomputes it.

It takes half a minute and writes ``verification/data/pile_1000.parquet``. Midpoint catch-up with ever shorter
steps around each contact, which shares neither steps nor the search for events with it, took nine minutes and stated
3e-7; it was 2.5e-9 away.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from verification.beyond.chart.references import FILES
from verification.page.kept import keep

NAME, COUNT = "pile_1000", 1000
# Kept times [time].
TIMES = np.arange(1, 11) / 10
# Of the states [length].
TOL = 1e-11


def table(x: NDArray[np.float64], error: NDArray[np.float64]) -> pd.DataFrame:
    """Return one row for each time and particle of x (K, N, 2): t, particle, x, y, and the error at the time, (K,)."""
    count = x.shape[1]
    return pd.DataFrame(
        {
            "t": np.repeat(TIMES, count),
            "particle": np.tile(np.arange(count), len(TIMES)),
            "x": x[..., 0].ravel(),
            "y": x[..., 1].ravel(),
            "error": np.repeat(error, count),
        }
    )


def main() -> None:
    """Compute the states and write the table."""
    path = dincl.solve(dincl.scenes.pile(COUNT), dincl.EventDriven(TOL), TIMES)
    made = table(path.x, np.asarray(path.error))
    FILES[NAME].parent.mkdir(exist_ok=True)
    keep(made, FILES[NAME], main)
    print(made.groupby("t")["error"].first())


if __name__ == "__main__":
    main()
