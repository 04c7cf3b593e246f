"""Base classes of all constraints: any set, and sets whose numbers are functions of time."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeAlias, cast

import numpy as np

from dincl.callables import UserFunction
from dincl.checks import spread
from dincl.errors import InvalidProblem, StepFailure
from dincl.rows.base import DiscPairs, RowsOfOneKind
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

Swept: TypeAlias = RowsOfOneKind | DiscPairs
# The sets of so many times are kept: differences in time, and Newton steps at one time, ask for them again.
RECENT = 64


class Constraint(ABC):
    """A set S = {x : g(x) >= 0}, given by its rows, which are of a kind of ``dincl.rows``.

    Derive from ``DifferentiableConstraint`` for a set of your own with g and its Jacobian; from this class for a set of
    many rows of which few matter at a time, best as a frozen dataclass that checks its arguments. Only ``select`` is
    required; the other methods are optional. States x have shape (N, d) and must not be changed.
    ``dincl.Moving(constraint, path)`` moves a set; of one that depends on time in another way derive from
    ``dincl.constraints.base.Timed``.

    ``docs/extend/constraint.md`` says how a set or a kind of row is added to the package.
    """

    def check(self, count: int, d: int) -> None:  # noqa: B027 - many sets fit every problem
        """Raise InvalidProblem unless the constraint fits ``count`` particles in dimension d."""

    def in_box(self, box: NDArray[np.float64]) -> Constraint:
        """Return the set in a periodic box, (d,), with 0 for axes that do not repeat; InvalidProblem if there is none.

        A set of your own is left as it is: its g must be periodic.
        """
        return self

    @abstractmethod
    def select(self, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        """Return the rows that can be violated after each particle moved at most ``search_radius`` from x, or more."""

    def sweep_rows(self, x: NDArray[np.float64]) -> Swept:
        """Return the rows that PBD projects onto, one after another, for states of the shape of x."""
        return self.select(x, math.inf)

    def longest_length(self, d: int) -> float:
        """Return the largest length or offset of the set at time 0, which gaps round with; 0 if none is known."""
        return 0.0

    @property
    def timed(self) -> bool:
        """Whether the set depends on time."""
        return False

    def at(self, t: float) -> Constraint:
        """Return the set with its numbers at time t; a set that only moves returns itself."""
        return self

    def parameters(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Return the numbers by which a timed set depends on time, flat, at time t; None for all others.

        x (N, d) is the start of the problem. Kinks of these numbers in t are located before a run.
        """
        return None

    def displacement(self, t: float, d: int) -> NDArray[np.float64] | None:
        """Return the displacement at time t, shape (d,), of a set that is only translated; None for all others."""
        return None

    def select_at(self, t: float, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        """Return rows as ``select`` does for the set at time t; only ``rows_at`` puts them where they are."""
        return self.select(x, search_radius)

    def rows_at(self, t: float, rows: Any, shape: tuple[int, ...]) -> Any:
        """Return rows of ``select_at``, or DiscPairs of ``sweep_rows``, for x of this shape, as they are at time t."""
        return rows

    def change(self, t: float, later: float, x: NDArray[np.float64], search_radius: float) -> float:
        """Bound the change of the set between two times, near x.

        If a row cannot be violated at time t after each particle moved at most r <= ``search_radius`` from x, it cannot
        be violated at the other time after moves of at most r less the result.
        """
        return 0.0


class Recent:
    """Keeps values that were made for the last few times."""

    def recent(self, t: float, value: Callable[[], Any]) -> Any:
        """Return a value of time t, made if none is kept."""
        kept: dict[float, Any] = self.__dict__.setdefault("_recent", {})
        if t not in kept:
            if len(kept) >= RECENT:
                kept.clear()
            kept[t] = value()
        return kept[t]

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_recent"}


class Timed(Recent, Constraint):
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
        return cast(Self, self.recent(t, lambda: self._made(t))) if self.timed else self

    def _made(self, t: float) -> Any:
        values = {name: value if value.ndim else float(value) for name, value in self._numbers(t).items()}
        with self._refusals(t):
            return replace(cast(Any, self), **values)

    def _numbers(self, t: float) -> dict[str, NDArray[np.float64]]:
        """Return what the functions of time return, by the names of the fields."""
        fields = {name: getattr(self, name) for name in self.functions_of_time}
        return {
            name: UserFunction(name, ("t",), Status.CONSTRAINT_FAILED).evaluated(field, t)
            for name, field in fields.items()
            if callable(field)
        }

    def longest_length(self, d: int) -> float:
        now = self.at(0.0)
        return max(float(np.abs(getattr(now, name)).max(initial=0.0)) for name in self.functions_of_time)

    def parameters(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64] | None:
        return np.concatenate([value.ravel() for value in self._numbers(t).values()]) if self.timed else None

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
            with self._refusals(t):
                found.check(count, d)
        return found

    @contextmanager
    def _refusals(self, t: float) -> Iterator[None]:
        """Turn the refusal of numbers, which functions returned at time t, into a StepFailure."""
        try:
            yield
        except InvalidProblem as error:
            raise StepFailure(Status.CONSTRAINT_FAILED, f"{type(self).__name__} at t = {t:g}: {error}.") from error


def members(particles: Any, count: int) -> NDArray[np.int64]:
    """Return the particles that a set is for: all of ``count`` if none are named."""
    return np.arange(count) if particles is None else np.asarray(particles)


def for_members(name: str, value: Any, particles: Any, count: int) -> NDArray[np.float64]:
    """Return a number of each of ``count`` particles from one, or one for each of those named; 0 for all others."""
    found, named = np.zeros(count), members(particles, count)
    found[named] = spread(name, np.asarray(value), len(named), "particles")
    return found
