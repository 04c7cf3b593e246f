"""A problem with a name, the times worth looking at and, where there is one, its exact solution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import lengths, spread
from dincl.problem import Problem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from dincl.constraints.base import Constraint
    from dincl.problem import Drift
    from dincl.scenes.exact import Exact


@dataclass(frozen=True, eq=False, init=False, repr=False, kw_only=True)
class Scene(Problem):
    """A ready-made Problem.

    Attributes
    ----------
    name
        The name of the function in ``dincl.scenes`` that makes it.
    title
        What is seen, for plots.
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
        drawn = spread("radius", lengths("radius", radius, positive=False), len(self.x0), "particles")
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "title", title)
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "radius", drawn)
        object.__setattr__(self, "exact", exact)
