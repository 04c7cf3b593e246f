"""Shapes to draw of a problem: the radii of its particles, walls, balls, bonds and curves at a time, their region."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import singledispatch
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.checks import describe, number
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
from dincl.constraints.base import members
from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from dincl.problem import Problem

Floats = NDArray[np.float64]


# Rounding error of the sum of two opposite unit normals.
ROUNDING = 1e-12
# Room around the contents of a picture, with a curve, whose ends are not known, and the least extent along any axis,
# relative to their size.
MARGIN, MARGIN_OF_CURVES, NARROWEST = 0.06, 0.5, 0.5
# A wall is shown up to this distance from the rest, relative to its size; two that face each other up to this width.
FARTHEST, WIDEST = 1.0, 8.0


class Wall(NamedTuple):
    """{X : normal . X >= offset} is free, for a unit ``normal`` of shape (d,)."""

    normal: Floats
    offset: float

    def placed(self, turn: Floats, shift: Floats) -> Wall:
        """Return the wall carried by X -> turn X + shift, (d, d) and (d,)."""
        normal = turn @ self.normal
        return Wall(normal, self.offset + float(normal @ shift))

    def distance(self, other: Wall) -> float:
        """Return the width of the gap between two walls that face each other, infinite if they do not [length]."""
        facing = float(self.normal @ other.normal) < ROUNDING - 1
        return -(self.offset + other.offset) if facing and self.offset + other.offset < 0 else math.inf


class Ball(NamedTuple):
    """{X : |X - centre| <= radius}, a container (``inside``) or an obstacle."""

    centre: Floats
    radius: float
    inside: bool

    def placed(self, turn: Floats, shift: Floats) -> Ball:
        """Return the ball carried by X -> turn X + shift, (d, d) and (d,)."""
        return self._replace(centre=turn @ self.centre + shift)


class Bonds(NamedTuple):
    """Lines between the particles of ``pairs``, shape (m, 2)."""

    pairs: NDArray[np.int64]

    def placed(self, turn: Floats, shift: Floats) -> Bonds:
        """Return the same: bonds go with their particles."""
        return self


class Curve(NamedTuple):
    """{X : g(X) >= 0} is free for one particle in the plane; ``g`` maps X of shape (2,) to a number."""

    g: Callable[[Floats], float]

    def placed(self, turn: Floats, shift: Floats) -> Curve:
        """Return the curve carried by X -> turn X + shift, (2, 2) and (2,)."""
        return Curve(lambda place: self.g((place - shift) @ turn))


Shape = Wall | Ball | Bonds | Curve


def radii(problem: Problem, t: float = 0.0) -> Floats:
    """Return the radius of each particle at time t, shape (N,) [length].

    A Scene whose discs do not grow states it; else it is the largest one of a ``NonOverlap`` or ``HalfSpace``, also a
    ``Moving`` one; else 0.
    """
    if not hasattr(problem, "constraints"):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    count = len(problem.x0)
    known = getattr(problem, "radius", None)
    grow = any(isinstance(one, NonOverlap) and one.timed for one in problem.constraints)
    if known is not None and not grow:
        return np.asarray(known, dtype=np.float64)
    found = [np.zeros(count), *(_radii_of(one, number("t", t), count) for one in problem.constraints)]
    return np.asarray(np.max(found, axis=0), dtype=np.float64)


def shapes_at(problem: Problem, t: float) -> list[Shape]:
    """Return everything but the particles, in its place at time t."""
    known, time = radii(problem, t), number("t", t)
    return [shape for one in problem.constraints for shape in _shapes_at(one, time, problem.x0, known)]


def _shapes_at(constraint: Constraint, t: float, x: Floats, radius: Floats) -> list[Shape]:
    if not isinstance(constraint, Moving):
        return shapes_of(constraint.at(t), x, radius)
    place = constraint.placement(t, x.shape[1])
    return [shape.placed(*place) for shape in _shapes_at(constraint.constraint, t, constraint.seen(t, x), radius)]


def _radii_of(constraint: Constraint, t: float, count: int) -> Floats:
    if isinstance(constraint, Moving):
        return _radii_of(constraint.constraint, t, count)
    now = constraint.at(t)
    return now.radii(count) if isinstance(now, NonOverlap | HalfSpace) else np.zeros(count)


@singledispatch
def shapes_of(constraint: Constraint, x: Floats, radius: Floats) -> list[Shape]:
    """Return what to draw of a constraint that does not depend on time, for particles x (N, d) with ``radius`` (N,).

    Register your own constraints by ``@dincl.shapes.shapes_of.register``. Of a set without an entry in the plane, each
    row of which depends on one particle, the zero level of the least g is drawn, for all particles at one place.
    """
    # Off the start, which may be a point of symmetry, where a derivative vanishes.
    aside = x + np.linspace(0.1, 0.2, x.size).reshape(x.shape)
    if x.shape[1] != 2 or not _one_for_each(constraint.select(aside, np.inf).jacobian(aside), len(x)):
        return []

    def least(place: Floats) -> float:
        at = np.tile(place, (len(x), 1))
        return float(constraint.select(at, np.inf).values(at).min(initial=np.inf))

    return [Curve(least)]


def _one_for_each(jacobian: csr_array, count: int) -> bool:
    """Return whether each row has entries of one particle in the plane, and each particle has a row."""
    particle = jacobian.indices // 2
    rows = [particle[a:b] for a, b in pairwise(jacobian.indptr) if a < b]
    return all((row == row[0]).all() for row in rows) and len(np.unique(particle)) == count


@shapes_of.register
def _(constraint: NonOverlap, x: Floats, radius: Floats) -> list[Shape]:
    """Nothing but the particles, which are drawn to scale."""
    return []


@shapes_of.register
def _(constraint: HalfSpace, x: Floats, radius: Floats) -> list[Shape]:
    return [Wall(np.asarray(constraint.normal), constraint.offset)]


@shapes_of.register(InsideBall)
@shapes_of.register(OutsideBall)
def _(constraint: InsideBall | OutsideBall, x: Floats, radius: Floats) -> list[Shape]:
    """The distance is to the centre of a particle: less its radius for an obstacle, more for a container."""
    inside, held = isinstance(constraint, InsideBall), members(constraint.particles, len(x))
    reach = constraint.distances(len(x))[held] + (radius if inside else -radius)[held]
    sizes = np.unique(np.round(np.maximum(reach, 0.0), 12))
    return [Ball(np.asarray(constraint.centre), float(size), inside) for size in sizes]


@shapes_of.register
def _(constraint: MaxDistance, x: Floats, radius: Floats) -> list[Shape]:
    return [Bonds(np.asarray(constraint.pairs))]


@shapes_of.register
def _(constraint: Ordered, x: Floats, radius: Floats) -> list[Shape]:
    """Neighbours in the chain are joined."""
    chain = np.asarray(constraint.chain)
    return [Bonds(np.column_stack((chain[:-1], chain[1:])))]


def region(problem: Problem, x: Floats, times: Sequence[float]) -> tuple[Floats, Floats]:
    """Return the corners of a picture of states x (K, N, d) with the balls and the near walls of some times."""
    radius = np.max([radii(problem, t) for t in times], axis=0)[:, None]
    low, high = (x - radius).min(axis=(0, 1)), (x + radius).max(axis=(0, 1))
    shapes = [shape for t in times for shape in shapes_at(problem, t)]
    for ball in shapes:
        if isinstance(ball, Ball):
            low, high = np.minimum(low, ball.centre - ball.radius), np.maximum(high, ball.centre + ball.radius)
    size = float((high - low).max()) or 1.0
    walls = [shape for shape in shapes if isinstance(shape, Wall)]
    for wall in walls:
        # The foot on the wall of the corner that is nearest to it.
        corner = np.where(wall.normal > 0, low, high)
        foot = corner - (wall.normal @ corner - wall.offset) * wall.normal
        faces = min(map(wall.distance, walls)) <= WIDEST * size
        if faces or np.abs(foot - corner).max() <= FARTHEST * size:
            low, high = np.minimum(low, foot), np.maximum(high, foot)
    margin = MARGIN_OF_CURVES if any(isinstance(shape, Curve) for shape in shapes) else MARGIN
    room = margin * size + np.maximum(0.0, NARROWEST * size - (high - low)) / 2
    return low - room, high + room


def values_on_grid(curve: Curve, x: Floats, y: Floats) -> Floats:
    """Return g at each point of a grid, (len(y), len(x))."""
    with np.errstate(all="ignore"):
        return np.array([[curve.g(np.array([a, b])) for a in x] for b in y])
