"""Outcome of a run of the maps, by the lengths of these scenes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import dincl
from verification.instruments.outcome import FAR, Outcome, judge
from verification.instruments.stability import reach_of

__all__ = ["ERROR", "FAR", "OVERLAP", "WORDS", "measured", "refused", "row"]

# Lengths are in units of a diameter (or of the radius of a fixed obstacle) in every scene of the maps.
# Greatest distance from the exact state that counts as converged.
ERROR = 0.02
# Greatest violation that counts as feasible.
OVERLAP = 0.1
# Every run of the maps has a state to converge to.
WORDS = tuple(one.value for one in Outcome if one is not Outcome.BOUNDED)


def refused(reason: str) -> dict[str, Any]:
    """Return the row of a run that could not begin."""
    numbers = dict.fromkeys(("error", "overlap", "growth"), np.nan)
    return {"outcome": Outcome.REFUSED.value, "status": "INVALID", "detail": reason} | numbers


def measured(
    problem: dincl.Problem, scheme: dincl.Scheme, times: ArrayLike, exact: ArrayLike, reach: float = 0.0
) -> dict[str, Any]:
    """Run a scheme, and judge it by the largest error, violation and coordinate at the output ``times`` (K,).

    ``exact`` has shape (N, d) for a state at rest or (K, N, d); NaN where no state is right. Coordinates may come as
    far as ``reach``; if none is given, as far as the first drift carries, so that falling freely is no instability.
    """
    try:
        path = dincl.solve(problem, scheme, t=times, throw=False)
    except dincl.InvalidProblem as wrong:
        return refused(str(wrong))
    true: NDArray[np.float64] = np.asarray(exact, dtype=np.float64)
    growth = float(np.abs(path.x).max()) / (reach or reach_of(problem, float(np.max(times)), true))
    error = float(np.sqrt(((path.x - true) ** 2).sum(axis=-1)).max()) if path.status and growth < np.inf else np.nan
    return row(path.status, path.detail, error, float(path.violation().max()), growth)


def row(
    status: dincl.Status, detail: str, error: float, overlap: float, growth: float, tolerated: float = ERROR
) -> dict[str, Any]:
    """Return the columns of a run that ended."""
    found = judge(status, error, overlap, growth, tolerated, OVERLAP)
    numbers = {"error": error, "overlap": overlap, "growth": growth}
    return {"outcome": found.value, "status": status.name, "detail": detail} | numbers
