"""Promise of ``Auto`` on random scenes: how often its error is right, and what it costs over runs chosen by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verification.beyond.decisions.study import ADAPTIVE, AUTO, MIDPOINT
from verification.page.parts import number

# Shares of scenes that are wanted: true error at most the one asked for, stated error at least the true one.
WANTED = {"right": 0.97, "stated": 0.99}
# No error is larger than so many times the one asked for.
BEYOND = 3.0
# Column of ``judged`` -> what the CPU time of Auto is divided by.
OVER = {
    "hand": "the cheapest run of any method",
    "midpoint": "the cheapest run of midpoint catch-up with a fixed step",
    "adaptive": "the cheapest run of adaptive catch-up",
}


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each scene with a reference: what ``Auto`` promised, and what was true.

    ``error`` is the true error over the one asked for. ``stated`` says whether the stated error is at least the true
    one, up to the error of the reference. The columns of ``OVER`` hold the CPU time of Auto over that of the cheapest
    run with the error, which only someone who knows the solution can choose: NaN if Auto failed, or no run has it.
    """
    rows = []
    for seed, mine in table.groupby("seed"):
        for made in mine[mine["method"] == AUTO].itertuples():
            success = made.status == "SUCCESS"
            row: dict[str, Any] = {"seed": seed, "particles": made.particles, "asked": made.asked}
            row |= {"status": made.status, "taken": made.took, "error": made.error / made.asked}
            row["stated"] = success and made.error <= made.stated + made.reference
            runs = mine[(mine["method"] != AUTO) & (mine["status"] == "SUCCESS") & (mine["error"] <= mine["asked"])]
            for column, method in (("hand", None), ("midpoint", MIDPOINT), ("adaptive", ADAPTIVE)):
                least = (runs if method is None else runs[runs["method"] == method])["seconds"].min()
                row[column] = made.seconds / least if success else np.nan
            rows.append(row)
    return pd.DataFrame(rows)


def kept(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each question about ``judged`` scenes: number, share with its 95 % interval (Wilson)."""
    success = rows["status"] == "SUCCESS"
    done = rows[success]
    asked = {
        "SUCCESS, and the true error is at most the one asked for": success & (rows["error"] <= 1),
        "Of those with SUCCESS: the true error is at most the one asked for": done["error"] <= 1,
        "Of those with SUCCESS: the stated error is at least the true one": done["stated"].astype(bool),
        f"Of those with SUCCESS: the true error is above {number(BEYOND)} times the one asked for": done["error"]
        > BEYOND,
    }
    return pd.DataFrame([{"what": what, **share(good.to_numpy())} for what, good in asked.items()])


def costs(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each column of ``OVER``: number of scenes, median, and 90 % quantile."""
    found = {what: rows[column].dropna() for column, what in OVER.items()}
    return pd.DataFrame(
        [
            {"over": what, "scenes": len(ratios), "median": ratios.median(), "most": ratios.quantile(0.9)}
            for what, ratios in found.items()
        ]
    )


def share(good: NDArray[np.bool_]) -> dict[str, Any]:
    """Return count, number, share and its 95 % interval (Wilson)."""
    from scipy.stats import binomtest

    count, of = int(good.sum()), len(good)
    if not of:
        return {"count": 0, "of": 0, "share": np.nan, "low": 0.0, "high": 1.0}
    low, high = binomtest(count, of).proportion_ci(method="wilson")
    return {"count": count, "of": of, "share": count / of, "low": low, "high": high}
