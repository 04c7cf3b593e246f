"""A problem with a name, the times worth looking at and, where it is known, its exact solution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import array, lengths, number, spread
from dincl.problem import Problem

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.constraints.base import Constraint
    from dincl.problem import Drift

# Decimal digits of exact solutions, where mpmath is not set to more.
DIGITS = 30


@dataclass(frozen=True, eq=False, init=False, repr=False, kw_only=True)
class Scene(Problem):
    """A ready-made Problem.

    Attributes
    ----------
    name
        The name of the function in ``dincl.scenes`` that makes it.
    title
        For plots.
    times
        The times worth looking at, increasing; the last one is the end.
    radius
        Radius of each particle as drawn, shape (N,), >= 0 [length].
    exact
        t -> the exact solution, or None.
    """

    name: str
    title: str
    times: tuple[float, ...]
    radius: NDArray[np.float64]
    exact: Exact | None

    def __init__(
        self,
        x0: ArrayLike,
        drift: Drift,
        constraints: Sequence[Constraint],
        *,
        name: str,
        title: str,
        times: tuple[float, ...],
        radius: ArrayLike,
        exact: Exact | None = None,
    ) -> None:
        super().__init__(x0, drift, constraints)
        radii = spread("radius", lengths("radius", radius, positive=False), len(self.x0), "particles")
        for field, value in (("name", name), ("title", title), ("times", times), ("radius", radii), ("exact", exact)):
            object.__setattr__(self, field, value)


@dataclass(frozen=True)
class Exact:
    """t -> x(t) for a scene, evaluated to 30 digits: ``exact(t)`` rounds to float64, ``exact.digits(t)`` does not.

    Attributes
    ----------
    shape
        (N, d).
    at
        x(t) for an mpf t >= 0 at mpmath's working precision: N*d entries in any nesting.
    """

    shape: tuple[int, int]
    at: Callable[[Any], Any]

    def __call__(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return x(t), shape (N, d) for one time and (K, N, d) for K; InvalidProblem unless all t are finite, >= 0."""
        times = array("t", t)
        states = [self.digits(float(time)).astype(np.float64) for time in times.flat]
        return np.array(states).reshape(*times.shape, *self.shape)

    def digits(self, t: Any) -> NDArray[np.object_]:
        """Return x(t) for a float or mpf t, shape (N, d), as mpf of 30 digits, or mpmath's precision if higher."""
        number("t", t, non_negative=True)
        import mpmath

        with mpmath.workdps(max(DIGITS, mpmath.mp.dps)):
            return np.array(self.at(mpmath.mpf(t)), dtype=object).reshape(self.shape)
