"""Ratios of cells of which several share a tissue: counts, the design effect of all together, intervals."""

from __future__ import annotations

import pandas as pd

from tissue.statistics.proportions import wilson


def counted(hits: pd.Series, replicate: pd.Series) -> dict[str, float]:
    """Count the cells that are hits, and their spread from run to run.

    ``squares`` is the sum over the R runs of (y_r - p n_r)^2 R/(R - 1), y_r the hits of a run with n_r cells, of which
    ``expected`` = n p (1 - p) is expected if cells are independent.
    """
    runs = hits.groupby(replicate).agg(["sum", "size"])
    count, of, replicates = int(runs["sum"].sum()), int(runs["size"].sum()), len(runs)
    squares = float(((runs["sum"] - count / of * runs["size"]) ** 2).sum()) * replicates / (replicates - 1)
    return {"count": count, "of": of, "runs": replicates, "squares": squares, "expected": count * (1 - count / of)}


def with_intervals(rows: pd.DataFrame, together: str | list[str]) -> pd.DataFrame:
    """Return counts with their ratio, its design effect, its effective number of cells, and Wilson's 95 % interval.

    The design effect, sum of squares over sum of expected ones and at least 1, is taken of all rows with the same
    values in the columns ``together``: for p = 0 or 1 a single row says nothing about it.

    Source
    ------
    L. Kish, Survey Sampling (1965).
    """
    sums = rows.groupby(together)[["squares", "expected"]].transform("sum")
    told = rows.drop(columns=["squares", "expected"]).assign(value=rows["count"] / rows["of"])
    told["effect"] = (sums["squares"] / sums["expected"]).clip(lower=1.0)
    told["effective"] = told["of"] / told["effect"]
    told["low"], told["high"] = wilson(told["value"], told["effective"])
    return told
