"""A trajectory as a table; the one file of this package that imports pandas, on use."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.extras import needs
from dincl.shapes import radii

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from pandas import DataFrame

    from dincl.problem import Problem

__all__ = ["DataFrame", "to_frame"]


def to_frame(problem: Problem, t: NDArray[np.float64], x: NDArray[np.float64]) -> DataFrame:
    """States x (K, N, d) at times t (K,), one row for each time and particle; see ``Trajectory.to_frame``."""
    with needs("to_frame", "report"):
        import pandas as pd

    kept, count, d = x.shape
    columns = {"t": np.repeat(t, count), "particle": np.tile(np.arange(count), kept)}
    names = "xyz"[:d] if d <= 3 else [f"x{k}" for k in range(d)]
    columns |= {name: x[:, :, k].ravel() for k, name in enumerate(names)}
    radius = radii(problem)
    if radius.any():
        columns["radius"] = np.tile(radius, kept)
    return pd.DataFrame(columns)
