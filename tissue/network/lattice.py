"""Where the cells of a tissue in space stand at the start: a triangular lattice, or points spread over a sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from dincl.errors import InvalidProblem
from tissue.state.cells import Floats, Integers
from tissue.state.surface import PLANE, SPHERE, Surface, cylinder, normals, plane, sphere

# Height of an equilateral triangle over its side: the distance of rows of a triangular lattice.
ROW = math.sqrt(3) / 2
# In fewer rows, or columns, neighbours would meet twice.
FEWEST = 4
# Iterations that spread cells evenly, at most.
LLOYD = 100


@dataclass(frozen=True, eq=False)
class Lattice:
    """Basal points (3, n) on a surface: in columns across z, each from low to high z; on a sphere from pole to pole."""

    surface: Surface
    basal: Floats
    spacing: float  # of neighbours

    def above(self, heights: Floats) -> Floats:
        """Return the points at these heights (n,) above the basal points, (3, n)."""
        points: Floats = self.basal + heights * normals(self.surface, self.basal.T).T
        return points

    def nuclei(self, rule: str, heights: Floats, draws: Generator) -> Floats:
        """Nuclei at these heights: above their own basal points, or aside of them by up to the spacing, (3, n).

        In "own_basal" they are above them; in "even" and "box" both coordinates along the surface are shifted by
        U(-spacing, spacing).
        """
        straight = self.above(heights)
        if rule == "own_basal":
            return straight
        shifts = draws.uniform(-self.spacing, self.spacing, (2, len(heights)))
        across, deep = self._tangents()
        shifted: Floats = straight + shifts[0] * across + shifts[1] * deep
        return shifted

    def _tangents(self) -> tuple[Floats, Floats]:
        """Return two directions along the surface, at right angles, (3, n) each."""
        n = normals(self.surface, self.basal.T).T
        if self.surface.bends != SPHERE:
            deep = np.zeros_like(n)
            deep[2] = 1.0
            return np.cross(n, deep, axis=0), deep
        # Across the axis that the normal is least along.
        axis = np.eye(3)[:, np.abs(n).argmin(axis=0)]
        across = np.cross(n, axis, axis=0)
        across /= np.linalg.norm(across, axis=0)
        return across, np.cross(n, across, axis=0)

    def by_distance(self, place: float) -> Integers:
        """Return the cells from the nearest to the farthest of a place: a part of the way across, in the middle
        of z.
        """
        at = self.basal
        if self.surface.bends == PLANE:
            x = at[0].min() + place * (at[0].max() - at[0].min())
            away: Floats = (at[0] - x) ** 2 + at[2] ** 2
            return np.argsort(away, kind="stable")
        turn = 2.0 * math.pi * (place - 0.5)
        goal = np.array([math.sin(turn), self.surface.side * math.cos(turn), 0.0]) * self.surface.radius
        return np.argsort(((at - goal[:, None]) ** 2).sum(axis=0), kind="stable")

    def apart(self, among: Integers, m: int) -> Integers:
        """m of these cells, evenly over the tissue: each is nearest to the mean of the cells that it is nearest to.

        By Lloyd's iteration from points that are each as far as possible from those before.
        """
        from scipy.cluster.vq import kmeans2

        points = self._folded()[among]
        first = [int(np.argmin(((points - points.mean(axis=0)) ** 2).sum(axis=1)))] if m else []
        away = np.full(len(among), math.inf)
        while len(first) < m:
            away = np.minimum(away, ((points - points[first[-1]]) ** 2).sum(axis=1))
            first.append(int(np.argmax(away)))
        if m < 2:
            return among[first]
        middles, part = kmeans2(points, points[first], iter=LLOYD, minit="matrix", missing="raise")
        off = ((points - middles[part]) ** 2).sum(axis=1)
        chosen = [min(np.flatnonzero(part == k).tolist(), key=off.__getitem__) for k in range(m)]
        return np.sort(among[chosen])

    def _folded(self) -> Floats:
        """Return points whose distances are those of the basal points, in the large over a half period, (n, 3
        or more).
        """
        axes: list[Floats] = []
        periods = (self.surface.period_x, math.inf, self.surface.period_z)
        for x, period in zip(self.basal, periods, strict=True):
            turn = 2.0 * math.pi / period
            axes += [x] if turn == 0.0 else [np.cos(turn * x) / turn, np.sin(turn * x) / turn]
        return np.stack(axes, axis=1)


def rows_of(cells: int, wanted: int) -> int:
    """Return the number of rows of so many cells: the one that is wanted, or for 0 that of a sheet that is about
    square.

    Rows are shifted by half of the spacing in turn, so that a periodic sheet has an even number. Raises InvalidProblem
    if the cells do not fill rows of one length, four or more in each.
    """
    ideal = math.sqrt(cells / ROW)
    fitting = [wanted] if wanted else range(FEWEST, cells // FEWEST + 1, 2)
    rows = min((k for k in fitting if cells % k == 0), key=lambda k: abs(math.log(k / ideal)), default=0)
    if rows % 2 or not FEWEST <= rows <= cells // FEWEST:
        filled = f"columns times {wanted or 'an even number of'} rows, {FEWEST} or more of each"
        raise InvalidProblem(f"tissue.cells = {cells}: must be {filled}")
    return rows


def flat_lattice(cells: int, rows: int, spacing: float, *, periodic: bool) -> Lattice:
    """Return a triangular lattice on the plane, in x and z."""
    s, z = _sheet(cells, rows, spacing)
    columns = cells // rows
    periods = (columns * spacing, rows * ROW * spacing) if periodic else (math.inf, math.inf)
    surface = plane(period_x=periods[0], period_z=periods[1])
    return Lattice(surface, np.stack((s, np.zeros(cells), z)), spacing)


def round_lattice(cells: int, rows: int, perimeter: float, *, inside: bool, periodic: bool) -> Lattice:
    """Return a triangular lattice around a cylinder."""
    spacing, radius = perimeter * rows / cells, perimeter / (2.0 * math.pi)
    s, z = _sheet(cells, rows, spacing)
    surface = cylinder(radius, inside=inside, period_z=rows * ROW * spacing if periodic else math.inf)
    angle = s / radius
    return Lattice(surface, np.stack((radius * np.sin(angle), surface.side * radius * np.cos(angle), z)), spacing)


def ball_lattice(cells: int, perimeter: float, *, inside: bool) -> Lattice:
    """Return points spread over a sphere about evenly (a Fibonacci lattice)."""
    radius = perimeter / (2.0 * math.pi)
    k = np.arange(cells)
    height, turn = 1.0 - (2.0 * k + 1.0) / cells, math.pi * (1.0 + math.sqrt(5.0)) * k
    around = np.sqrt(1.0 - height**2)
    points = radius * np.stack((around * np.cos(turn), height, around * np.sin(turn)))
    return Lattice(sphere(radius, inside=inside), points, math.sqrt(4.0 * math.pi * radius**2 / cells / ROW))


def _sheet(cells: int, rows: int, spacing: float) -> tuple[Floats, Floats]:
    """Return a triangular lattice along s and z, centred, column by column."""
    columns = cells // rows
    column, row = (part.ravel() for part in np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij"))
    s: Floats = np.asarray(spacing * (column - (columns - 1) / 2 + 0.5 * (row % 2) - 0.25), np.float64)
    z: Floats = np.asarray(ROW * spacing * (row - (rows - 1) / 2), np.float64)
    return s, z
