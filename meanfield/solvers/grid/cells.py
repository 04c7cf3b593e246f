"""Fixed regular grid of one or two axes, and averages of a density over its cells."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from meanfield.density.quadrature import product_points

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from meanfield.density.density import Density

# Gauss points per axis and smooth piece of a cell. They are exact for polynomials of degree 9, so that the error of a
# cell average is far below the error of the scheme.
GAUSS_POINTS = 5


@dataclass(frozen=True, eq=False)
class CellGrid:
    """Grid of cells between equidistant edges.

    Parameters
    ----------
    edges
        one array of edges per axis (one or two).
    """

    edges: tuple[NDArray[np.float64], ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of cells per axis."""
        return tuple(len(e) - 1 for e in self.edges)

    @property
    def spacing(self) -> NDArray[np.float64]:
        """Width of the cells per axis."""
        return np.array([(e[-1] - e[0]) / (len(e) - 1) for e in self.edges])

    @property
    def volume(self) -> float:
        """Length or area of a cell."""
        return float(self.spacing.prod())

    @cached_property
    def centres(self) -> NDArray[np.float64]:
        """Midpoints of the cells, shape (number of cells, axes)."""
        return product_points([(e[1:] + e[:-1]) / 2 for e in self.edges])

    @cached_property
    def faces(self) -> tuple[NDArray[np.float64], ...]:
        """Midpoints of the faces across each axis, walls included: cells + 1 along that axis."""
        middles = [(e[1:] + e[:-1]) / 2 for e in self.edges]
        return tuple(product_points([*middles[:a], self.edges[a], *middles[a + 1 :]]) for a in range(len(self.edges)))

    def averages(self, density: Density) -> NDArray[np.float64]:
        """Compute cell averages of a density by Gauss quadrature; cells are split where the density is not smooth."""
        ends = zip(density.lower, density.upper, strict=True)
        rules = [_rule(e, [*end, *density.breaks], end) for e, end in zip(self.edges, ends, strict=True)]
        values = density.density(product_points([points for points, _, _ in rules]))
        total = values.reshape([len(points) for points, _, _ in rules])
        for axis, (_, weights, first) in enumerate(rules):
            moved = np.moveaxis(total, axis, -1) * weights
            total = np.moveaxis(np.add.reduceat(moved, first, axis=-1), -1, axis)
        return total / self.volume


def _rule(
    edges: NDArray[np.float64], cuts: list[float], ends: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.intp]]:
    """Compute Gauss points, their weights (0 outside ``ends``), and the index of the first point of each cell."""
    pieces = np.union1d(edges, [cut for cut in cuts if edges[0] < cut < edges[-1]])
    middle, half = (pieces[1:] + pieces[:-1]) / 2, np.diff(pieces) / 2
    gauss, gauss_weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    inside = (ends[0] < middle) & (middle < ends[1])
    points, weights = middle[:, None] + half[:, None] * gauss, (inside * half)[:, None] * gauss_weights
    return points.ravel(), weights.ravel(), np.searchsorted(pieces, edges[:-1]) * GAUSS_POINTS
