"""Least-distance programs by conjugate gradients on the multipliers, with bounds: MPRGP of Dostal and Schoeberl."""

import numpy as np

from dincl.compiled import allocating, inner, kernel
from dincl.compiled.arrays import Floats, Offsets
from dincl.matrices.products import times, transposed_times

# Length of a projected gradient step, in units of 1 / |A A^T|; below 2 it descends.
FIXED_STEP = 1.9
# No step along a direction is longer [multiplier per unit of residual]: only an empty set asks for more, and its
# multipliers must grow to show it, but not beyond all numbers.
LONGEST_STEP = 1e12
# Multipliers that grow beyond this have proved the set to be empty, or rounding has the last word.
LARGEST = 1e10


@allocating
def _largest_eigenvalue(indptr: Offsets, indices: Offsets, data: Floats, columns: int) -> float:
    """Bound the eigenvalues of A A^T by the largest row sum of |A| |A|^T."""
    total = np.zeros(columns)
    for p in range(indices.size):
        total[indices[p]] += abs(data[p])
    largest = 0.0
    for row in range(indptr.size - 1):
        reach = 0.0
        for p in range(indptr[row], indptr[row + 1]):
            reach += abs(data[p]) * total[indices[p]]
        largest = max(largest, reach)
    return largest


@inner
def _slope(
    indptr: Offsets, indices: Offsets, data: Floats, least: Floats, mu: Floats, u: Floats, slope: Floats
) -> None:
    """Write u = A^T mu and A u - least."""
    transposed_times(indptr, indices, data, mu, u)
    times(indptr, indices, data, u, slope)
    for row in range(mu.size):
        slope[row] -= least[row]


@inner
def _measures(mu: Floats, slope: Floats, step: float) -> tuple[float, float, float, float]:
    """Give max |min(mu, slope)|, the descent that pushing rows and resting rows promise, and max mu."""
    residual, pushing, resting, largest = 0.0, 0.0, 0.0, 0.0
    for row in range(mu.size):
        largest = max(largest, mu[row])
        if mu[row] > 0.0:
            pushing += slope[row] * min(mu[row] / step, slope[row])
            residual = max(residual, abs(min(mu[row], slope[row])))
        elif slope[row] < 0.0:
            resting += slope[row] * slope[row]
            residual = max(residual, -slope[row])
    return residual, pushing, resting, largest


@inner
def _restart(mu: Floats, slope: Floats, pushing: bool, direction: Floats) -> None:
    """Write the slope on the pushing rows, or on the resting rows that should push, into ``direction``."""
    for row in range(mu.size):
        if pushing:
            direction[row] = slope[row] if mu[row] > 0.0 else 0.0
        else:
            direction[row] = slope[row] if mu[row] <= 0.0 and slope[row] < 0.0 else 0.0


@inner
def _conjugate(mu: Floats, slope: Floats, image: Floats, square: float, direction: Floats) -> None:
    """Turn ``direction`` to the slope on the pushing rows, conjugate to itself: image = A A^T direction."""
    overlap = 0.0
    for row in range(mu.size):
        if mu[row] > 0.0:
            overlap += slope[row] * image[row]
    share = overlap / square
    for row in range(mu.size):
        direction[row] = (slope[row] if mu[row] > 0.0 else 0.0) - share * direction[row]


@inner
def _expand(mu: Floats, slope: Floats, image: Floats, direction: Floats, room: float, step: float) -> None:
    """Go as far as multipliers stay >= 0, then along the slope with projection: rows come to rest, in place."""
    for row in range(mu.size):
        if mu[row] > 0.0:
            reached = mu[row] - room * direction[row]
            descent = slope[row] - room * image[row]
            mu[row] = max(reached - step * descent, 0.0) if reached > 0.0 else 0.0


@kernel
def bounded_conjugate_gradients(
    indptr: Offsets,
    indices: Offsets,
    data: Floats,
    columns: int,
    least: Floats,
    mu: Floats,
    most: int,
    tol: float,
) -> tuple[int, float]:
    """Minimise 1/2 |A^T mu|^2 - least.mu over mu >= 0: u = A^T mu is the shortest u with A u >= least.

    Conjugate gradients on the rows that push (mu > 0). A step that would make a multiplier negative ends at the bound
    and goes on as a projected gradient step, after which more rows may rest; where the rows at rest promise more
    descent than those that push, they are let go by a steepest descent step.

    Parameters
    ----------
    indptr, indices, data, columns : (m + 1,), (k,), (k,), int
        The rows of A in compressed sparse row form, and how many columns it has.
    least : (m,)
        The right-hand sides.
    mu : (m,)
        The multipliers >= 0, changed in place.
    most : int
        Iterations allowed; each costs a product with A^T and one with A.
    tol : float
        Stop once max |min(mu, A A^T mu - least)| is at most this, or a multiplier is beyond ``LARGEST``.

    Returns
    -------
    iterations : int
        Iterations done.
    residual : float
        The largest |min(mu, slope)| at the end, of a slope that was updated and not formed anew.

    Notes
    -----
    Dostal, Schoeberl: Minimizing quadratic functions subject to bound constraints, Comput. Optim. Appl. 30 (2005).
    """
    u, slope, image, direction = np.empty(columns), np.empty(mu.size), np.empty(mu.size), np.empty(mu.size)
    step = FIXED_STEP / _largest_eigenvalue(indptr, indices, data, columns)
    _slope(indptr, indices, data, least, mu, u, slope)
    _restart(mu, slope, True, direction)
    residual = np.inf
    for iteration in range(most):
        residual, pushing, resting, largest = _measures(mu, slope, step)
        if residual <= tol or largest > LARGEST:
            return iteration, residual
        if resting > pushing:
            _restart(mu, slope, False, direction)
        transposed_times(indptr, indices, data, direction, u)
        times(indptr, indices, data, u, image)
        gain, square, room = 0.0, 0.0, np.inf
        for row in range(mu.size):
            gain += slope[row] * direction[row]
            if direction[row] > 0.0:
                room = min(room, mu[row] / direction[row])
        for column in range(columns):
            square += u[column] * u[column]
        length = min(gain / square, LONGEST_STEP)
        if length <= room:
            for row in range(mu.size):
                mu[row] -= length * direction[row]
                slope[row] -= length * image[row]
            if resting > pushing:
                _restart(mu, slope, True, direction)
            else:
                _conjugate(mu, slope, image, square, direction)
        else:
            _expand(mu, slope, image, direction, room, step)
            _slope(indptr, indices, data, least, mu, u, slope)
            _restart(mu, slope, True, direction)
    return most, residual
