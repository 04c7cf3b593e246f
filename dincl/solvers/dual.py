"""Minimisers of 1/2 |A^T lambda|^2 - least . lambda over multipliers lambda >= 0, the dual of a least-distance program.

Then u = A^T lambda is the shortest u with A u >= least. Each kernel takes the rows of A in compressed sparse row form,
``indptr`` (m + 1,), ``indices`` (k,) and ``data`` (k,), and changes ``multiplier`` (m,) in place.
"""

import numpy as np

from dincl.compiled import allocating, inner, kernel
from dincl.compiled.arrays import Floats, Offsets
from dincl.matrices.products import times, transposed_times

# Length of a projected gradient step, in units of 1 / |A A^T|; below 2 it descends.
FIXED_STEP = 1.9
# No step along a direction is longer [multiplier per unit of residual]: only an empty set asks for more, and its
# multipliers must grow to show it, but not beyond all numbers.
LONGEST_STEP = 1e12
# Multipliers that grow beyond this prove that the set is empty, or that rounding prevents a solution.
LARGEST = 1e10


@kernel
def bounded_conjugate_gradients(
    indptr: Offsets,
    indices: Offsets,
    data: Floats,
    columns: int,
    least: Floats,
    multiplier: Floats,
    most: int,
    tol: float,
) -> tuple[int, float]:
    """Minimise the dual by conjugate gradients on the active rows, lambda > 0 (MPRGP).

    A step that would make a multiplier negative ends at the bound and continues as a projected gradient step, after
    which more rows may be inactive. Where the inactive rows promise more descent than the active rows, a steepest
    descent step activates them.

    Parameters
    ----------
    columns : int
        The number of columns of A.
    least : (m,)
        The right-hand sides.
    most : int
        Iterations allowed; each costs a product with A^T and one with A.
    tol : float
        Stop once max |min(lambda, A A^T lambda - least)| is at most this, or a multiplier is above ``LARGEST``.

    Returns
    -------
    iterations : int
        Iterations done.
    residual : float
        The largest |min(lambda, slope)| at the end, of a slope that was updated and not recomputed.

    Notes
    -----
    Dostal, Schoeberl: Minimizing quadratic functions subject to bound constraints, Comput. Optim. Appl. 30 (2005).
    """
    m = multiplier.size
    u, slope, image, direction = np.empty(columns), np.empty(m), np.empty(m), np.empty(m)
    step = FIXED_STEP / _largest_eigenvalue(indptr, indices, data, columns)
    _write_slope(indptr, indices, data, least, multiplier, u, slope)
    _restart(multiplier, slope, True, direction)
    residual = np.inf
    for iteration in range(most):
        residual, active, inactive, largest = _measures(multiplier, slope, step)
        if residual <= tol or largest > LARGEST:
            return iteration, residual
        if inactive > active:
            _restart(multiplier, slope, False, direction)
        transposed_times(indptr, indices, data, direction, u)
        times(indptr, indices, data, u, image)
        gain, square, to_bound = 0.0, 0.0, np.inf
        for row in range(m):
            gain += slope[row] * direction[row]
            if direction[row] > 0.0:
                to_bound = min(to_bound, multiplier[row] / direction[row])
        for column in range(columns):
            square += u[column] * u[column]
        length = min(gain / square, LONGEST_STEP)
        if length <= to_bound:
            for row in range(m):
                multiplier[row] -= length * direction[row]
                slope[row] -= length * image[row]
            if inactive > active:
                _restart(multiplier, slope, True, direction)
            else:
                _conjugate(multiplier, slope, image, square, direction)
        else:
            for row in range(m):
                if multiplier[row] > 0.0:
                    at_bound = multiplier[row] - to_bound * direction[row]
                    descent = slope[row] - to_bound * image[row]
                    multiplier[row] = max(at_bound - step * descent, 0.0) if at_bound > 0.0 else 0.0
            _write_slope(indptr, indices, data, least, multiplier, u, slope)
            _restart(multiplier, slope, True, direction)
    return most, residual


@allocating
def _largest_eigenvalue(indptr: Offsets, indices: Offsets, data: Floats, columns: int) -> float:
    """Bound the eigenvalues of A A^T by the largest row sum of |A| |A|^T."""
    total = np.zeros(columns)
    for p in range(indices.size):
        total[indices[p]] += abs(data[p])
    largest = 0.0
    for row in range(indptr.size - 1):
        row_sum = 0.0
        for p in range(indptr[row], indptr[row + 1]):
            row_sum += abs(data[p]) * total[indices[p]]
        largest = max(largest, row_sum)
    return largest


@inner
def _write_slope(
    indptr: Offsets, indices: Offsets, data: Floats, least: Floats, multiplier: Floats, u: Floats, slope: Floats
) -> None:
    """Write u = A^T lambda and the slope A u - least of the dual."""
    transposed_times(indptr, indices, data, multiplier, u)
    times(indptr, indices, data, u, slope)
    for row in range(multiplier.size):
        slope[row] -= least[row]


@inner
def _measures(multiplier: Floats, slope: Floats, step: float) -> tuple[float, float, float, float]:
    """max |min(lambda, slope)|, the descent that the active and the inactive rows promise, and max lambda."""
    residual, active, inactive, largest = 0.0, 0.0, 0.0, 0.0
    for row in range(multiplier.size):
        largest = max(largest, multiplier[row])
        if multiplier[row] > 0.0:
            active += slope[row] * min(multiplier[row] / step, slope[row])
            residual = max(residual, abs(min(multiplier[row], slope[row])))
        elif slope[row] < 0.0:
            inactive += slope[row] * slope[row]
            residual = max(residual, -slope[row])
    return residual, active, inactive, largest


@inner
def _restart(multiplier: Floats, slope: Floats, active: bool, direction: Floats) -> None:
    """Write the slope of the active rows, or of the inactive rows along which the dual falls, into ``direction``."""
    for row in range(multiplier.size):
        if active:
            direction[row] = slope[row] if multiplier[row] > 0.0 else 0.0
        else:
            direction[row] = slope[row] if multiplier[row] <= 0.0 and slope[row] < 0.0 else 0.0


@inner
def _conjugate(multiplier: Floats, slope: Floats, image: Floats, square: float, direction: Floats) -> None:
    """Turn ``direction`` to the slope of the active rows, conjugate to itself: image = A A^T direction."""
    overlap = 0.0
    for row in range(multiplier.size):
        if multiplier[row] > 0.0:
            overlap += slope[row] * image[row]
    share = overlap / square
    for row in range(multiplier.size):
        direction[row] = (slope[row] if multiplier[row] > 0.0 else 0.0) - share * direction[row]
