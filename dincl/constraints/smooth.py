"""Sets given by a differentiable function and its Jacobian, which is checked, or computed where none is given."""

from __future__ import annotations

import math
import warnings
from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import UserFunction, arguments_of
from dincl.checks import describe, flag, function
from dincl.constraints.base import Constraint
from dincl.errors import FunctionFailed, InvalidProblem
from dincl.rows.kinds import SmoothRows, all_rows
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.rows.base import RowsOfOneKind

Function = Callable[["NDArray[np.float64]"], Any]
EPS = float(np.finfo(np.float64).eps)
# Step of central differences, relative to the length on which g bends: rounding and truncation both leave 1e-10.
CENTRAL_STEP = EPS ** (1 / 3)
# A length on which g bends is not known: steps are STRIDE times apart, at most so many down and up from the first one.
STRIDE, DOWN, UP = 8.0, 10, 4
# Slopes of two neighbouring steps that differ by less than this, relatively, have at least half of all digits.
AGREE = EPS**0.5
# Step of complex differences, which have no rounding: its square vanishes beside 1.
COMPLEX_STEP = 1e-100
# Relative error of a Jacobian along a direction that is taken for a mistake, and of one-sided slopes for a kink.
MISTAKE, KINK = 1e-3, 1e-2
G = UserFunction("g", ("x",), Status.CONSTRAINT_FAILED)


class NumericalJacobian:
    """dg/dx of a function g, x or (t, x) -> (m,), by complex steps if g accepts complex x, else by central differences.

    Complex steps are exact up to rounding: dg/dx_k = Im g(x + i h e_k) / h (Squire and Trapp, SIAM Rev. 40, 1998).
    Central differences have a relative error of about 1e-10; ``central_step`` chooses their step at each x. Both call g
    for each coordinate, the latter twice.
    """

    def __init__(self, g: Callable[..., Any]) -> None:
        self._g = g
        self._complex: bool | None = None

    @property
    def method(self) -> str:
        """How derivatives are computed, known after the first one."""
        return {None: "differences", True: "complex steps", False: "central differences"}[self._complex]

    def __call__(self, *arguments: Any) -> NDArray[np.float64]:
        """Compute dg/dx at x (N, d), the last argument, shape (m, N*d)."""
        x = arguments[-1]
        g = partial(self._g, *arguments[:-1])
        if self._complex is None:
            self._complex = _accepts_complex(g, x)
        return _by_complex_steps(g, x) if self._complex else _by_differences(g, x)


def central_step(values: Function, x: NDArray[np.float64], direction: NDArray[np.float64]) -> tuple[float, float]:
    """Choose the step of central differences at x, and return it with how well slopes along a direction agree for it.

    Too long a step leaves an error of truncation, too short a one an error of rounding; slopes for a step and for an
    eighth of it, D and D', show the larger one of both. The first step is relative to the largest coordinate. From
    there the steps are searched, nearest first, for one with |D - D'| <= AGREE max(|D|, |D'|, |g| / length); without
    one the best counts. The last term admits gradients that vanish: a slope that is nothing beside g over the size of
    the coordinates, and at least over 1. A row that does not change at all is believed only for steps of that length.
    """
    size = float(np.abs(x).max())
    first, length = CENTRAL_STEP * (size or 1.0), max(size, 1.0)
    slopes: dict[int, NDArray[np.float64]] = {}
    small = np.abs(values(x)) / length

    def slope(k: int) -> NDArray[np.float64]:
        if k not in slopes:
            h = first * STRIDE**k
            slopes[k] = (values(x + h * direction) - values(x - h * direction)) / (2 * h)
        return slopes[k]

    def disagreement(k: int) -> float:
        one, other = slope(k), slope(k - 1)
        known = (one != 0) & (other != 0) if first * STRIDE**k < CENTRAL_STEP * length else np.ones(len(one), bool)
        scale = np.maximum(np.maximum(np.abs(one), np.abs(other)), small)
        difference = np.abs(one - other) / np.where(scale > 0, scale, 1.0)
        return float(np.where(known, difference, 1.0).max(initial=0.0))

    up = UP + max(0, math.ceil(math.log(length / size, STRIDE))) if size else UP
    best, found = 0, np.inf
    for k in sorted(range(-DOWN, up + 1), key=abs):
        try:
            differs = disagreement(k)
        except FunctionFailed:
            continue  # g is not defined so far from x
        if differs < found:
            best, found = k, differs
        if found <= AGREE:
            break
    return first * STRIDE**best, found


