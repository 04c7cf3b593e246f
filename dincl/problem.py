"""The problem: drift, constraints, start."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dincl.callables import UserFunction
from dincl.checks import array, describe, items
from dincl.constraints.base import Constraint
from dincl.constraints.selection import select
from dincl.drifts.base import CompiledDrift
from dincl.errors import InvalidProblem, StepFailure
from dincl.pickles import check_pickles
from dincl.rows.base import RowsOfOneKind, StackedRows
from dincl.status import Status

# A start may miss a constraint by this much, times the largest coordinate: contacts in decimal numbers are not exact.
START_TOLERANCE = 1e-9

DRIFT = UserFunction("drift", ("t", "x"), Status.DRIFT_FAILED)

Drift = Callable[[float, NDArray[np.float64]], Any]


@dataclass(frozen=True, eq=False, repr=False)
class Problem:
    """The differential inclusion x' in F(t, x) - N(S, x), x(0) = x0  (1.24), (1.25).

    Parameters
    ----------
    x0
        Start, shape (N, d), N, d >= 1, feasible to 1e-9 of its largest coordinate [length]. Coordinates are of
        magnitude at most 1e100; radii, lengths, tolerances and time steps lie between 1e-100 and 1e100, so that their
        squares are numbers, too. Others are refused.
    drift
        F: (t, x) -> velocity of the unconstrained particles, (N, d) -> (N, d) [length / time]. x is read-only.
        ``dincl.drifts`` has the usual ones.
    constraints
        The sets whose intersection is S, in the order in which PBD projects onto them.

    Raises
    ------
    InvalidProblem
        For wrong shapes, numbers that are not finite, a start that is not feasible, a drift that fails at the start.
    """

    x0: NDArray[np.float64]
    drift: Drift
    constraints: Sequence[Constraint] = ()

    def __init__(self, x0: ArrayLike, drift: Drift, constraints: Sequence[Constraint] = ()) -> None:
        object.__setattr__(self, "x0", _start(x0))
        if not callable(drift):
            raise InvalidProblem(f"drift = {describe(drift)}: must be a callable (t, x) -> velocity of the shape of x")
        object.__setattr__(self, "drift", drift)
        object.__setattr__(self, "constraints", _families(constraints))
        # What overflows in a function of the user is found in what it returns.
        with np.errstate(all="ignore"):
            self._check()

    def __repr__(self) -> str:
        n, d = self.x0.shape
        sets = ", ".join(type(constraint).__name__ for constraint in self.constraints)
        return f"{type(self).__name__}(N = {n}, d = {d}, constraints = [{sets}])"

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled; PicklingError names the part that cannot be."""
        check_pickles("drift", self.drift)
        for k, constraint in enumerate(self.constraints):
            check_pickles(f"constraints[{k}]", constraint)
        return self.__dict__

    def __copy__(self) -> Problem:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Problem:
        """Itself, as nothing in it changes: a drift that does not pickle can still be copied."""
        return self

    def velocity(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """F(t, x), checked: shape (N, d), finite; StepFailure otherwise."""
        # No view: its base could be written to.
        seen = x.copy()
        seen.flags.writeable = False
        return DRIFT.evaluated(self.drift, t, seen, shape=x.shape)

    def rows_within(self, t: float, x: NDArray[np.float64], reach: float) -> StackedRows:
        """All rows that can be violated at time t once every particle moved by at most ``reach`` from x."""
        return select(self.constraints, t, x, reach).at(t)

    def violation(self, t: float, x: NDArray[np.float64]) -> float:
        """max_k max(0, -g_k(x)) at time t, over all constraints [units of g]; infinite where one is not defined."""
        try:
            return max(0.0, float(np.max(-self.rows_within(t, x, 0.0).values(x), initial=0.0)))
        except StepFailure:
            return math.inf

    def _check(self) -> None:
        if isinstance(self.drift, CompiledDrift):
            self.drift.check(*self.x0.shape)
        try:
            for constraint in self.constraints:
                constraint.check(*self.x0.shape)
                _check_rows(constraint, self.x0)
                _check_feasible(constraint, self.x0)
            self.velocity(0.0, self.x0)
        except StepFailure as failure:
            name = "drift" if failure.status is Status.DRIFT_FAILED else "constraints"
            raise InvalidProblem(f"{name}: {failure.detail} {failure.status.value}") from failure


def _start(x0: ArrayLike) -> NDArray[np.float64]:
    checked = array("x0", x0)
    if checked.ndim != 2 or 0 in checked.shape:
        raise InvalidProblem(f"x0 of shape {checked.shape}: must have shape (N, d) with N, d >= 1")
    return checked


def _families(constraints: Sequence[Constraint]) -> tuple[Constraint, ...]:
    return items("constraints", constraints, Constraint, "a list of dincl constraints")


def _check_rows(constraint: Constraint, x: NDArray[np.float64]) -> None:
    rows: Any = select((constraint,), 0.0, x, 0.0).blocks[0]
    if not isinstance(rows, RowsOfOneKind):
        name = type(constraint).__name__
        allowed = "must be AffineRows, DistanceRows or rows of another kind of dincl.rows"
        raise InvalidProblem(f"constraints: {name}.select returned {describe(rows)}: {allowed}")


def _check_feasible(constraint: Constraint, x: NDArray[np.float64]) -> None:
    (rows,) = select((constraint,), 0.0, x, 0.0).at(0.0).blocks
    values = rows.values(x)
    allowed = START_TOLERANCE * float(np.abs(x).max())
    if values.min(initial=0.0) < -allowed:
        worst = rows.label(int(values.argmin()), x.shape[1])
        raise InvalidProblem(
            f"x0 violates {type(constraint).__name__} by {-values.min():.3g} at {worst}: allowed is {allowed:.1g}"
        )
