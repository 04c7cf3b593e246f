"""What there is to see of a problem: the radii of its particles, and walls, balls, bonds and curves at a time."""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.checks import instance, number, spread
from dincl.constraints import (
    Constraint,
    HalfSpace,
    InsideBall,
    MaxDistance,
    Moving,
    NonOverlap,
    Ordered,
    OutsideBall,
)

if TYPE_CHECKING:
    from dincl.problem import Problem


class Wall(NamedTuple):
    """{X : normal . X >= offset} is free, for a unit ``normal`` of shape (d,)."""

    normal: NDArray[np.float64]
    offset: float

    def moved(self, by: NDArray[np.float64]) -> Wall:
        """Carried by a displacement (d,)."""
        return Wall(self.normal, self.offset + float(self.normal @ by))

    def cut(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where the plane cuts the edges of a box in space, in their order around it, (m, 3) with m = 0 or 3 ... 6."""
        corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T
        height = corners @ self.normal - self.offset
        edges = np.argwhere((corners[:, None] != corners[None]).sum(axis=2) == 1)
        i, j = edges[(edges[:, 0] < edges[:, 1]) & (height[edges].prod(axis=1) < 0)].T
        places: NDArray[np.float64] = corners[i] + (height[i] / (height[i] - height[j]))[:, None] * (
            corners[j] - corners[i]
        )
        if len(places) == 0:
            return places
        across = np.linalg.svd(self.normal[None])[2][1:]
        ordered: NDArray[np.float64] = places[np.argsort(np.arctan2(*(across @ (places - places.mean(axis=0)).T)))]
        return ordered


class Ball(NamedTuple):
    """{X : |X - centre| <= radius}, a container (``inside``) or an obstacle."""

    centre: NDArray[np.float64]
    radius: float
    inside: bool

    def moved(self, by: NDArray[np.float64]) -> Ball:
        """Carried by a displacement (d,)."""
        return self._replace(centre=self.centre + by)


class Bonds(NamedTuple):
    """Lines between the particles of ``pairs``, shape (m, 2)."""

    pairs: NDArray[np.int64]

    def moved(self, by: NDArray[np.float64]) -> Bonds:
        """The same: bonds go with their particles."""
        return self


class Curve(NamedTuple):
    """{X : g(X) >= 0} is free for one particle in the plane; ``g`` maps X of shape (2,) to a number."""

    g: Callable[[NDArray[np.float64]], float]

    def moved(self, by: NDArray[np.float64]) -> Curve:
        """Carried by a displacement (2,)."""
        return Curve(lambda place: self.g(place - by))


Shape = Wall | Ball | Bonds | Curve


def radii(problem: Problem) -> NDArray[np.float64]:
    """The radius of each particle, shape (N,) [length].

    A Scene says it; else ``NonOverlap`` and ``HalfSpace`` tell it, at rest or ``Moving``; else it is 0.
    """
    count = len(_checked(problem).x0)
    known = getattr(problem, "radius", None)
    if known is not None:
        return np.asarray(known, dtype=np.float64)
    told = [np.zeros(count), *(_told(family, count) for family in problem.constraints)]
    return np.asarray(np.max(told, axis=0), dtype=np.float64)


def shapes_at(problem: Problem, t: float) -> list[Shape]:
    """Everything but the particles, where it is at time t."""
    known, time = radii(problem), number("t", t)
    found: list[Shape] = []
    for family in problem.constraints:
        shift = family.displacement(time, problem.x0.shape[1])
        shapes = shapes_of(family, problem.x0, known)
        found += shapes if shift is None else [shape.moved(shift) for shape in shapes]
    return found


def _checked(problem: Problem) -> Problem:
    from dincl.problem import Problem

    checked: Problem = instance("problem", problem, Problem, "a dincl.Problem")
    return checked


def _told(constraint: Constraint, count: int) -> NDArray[np.float64]:
    if isinstance(constraint, Moving):
        return _told(constraint.constraint, count)
    if isinstance(constraint, NonOverlap):
        return constraint.radii(count)
    if isinstance(constraint, HalfSpace):
        return spread("radius", np.asarray(constraint.radius), count, "particles")
    return np.zeros(count)


@singledispatch
def shapes_of(constraint: Constraint, x: NDArray[np.float64], radius: NDArray[np.float64]) -> list[Shape]:
    """What to draw of a constraint at rest, for particles like x (N, d) with ``radius`` (N,).

    A constraint of one's own is told by ``@dincl.shapes.shapes_of.register``; unless it is, the zero level of its least
    g is drawn for a single particle in the plane, and nothing for more.
    """
    if x.shape != (1, 2):
        return []

    def least(place: NDArray[np.float64]) -> float:
        at = place.reshape(1, 2)
        return float(constraint.select(at, 0.0).values(at).min(initial=np.inf))

    return [Curve(least)]


@shapes_of.register
def _(constraint: NonOverlap, x: NDArray[np.float64], radius: NDArray[np.float64]) -> list[Shape]:
    """Nothing but the particles, which are drawn to scale."""
    return []


@shapes_of.register
def _(constraint: HalfSpace, x: NDArray[np.float64], radius: NDArray[np.float64]) -> list[Shape]:
    return [Wall(np.asarray(constraint.normal), constraint.offset)]


@shapes_of.register(InsideBall)
@shapes_of.register(OutsideBall)
def _(constraint: InsideBall | OutsideBall, x: NDArray[np.float64], radius: NDArray[np.float64]) -> list[Shape]:
    """The distance is to the centre of a particle: less its radius for an obstacle, more for a container."""
    inside = isinstance(constraint, InsideBall)
    reach = np.asarray(constraint.distance) + (radius if inside else -radius)
    sizes = np.unique(np.round(np.maximum(reach, 0.0), 12))
    return [Ball(np.asarray(constraint.centre), float(size), inside) for size in sizes]


@shapes_of.register
def _(constraint: MaxDistance, x: NDArray[np.float64], radius: NDArray[np.float64]) -> list[Shape]:
    return [Bonds(np.asarray(constraint.pairs))]


@shapes_of.register
def _(constraint: Ordered, x: NDArray[np.float64], radius: NDArray[np.float64]) -> list[Shape]:
    """Neighbours in the chain are joined."""
    chain = np.asarray(constraint.chain)
    return [Bonds(np.column_stack((chain[:-1], chain[1:])))]


@shapes_of.register
def _(constraint: Moving, x: NDArray[np.float64], radius: NDArray[np.float64]) -> list[Shape]:
    return shapes_of(constraint.constraint, x, radius)
