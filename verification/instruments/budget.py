"""What one run may cost: CPU time, or evaluations of the drift. Never wall time, which depends on what else runs."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any

from dincl import Problem
from dincl.checks import integer, number
from dincl.drifts.base import CountedDrift, OutOfBudgetError
from dincl.problem import with_counted_drift

__all__ = ["Budget", "CountedDrift", "CpuSeconds", "DriftEvaluations", "OutOfBudgetError", "counted"]

# How much longer than its limit a run may take before it is stopped, and how much shorter it is to be beyond doubt.
GRACE, CERTAIN = 2.0, 1.5


@dataclass(frozen=True)
class Budget(ABC):
    """A limit of one run; ``column`` of the table of runs counts against it."""

    column: str = field(init=False)

    @abstractmethod
    def limit(self) -> float:
        """Return the largest value of ``column``, at which a run is stopped."""

    @abstractmethod
    def certain(self) -> float:
        """Return the cost up to which a run finishes for certain; a longer one may be stopped on a busy machine."""

    @abstractmethod
    def spent(self, began: float, evaluations: int) -> float:
        """Return the cost of a run that began at the CPU time ``began`` and evaluated the drift so many times."""


@dataclass(frozen=True)
class CpuSeconds(Budget):
    """So many seconds of CPU time of this process, all its threads together.

    The same run takes more CPU time beside others. So a run is stopped only after GRACE times the seconds, and what
    costs more than a part of them is reported as being at the limit.
    """

    seconds: float
    column: str = field(init=False, default="cpu_seconds")

    def __post_init__(self) -> None:
        object.__setattr__(self, "seconds", number("seconds", self.seconds, positive=True))

    def limit(self) -> float:
        """Return GRACE times the seconds."""
        return GRACE * self.seconds

    def certain(self) -> float:
        """Return the seconds over CERTAIN."""
        return self.seconds / CERTAIN

    def spent(self, began: float, evaluations: int) -> float:
        """Return the CPU time since the run began [s]."""
        return time.process_time() - began

    def __str__(self) -> str:
        return f"{self.seconds:g} s of CPU time"


@dataclass(frozen=True)
class DriftEvaluations(Budget):
    """So many evaluations of the drift: the same on every machine."""

    count: int
    column: str = field(init=False, default="drift_evaluations")

    def __post_init__(self) -> None:
        object.__setattr__(self, "count", integer("count", self.count, least=1))

    def limit(self) -> float:
        """Return the count."""
        return float(self.count)

    def certain(self) -> float:
        """Return the count."""
        return float(self.count)

    def spent(self, began: float, evaluations: int) -> float:
        """Return the evaluations made."""
        return float(evaluations)

    def __str__(self) -> str:
        return f"{self.count} evaluations of the drift"


def counted(problem: Any, budget: Budget | None) -> tuple[Any, CountedDrift | None]:
    """Return the problem with a counted drift that stops at the budget, and that drift; other objects as they are."""
    if not isinstance(problem, Problem):
        return problem, None
    if budget is None:
        return with_counted_drift(problem)
    began = time.process_time()
    return with_counted_drift(problem, lambda evaluations: budget.spent(began, evaluations) > budget.limit())