def _accepts_complex(g: Function, x: NDArray[np.float64]) -> bool:
    """Compare both along one direction: functions such as abs drop the imaginary part without a word."""
    direction = generic_direction(x)
    values = partial(_values, g)
    expected = _slopes(values, x, direction, central_step(values, x, direction)[0])[2]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = np.asarray(g(x + 1j * COMPLEX_STEP * direction))
    except Exception:  # noqa: BLE001  # g is of the user, and need not know complex numbers
        return False
    if found.dtype != np.complex128 or found.shape != expected.shape or not np.isfinite(found).all():
        return False
    slopes = found.imag / COMPLEX_STEP
    return bool((np.abs(slopes - expected) <= MISTAKE * np.abs(expected).max(initial=1e-10)).all())


def _by_complex_steps(g: Function, x: NDArray[np.float64]) -> NDArray[np.float64]:
    columns = []
    for index in np.ndindex(x.shape):
        moved = x.astype(np.complex128)
        moved[index] += 1j * COMPLEX_STEP
        columns.append(G.numbers(np.imag(G.call(g, moved)) / COMPLEX_STEP))
    return np.stack(columns, axis=1)


def _by_differences(g: Function, x: NDArray[np.float64]) -> NDArray[np.float64]:
    h, differs = central_step(partial(_values, g), x, generic_direction(x))
    if KINK < differs < np.inf:  # infinite: g is not defined beside x, and says so itself
        G.refuse(
            f"has noise: at this x its difference quotients differ by {differs:.1g} of themselves at all steps around "
            f"{h:.1g}: must be differentiable and computed to more digits; or pass jacobian."
        )
    columns = []
    for index in np.ndindex(x.shape):
        ends = [x.copy(), x.copy()]
        ends[0][index] -= h
        ends[1][index] += h
        width = float(ends[1][index] - ends[0][index])
        columns.append((_values(g, ends[1]) - _values(g, ends[0])) / width)
    return np.stack(columns, axis=1)


def _values(g: Function, x: NDArray[np.float64]) -> NDArray[np.float64]:
    return G.evaluated(g, x, shape=(None,))


def generic_direction(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a direction of the shape of x whose entries are all different, of magnitude up to 1."""
    direction: NDArray[np.float64] = np.cos(1.0 + np.arange(x.size)).reshape(x.shape)
    return direction


def check_jacobian(rows: RowsOfOneKind, x: NDArray[np.float64], name: str) -> None:
    """Compare the Jacobian of rows with differences of their values along one direction.

    Rows with a kink or noise at x, or values that are not defined beside x, are not judged.

    Raises
    ------
    InvalidProblem
        If they differ: names the row, both slopes, and the sign or the factor by which they differ.
    """
    direction = generic_direction(x)
    given = rows.jacobian(x) @ direction.ravel()
    h, differs = central_step(rows.values, x, direction)
    if differs > KINK:
        return
    try:
        forward, backward, slopes = _slopes(rows.values, x, direction, h)
    except FunctionFailed:
        return
    size = np.maximum(np.abs(slopes), np.abs(given))
    rounding = 4 * EPS * (1.0 + np.abs(rows.values(x))) / h
    smooth = np.abs(forward - backward) <= KINK * size + rounding
    wrong = smooth & (np.abs(slopes - given) > MISTAKE * size + rounding)
    if not wrong.any():
        return
    k = int(np.flatnonzero(wrong)[0])
    raise InvalidProblem(
        f"{name}: along a test direction {rows.label(k, x.shape[1])} changes by {slopes[k]:.6g}, but {given[k]:.6g} by "
        f"its derivative{_difference(given[wrong], slopes[wrong])}: must return dg/dx"
    )


def _difference(given: NDArray[np.float64], slopes: NDArray[np.float64]) -> str:
    ratios = given / np.where(slopes == 0, np.inf, slopes)
    if np.ptp(ratios) > MISTAKE * np.abs(ratios).max() or not ratios.any():
        return ""
    return ", the wrong sign" if abs(ratios[0] + 1) <= MISTAKE else f", a wrong factor of {ratios[0]:.4g}"


def _slopes(
    values: Function, x: NDArray[np.float64], direction: NDArray[np.float64], h: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Compute forward, backward and central differences along a direction."""
    before, here, after = values(x - h * direction), values(x), values(x + h * direction)
    return (after - here) / h, (here - before) / h, (after - before) / (2 * h)


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
