"""Sets whose numbers are functions of time: growing discs, closing walls, obstacles that move and grow."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Self, cast

import numpy as np

from dincl.callables import UserFunction
from dincl.checks import spread
from dincl.constraints.base import Constraint
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.rows.base import RowsOfOneKind


# The sets of so many times are kept: differences in time, and Newton steps at one time, ask for them again.
RECENT = 64


class Timed(Constraint):
    """A set given by numbers, each of which may be a function of time: t -> number or array.

    A subclass is a frozen dataclass; ``functions_of_time`` names the fields that may be functions. With numbers in all
    fields it is a set that does not depend on time; ``at`` returns this one. The shape of each array stays the same.
    """

    functions_of_time: ClassVar[tuple[str, ...]]

    @property
    def timed(self) -> bool:
        """Whether a field is a function of time."""
        return any(callable(getattr(self, name)) for name in self.functions_of_time)

    def at(self, t: float) -> Self:
        """Return the set of time t, whose fields are numbers.

        Raises
        ------
        StepFailure
            If a function fails, or returns what the set does not accept.
        """
        if not self.timed:
            return self
        recent: dict[float, Self] = self.__dict__.setdefault("_recent", {})
        found = recent.get(t)
        if found is not None:
            return found
        values: dict[str, Any] = {}
        for name in self.functions_of_time:
            if callable(function := getattr(self, name)):
                value = _evaluated(name, function, t)
                values[name] = value if value.ndim else float(value)
        try:
            found = cast(Self, replace(cast(Any, self), **values))
        except InvalidProblem as error:
            raise StepFailure(Status.CONSTRAINT_FAILED, f"{type(self).__name__} at t = {t:g}: {error}.") from error
        if len(recent) >= RECENT:
            recent.clear()
        recent[t] = found
        return found

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_recent"}

    def longest_length(self, d: int) -> float:
        now = self.at(0.0)
        return max(float(np.abs(getattr(now, name)).max(initial=0.0)) for name in self.functions_of_time)

    def parameters(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64] | None:
        if not self.timed:
            return None
        fields = [(name, getattr(self, name)) for name in self.functions_of_time]
        values = [_evaluated(name, field, t) for name, field in fields if callable(field)]
        return np.concatenate([np.ravel(value) for value in values])

    def select_at(self, t: float, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        return self._checked_at(t, *x.shape).select(x, search_radius)

    def rows_at(self, t: float, rows: Any, shape: tuple[int, ...]) -> Any:
        return self.at(t).updated(rows, shape[0]) if self.timed else rows

    def change(self, t: float, later: float, x: NDArray[np.float64], search_radius: float) -> float:
        if not self.timed:
            return 0.0
        before = self.at(t)
        return self._checked_at(later, *x.shape).change_from(before, x, search_radius)

    @abstractmethod
    def updated(self, rows: Any, count: int) -> Any:
        """Return rows, or DiscPairs, of another time with the numbers of this set, all of whose fields are numbers."""

    @abstractmethod
    def change_from(self, other: Self, x: NDArray[np.float64], search_radius: float) -> float:
        """Compute ``change`` from the set of another time; all fields of both are numbers."""

    def _checked_at(self, t: float, count: int, d: int) -> Self:
        found = self.at(t)
        if self.timed:
            try:
                found.check(count, d)
            except InvalidProblem as error:
                raise StepFailure(Status.CONSTRAINT_FAILED, f"{type(self).__name__} at t = {t:g}: {error}.") from error
        return found


def members(particles: Any, count: int) -> NDArray[np.int64]:
    """Return the particles that a set is for: all of ``count`` if none are named."""
    return np.arange(count) if particles is None else np.asarray(particles)


def for_members(name: str, value: Any, particles: Any, count: int) -> NDArray[np.float64]:
    """Return a number of each of ``count`` particles from one, or one for each of those named; 0 for all others."""
    found, named = np.zeros(count), members(particles, count)
    found[named] = spread(name, np.asarray(value), len(named), "particles")
    return found


def _evaluated(name: str, function: Callable[[float], Any], t: float) -> NDArray[np.float64]:
    return UserFunction(name, ("t",), Status.CONSTRAINT_FAILED).evaluated(function, t)
