"""What became of a run, in one of seven words, and the rule that finds the word."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum

import dincl

# A run is unstable if a coordinate gets this many times larger than it may.
FAR = 2.0


class Outcome(Enum):
    """What became of a run."""

    CONVERGED = "converged"
    BOUNDED = "bounded"
    INACCURATE = "inaccurate"
    INFEASIBLE = "infeasible"
    UNSTABLE = "unstable"
    NOT_TERMINATED = "did not terminate"
    REFUSED = "refused"


# One colour for each outcome in all maps.
COLOURS: Mapping[str, str] = {
    Outcome.CONVERGED.value: "#8fc49a",
    Outcome.BOUNDED.value: "#c4dfc9",
    Outcome.INACCURATE.value: "#f2d479",
    Outcome.INFEASIBLE.value: "#e59a54",
    Outcome.UNSTABLE.value: "#b8443c",
    Outcome.NOT_TERMINATED.value: "#5b5b66",
    Outcome.REFUSED.value: "#86a7cf",
}


def judge(
    status: dincl.Status, error: float | None, overlap: float, growth: float, accurate: float, feasible: float
) -> Outcome:
    """Return the first outcome that applies.

    unstable: growth > ``FAR``, or the state left the finite numbers; did not terminate: an iteration reached its limit;
    refused: another failure, such as an empty set or coincident centres; infeasible: overlap > ``feasible``; bounded:
    there is no ``error`` to look at; converged: error <= ``accurate``; else inaccurate. An error of NaN means that
    there is nothing to converge to.
    """
    if growth > FAR or status is dincl.Status.NON_FINITE:
        return Outcome.UNSTABLE
    if status is dincl.Status.NOT_CONVERGED:
        return Outcome.NOT_TERMINATED
    if not status:
        return Outcome.REFUSED
    if overlap > feasible:
        return Outcome.INFEASIBLE
    if error is None:
        return Outcome.BOUNDED
    return Outcome.CONVERGED if error <= accurate else Outcome.INACCURATE
