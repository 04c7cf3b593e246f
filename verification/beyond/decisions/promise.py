"""Promise of ``Auto`` on random scenes, and how far it is kept: the error, and the cost over the best method's."""

from __future__ import annotations

import numpy as np
import pandas as pd

from verification.beyond.decisions.study import ALONE, AUTO
from verification.beyond.decisions.tree import ENOUGH, costs, methods, share

# The share of scenes whose error is kept, at least.
WANTED = 0.95


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each scene in which some method reaches the error that was asked for, in the time of a ladder.

    ``error`` is the true one over the one asked for. The CPU time of ``Auto`` with all its runs is divided by that of
    the cheapest run with the error, chosen with the solution known (``lucky``), of the cheapest one of which all finer
    runs have it, too (``sure``), and of a choice of the step alone, with the best method known (``known``). ``taken``
    is the method of ``Auto``, ``best`` that of the cheapest run.
    """
    sure = costs(table).set_index("seed")
    least = sure[methods(sure.reset_index())].min(axis=1)
    rows = []
    for seed, mine in table.groupby("seed"):
        auto = mine[mine["method"] == AUTO]
        if len(auto):
            (made,), (alone,) = auto.itertuples(), mine[mine["method"].str.startswith(ALONE)].itertuples()
            runs = mine[~mine["method"].str.startswith((AUTO, ALONE)) & (mine["error"] <= mine["asked"])]
            best = runs.loc[runs["seconds"].idxmin()]
            rows.append(
                {"seed": seed, "particles": made.particles, "asked": made.asked, "status": made.status}
                | {"error": made.error / made.asked, "taken": made.took, "best": best["method"]}
                | {"lucky": made.seconds / best["seconds"], "sure": made.seconds / least.get(seed, np.nan)}
                | {"known": made.seconds / alone.seconds}
            )
    return pd.DataFrame(rows)


def kept(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each question about ``judged`` scenes: number, share with its 95 % interval (Wilson)."""
    asked = {
        "true error at most the one asked for": rows["error"] <= 1,
        f"cost at most {ENOUGH:g} times the cheapest run, which the solution shows": rows["lucky"] <= ENOUGH,
        f"cost at most {ENOUGH:g} times the cheapest run from which on the error holds": rows["sure"] <= ENOUGH,
        f"cost at most {ENOUGH:g} times a choice of the step with the best method known": rows["known"] <= ENOUGH,
    }
    return pd.DataFrame([{"what": what, **share(good.to_numpy())} for what, good in asked.items()])
