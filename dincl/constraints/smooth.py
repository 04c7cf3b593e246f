"""Sets given by a differentiable function and its Jacobian: a base class, and one for two functions."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import arguments_of
from dincl.checks import describe, flag, function
from dincl.constraints.base import Constraint
from dincl.constraints.derivatives import NumericalJacobian
from dincl.errors import InvalidProblem
from dincl.rows.functions import all_rows

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.rows.base import RowsOfOneKind
    from dincl.rows.functions import SmoothRows


class DifferentiableConstraint(Constraint):
    """{x : g(x) >= 0} for a continuously differentiable g, given by two methods of a subclass.

    Both take states x of shape (N, d), which must not be changed::

        @dataclass(frozen=True, eq=False)
        class InEllipse(dincl.DifferentiableConstraint):
            axes: tuple[float, float]

            def values(self, x):  # (m,), here one row for each particle
                return 1 - ((x / self.axes) ** 2).sum(axis=1)

            def jacobian(self, x):  # (m, N*d) or (m, N, d), dense; or scipy.sparse of shape (m, N*d)
                rows = np.zeros((len(x), *x.shape))
                each = np.arange(len(x))
                rows[each, each] = -2 * x / np.square(self.axes)
                return rows

    The number of rows m is the same for all x. ``Smooth`` is the same from two functions. Every scheme, minimiser and
    projection accepts such a set; so does ``Moving``. All rows are candidates at all times, since no
    Lipschitz constant of g is known, and PBD projects onto a violated row by repeated linearisation; a subclass may
    override ``select`` and ``sweep_rows``. To be drawn, a subclass is registered with ``dincl.shapes.shapes_of``.
    """

    @abstractmethod
    def values(self, x: NDArray[np.float64]) -> Any:
        """Compute g(x) of all rows, for x of shape (N, d), shape (m,)."""

    @abstractmethod
    def jacobian(self, x: NDArray[np.float64]) -> Any:
        """Compute dg/dx at x, dense of shape (m, N*d) or (m, N, d), or scipy.sparse of shape (m, N*d)."""

    def select(self, x: NDArray[np.float64], search_radius: float) -> RowsOfOneKind:
        name = type(self).__name__
        return all_rows(self.values, self.jacobian, x, (f"{name}.values", f"{name}.jacobian"))


@dataclass(frozen=True, eq=False)
class Smooth(Constraint):
    """g(x) >= 0, or g(x) = 0, for a continuously differentiable g.

    Parameters
    ----------
    g
        x (N, d) -> (m,); or (t, x) -> (m,), a set that depends on time.
    jacobian
        dg/dx, of the same arguments, of shape (m, N*d) or (m, N, d), dense, or scipy.sparse of shape (m, N*d). A
        Problem compares it with differences at its start and refuses a wrong one. None: it is computed, by complex
        steps if g accepts complex x, else by central differences; see ``NumericalJacobian``. The repr says which.
    equality
        Whether g(x) = 0 is meant: an equality is two rows, g and -g.

    All rows are candidates at all times, since no Lipschitz constant of g is known.
    """

    g: Callable[..., Any]
    jacobian: Callable[..., Any] | None = None
    equality: bool = False

    def __post_init__(self) -> None:
        flag("equality", self.equality)
        function("g", self.g, "a callable of x (N, d), or of t and x")
        if self.jacobian is None:
            object.__setattr__(self, "jacobian", NumericalJacobian(self.g))
        given = function("jacobian", self.jacobian, "a callable of x (N, d), or of t and x")
        if not isinstance(given, NumericalJacobian) and self.timed != (arguments_of(given) == 2):
            allowed = "(t, x)" if self.timed else "(x)"
            raise InvalidProblem(f"jacobian = {describe(self.jacobian)}: must be a callable of {allowed}, as g is")

    @property
    def timed(self) -> bool:
        return arguments_of(self.g) == 2

    def at(self, t: float) -> Smooth:
        """Return the set {g(t, x) >= 0} of this t."""
        derivative: Any = self.jacobian
        return Smooth(partial(self.g, t), partial(derivative, t), self.equality) if self.timed else self

    def parameters(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64] | None:
        return self.at(t).select(x, 0.0).values(x) if self.timed else None

    def select(self, x: NDArray[np.float64], search_radius: float) -> SmoothRows:
        return all_rows(*self._functions, x, negated=self.equality)

    def select_at(self, t: float, x: NDArray[np.float64], search_radius: float) -> SmoothRows:
        return self.at(t).select(x, search_radius)

    def rows_at(self, t: float, rows: Any, shape: tuple[int, ...]) -> Any:
        if not self.timed:
            return rows
        g, derivative = self.at(t)._functions
        return replace(rows, g=g, derivative=derivative)

    @property
    def _functions(self) -> tuple[Callable[..., Any], Callable[..., Any]]:
        """The functions of all rows and of their gradients."""
        derivative: Any = self.jacobian
        if self.equality:
            return partial(both_signs, self.g), partial(both_signs, derivative)
        return self.g, derivative

    def __repr__(self) -> str:
        how = self.jacobian.method if isinstance(self.jacobian, NumericalJacobian) else "given"
        return f"Smooth(jacobian: {how})"


def both_signs(function: Callable[..., Any], x: NDArray[np.float64]) -> Any:
    """Return what a function returns, rows of numbers or of a sparse matrix, and below it the same with the sign -."""
    found = function(x)
    if hasattr(found, "tocsr"):
        from scipy.sparse import vstack

        return vstack((found, -found), format="csr")
    numbers = np.asarray(found)
    return np.concatenate((numbers, -numbers)) if numbers.ndim else found
