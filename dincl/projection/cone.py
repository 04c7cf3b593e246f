"""Projections onto cones: the cone that gradients span, its polar, and polyhedra in the space of velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.norms import length
from dincl.projection.certificate import on_active_rows
from dincl.projection.quadratic import Daqp, Piqp
from dincl.rows.kinds import AffineRows

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

# Accuracy relative to |u|, and the number of unknowns up to which a dense active-set method is the faster one.
TOLERANCE = 1e-10
DENSE = 60
# Weight of multipliers beside distances, relative to the length of rows, where the shortest ones are looked for.
WEIGHT = 1e-4


class Split(NamedTuple):
    """u = A^T multipliers + rest, multipliers (m,) >= 0, rest (n,) in the polar cone {z : A z <= 0}, orthogonal.

    ``residual`` is the certified one of the projection, relative to the length of u.
    """

    multipliers: NDArray[np.float64]
    rest: NDArray[np.float64]
    residual: float


def split(u: NDArray[np.float64], gradients: csr_array) -> Split:
    """Moreau's decomposition of u (n,) along the cone {A^T lambda : lambda >= 0} of the rows of A, to 1e-10 |u|."""
    polar = AffineRows(-gradients, np.zeros(gradients.shape[0]))
    return nearest(polar, u, length(u))


def nearest(rows: AffineRows, u: NDArray[np.float64], size: float) -> Split:
    """The nearest point ``rest`` to u (n,) with A z >= bound, to 1e-10 ``size``: rest = u + A^T multipliers."""
    if size == 0:
        return Split(np.zeros(len(rows)), u, 0.0)
    projection = Daqp if u.size <= DENSE else Piqp
    target = u[:, None] / size
    found = projection(TOLERANCE).solver().nearest(AffineRows(rows.matrix, rows.bound / size), target, target)
    return Split(size * found.multipliers, size * found.point.ravel(), found.residual)


def distance_to_cone(u: NDArray[np.float64], gradients: csr_array) -> float:
    """min |u - A^T lambda| over lambda >= 0, for u of shape (n,) and the rows of A; accurate to 1e-10 |u|."""
    return length(split(u, gradients).rest)


def shortest_multipliers(u: NDArray[np.float64], gradients: csr_array) -> NDArray[np.float64]:
    """The shortest lambda (m,) >= 0 of the nearest point A^T lambda to u, which is unique also for dependent rows.

    The program min |A^T lambda - u|^2 + w^2 |lambda|^2 finds the rows with lambda > 0, and nearly their multipliers;
    the equations A A^T lambda = A u of these rows make A^T lambda exact.
    """
    from scipy.sparse import csr_array, eye_array, hstack

    m, size = gradients.shape[0], length(u)
    if m == 0 or size == 0:
        return np.zeros(m)
    weight = WEIGHT * max(float(np.abs(gradients.data).max(initial=0.0)), 1e-100)
    rows = AffineRows(csr_array(hstack((-gradients, weight * eye_array(m)), format="csr")), np.zeros(m))
    found = nearest(rows, np.concatenate((u, np.zeros(m))), size).multipliers
    found[found <= TOLERANCE * found.max(initial=0.0)] = 0.0
    return on_active_rows(AffineRows(gradients, np.zeros(m)), -u, np.zeros(u.size), found)[1]
