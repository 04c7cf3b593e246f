"""What became of a run, in one of six words, and the rule that finds the word."""

from __future__ import annotations

from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import dincl

# Lengths are in units of a diameter (or of the radius of a fixed obstacle) in every scene of the maps.
# Greatest distance from the exact state that counts as converged.
ERROR = 0.02
# Greatest violation that counts as feasible.
OVERLAP = 0.1
# A run is unstable if a coordinate gets this many times larger than its reach, see ``measured``.
FAR = 2.0


class Outcome(Enum):
    """What became of a run."""

    CONVERGED = "converged"
    INACCURATE = "inaccurate"
    INFEASIBLE = "infeasible"
    UNSTABLE = "unstable"
    NOT_TERMINATED = "did not terminate"
    REFUSED = "refused"


def judge(status: dincl.Status, error: float, overlap: float, growth: float, tolerated: float = ERROR) -> Outcome:
    """The first of these that is true.

    unstable: growth > ``FAR``, or the state left the finite numbers; did not terminate: an iteration reached its limit;
    refused: another failure, such as an empty set or coincident centres; infeasible: overlap > ``OVERLAP``;
    converged: error <= ``tolerated``; else inaccurate. An error of NaN means that there is nothing to converge to.
    """
    if growth > FAR or status is dincl.Status.NON_FINITE:
        return Outcome.UNSTABLE
    if status is dincl.Status.NOT_CONVERGED:
        return Outcome.NOT_TERMINATED
    if not status:
        return Outcome.REFUSED
    if overlap > OVERLAP:
        return Outcome.INFEASIBLE
    return Outcome.CONVERGED if error <= tolerated else Outcome.INACCURATE


def refused(reason: str) -> dict[str, Any]:
    """The row of a run that could not begin."""
    numbers = dict.fromkeys(("error", "overlap", "growth"), np.nan)
    return {"outcome": Outcome.REFUSED.value, "status": "INVALID", "detail": reason} | numbers


def measured(
    problem: dincl.Problem, scheme: dincl.Scheme, times: ArrayLike, exact: ArrayLike, reach: float = 0.0
) -> dict[str, Any]:
    """Run, and judge by the largest error, violation and coordinate at the kept ``times`` (K,).

    ``exact`` has shape (N, d) for a state at rest or (K, N, d); NaN where no state is right. Coordinates may come as
    far as ``reach``; if none is given, as far as the first drift carries, so that falling freely is no instability.
    """
    try:
        path = dincl.solve(problem, scheme, t=times, throw=False)
    except dincl.InvalidProblem as wrong:
        return refused(str(wrong))
    true: NDArray[np.float64] = np.asarray(exact, dtype=np.float64)
    growth = float(np.abs(path.x).max()) / (reach or _reach(problem, float(np.max(times)), true))
    error = float(np.sqrt(((path.x - true) ** 2).sum(axis=-1)).max()) if path.status and growth < np.inf else np.nan
    return row(path.status, path.detail, error, float(path.violation().max()), growth)


def _reach(problem: dincl.Problem, end: float, true: NDArray[np.float64]) -> float:
    carried = end * float(np.abs(problem.velocity(0.0, problem.x0)).max())
    return max(1.0, float(np.abs(problem.x0).max()) + carried, float(np.nan_to_num(np.abs(true)).max()))


def row(
    status: dincl.Status, detail: str, error: float, overlap: float, growth: float, tolerated: float = ERROR
) -> dict[str, Any]:
    """The columns of a run that ended."""
    found = judge(status, error, overlap, growth, tolerated)
    numbers = {"error": error, "overlap": overlap, "growth": growth}
    return {"outcome": found.value, "status": status.name, "detail": detail} | numbers
