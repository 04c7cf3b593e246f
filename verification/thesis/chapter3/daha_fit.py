"""The damping that makes PBD nearest to DAHA, with its uncertainty over the seeds."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verification.thesis.chapter3.intervals import CONFIDENCE, over_seeds

Floats = NDArray[np.float64]
RESAMPLED = 1000
# Points of a parabola around the least mean.
NEIGHBOURS = 5


def fitted(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case, time and number of substeps: the dampings of least distance and of equal height.

    ``mu`` is the minimum of a parabola in log mu through the mean relative distances next to the least of them, with
    the percentiles of resampled seeds; ``equal`` is where a line through the two nearest heights meets that of DAHA,
    mean over the seeds with Student's interval. Where the minimum is an end of the dampings, ``mu`` is that end.
    Fewer than NEIGHBOURS dampings make no row.
    """
    rows = []
    pbd = table[(table["kind"] == "pbd") & table["relative"].notna()]
    for (case, t, substeps), mine in pbd.groupby(["case", "t", "substeps"]):
        grid = mine.pivot(index="seed", columns="mu", values="relative").dropna(axis="columns")
        mu, relative = grid.columns.to_numpy(float), grid.to_numpy()
        if len(mu) < NEIGHBOURS:
            continue
        low, high = _resampled(mu, relative)
        about = {"case": case, "t": t, "substeps": int(substeps), "mu": best(mu, relative.mean(axis=0))}
        found = over_seeds(_equal_heights(mine))
        about |= {"mu_low": low, "mu_high": high, "least": relative.mean(axis=0).min(), "runs": len(grid)}
        rows.append(about | {"equal": found.mean, "equal_low": found.low, "equal_high": found.high})
    return pd.DataFrame(rows)


def best(mu: Floats, distance: Floats) -> float:
    """Return the minimum of distances (K,) over the dampings (K,), K >= NEIGHBOURS."""
    k = int(np.argmin(distance))
    first = int(np.clip(k - NEIGHBOURS // 2, 0, max(0, len(mu) - NEIGHBOURS)))
    some = slice(first, first + NEIGHBOURS)
    x = np.log(mu[some])
    bend, slope, _ = np.polyfit(x, distance[some], 2)
    if bend <= 0:
        return float(mu[k])
    return float(np.exp(np.clip(-slope / (2 * bend), x[0], x[-1])))


def _resampled(mu: Floats, relative: Floats) -> tuple[float, float]:
    """Return the interval of ``best`` over resampled rows of (seeds, K)."""
    if len(relative) < 2:
        return np.nan, np.nan
    rng = np.random.default_rng(0)
    drawn = rng.integers(len(relative), size=(RESAMPLED, len(relative)))
    found = [best(mu, relative[rows].mean(axis=0)) for rows in drawn]
    low, high = np.quantile(found, (0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2))
    return float(low), float(high)


def _equal_heights(rows: pd.DataFrame) -> list[float]:
    """Return for each seed the damping with the height of DAHA; seeds beyond the dampings are left out."""
    found = []
    for _, mine in rows.sort_values("mu").groupby("seed"):
        off = (mine["height"] - mine["reference_height"]).to_numpy()
        x = np.log(mine["mu"].to_numpy())
        change = np.flatnonzero(np.sign(off[1:]) != np.sign(off[:-1]))
        if change.size:
            k = int(change[0])
            part = off[k] / (off[k] - off[k + 1])
            found.append(float(np.exp(x[k] + part * (x[k + 1] - x[k]))))
    return found
