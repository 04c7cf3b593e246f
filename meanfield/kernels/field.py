"""Effective mass and force of a measure of particles in one pass over the particles, and the interaction of all pairs.

The sums over pairs take O(N^2) operations, or O(N p) on a line where polynomials of degree p resolve the kernel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.compiled import inner, kernel
from meanfield.kernels.program import BLOCK, Program, compute_common, run_block

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats

# Interaction of the particles: none, by their mean (V is quadratic), by pairs.
NONE, BY_MEAN, BY_PAIRS = 0, 1, 2
# Least pivot of an effective mass relative to its largest entry. The matrix is the identity plus a positive
# semidefinite one; where that is about 1e14 in one direction and zero in another, the identity is lost to rounding.
LEAST_PIVOT = 1e-14
# Interpolation is tried from this many particles on; below, the direct sum is as fast. Degrees that are tried; one is
# sufficient if the last TAIL_TERMS coefficients of the kernel are this small relative to the largest one.
MIN_INTERPOLATED = 200
DEGREES = (16, 32, 64, 128)
SUFFICIENT, TAIL_TERMS = 1e-14, 3


class Pairs(NamedTuple):
    """Kernel of the interaction: a program of r = X_k - X_i, and the workspace of its interpolation.

    ``nodes`` (4, 129, 129) has T_j at the Chebyshev points of each degree, ``work`` (3, 129).
    """

    program: Program
    nodes: Floats
    work: Floats


class Measure(NamedTuple):
    """Particles of a model with weights.

    Attributes
    ----------
    program
        outputs of one particle: velocity Phi v (nx), m Phi^T Phi (ny^2), Phi^T (F1 + K - m Omega) (ny), det dg/dX, F0
        (ny); common inputs y, v, and the mean of X if the interaction is ``BY_MEAN``; other inputs K if ``BY_PAIRS``.
    interaction, pairs
        NONE, BY_MEAN or BY_PAIRS; the kernel K.
    orientation
        sign of det dg/dX at the start.
    weights
        (Q,), >= 0, sum 1.
    forces, inputs, sums, mass
        workspace: K at the particles (Q, nx), common inputs, sums (ny^2 + ny,), system of equations (ny, ny + 1).
    """

    program: Program
    interaction: int
    pairs: Pairs
    orientation: float
    weights: Floats
    forces: Floats
    inputs: Floats
    sums: Floats
    mass: Floats


@inner
def rates(m: Measure, fresh: bool, X: Floats, state: Floats, U: Floats, a: Floats) -> tuple[int, float]:
    """Compute velocities U = Phi v of particles X (Q, nx) and a = y'' (5.11a) from the state (y, v, ...).

    Unless ``fresh``, X is that of the last call, and the workspace of the program has a block for each BLOCK particles.

    Returns
    -------
    wrong, wrong_mass
        number and weight of the particles whose det dg/dX does not have the sign that it had at the start.

    Source: (5.9), (5.13), (5.14).
    """
    ny, nx, count = m.mass.shape[0], X.shape[1], X.shape[0]
    for k in range(2 * ny):
        m.inputs[k] = state[k]
    if m.interaction == BY_MEAN:
        for j in range(nx):
            total = 0.0
            for i in range(count):
                total += m.weights[i] * X[i, j]
            m.inputs[2 * ny + j] = total
    elif m.interaction == BY_PAIRS:
        pair_sums(m.pairs, X, m.weights, m.forces)
    p = m.program
    compute_common(p, m.inputs)
    for k in range(m.sums.size):
        m.sums[k] = 0.0
    wrong, wrong_mass = 0, 0.0
    for begin in range(0, count, BLOCK):
        n = min(BLOCK, count - begin)
        block = begin // BLOCK if p.values.shape[0] > 1 else 0
        run_block(p, block, fresh, X, m.forces, begin, n)
        w, values = m.weights[begin : begin + n], p.values[block]
        for j in range(U.shape[1]):
            row = values[p.outputs[j]]
            for i in range(n):
                U[begin + i, j] = row[i]
        for k in range(m.sums.size):
            m.sums[k] += _weighted_sum(w, values[p.outputs[nx + k]])
        determinant = values[p.outputs[nx + m.sums.size]]
        for i in range(n):
            if not determinant[i] * m.orientation > 0.0:
                wrong += 1
                wrong_mass += w[i]
    first = nx + m.sums.size + 1
    for k in range(ny):
        for j in range(ny):
            m.mass[k, j] = m.sums[k + j * ny] + (1.0 if j == k else 0.0)
        m.mass[k, ny] = p.common[p.outputs[first + k], 0] + m.sums[ny * ny + k]
    solve_mass(m.mass, a)
    return wrong, wrong_mass


@inner
def _weighted_sum(w: Floats, values: Floats) -> float:
    """Sum in four parts, which the processor adds at the same time."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    whole = w.size // 4 * 4
    for i in range(0, whole, 4):
        a += w[i] * values[i]
        b += w[i + 1] * values[i + 1]
        c += w[i + 2] * values[i + 2]
        d += w[i + 3] * values[i + 3]
    for i in range(whole, w.size):
        a += w[i] * values[i]
    return (a + b) + (c + d)


@inner
def solve_mass(system: Floats, a: Floats) -> None:
    """Solve M a = F for the system (M, F) of shape (n, n + 1), which is overwritten; NaN if M is ill-conditioned."""
    n = system.shape[0]
    largest = 0.0
    for i in range(n):
        for j in range(n):
            largest = max(largest, abs(system[i, j]))
    for k in range(n):
        if not system[k, k] > LEAST_PIVOT * largest:
            for i in range(n):
                a[i] = np.nan
            return
        for i in range(k + 1, n):
            factor = system[i, k] / system[k, k]
            for j in range(k + 1, n + 1):
                system[i, j] -= factor * system[k, j]
    for k in range(n - 1, -1, -1):
        total = system[k, n]
        for j in range(k + 1, n):
            total -= system[k, j] * a[j]
        a[k] = total / system[k, k]


@inner
def pair_sums(pairs: Pairs, X: Floats, w: Floats, out: Floats) -> None:
    """Compute sum_k w_k K(X_k - X_i) for each i, all outputs of the program: (Q, outputs)."""
    compute_common(pairs.program, w[:0])
    if X.shape[1] == 1 and X.shape[0] >= MIN_INTERPOLATED and _smooth_sums(pairs, X[:, 0], w, out[:, 0]):
        return
    p = pairs.program
    values = p.values[0]
    for i in range(X.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = 0.0
        for begin in range(0, X.shape[0], BLOCK):
            n = min(BLOCK, X.shape[0] - begin)
            for j in range(X.shape[1]):
                row = values[p.parts[3] + j]
                for k in range(n):
                    row[k] = X[begin + k, j] - X[i, j]
            _run_pairs(p, n)
            for j in range(out.shape[1]):
                out[i, j] += _weighted_sum(w[begin : begin + n], values[p.outputs[j]])


@inner
def _run_pairs(p: Program, n: int) -> None:
    """Evaluate the kernel at n distances that are in the workspace."""
    run_block(p, 0, True, p.none, p.none, 0, n)


@inner
def _smooth_sums(pairs: Pairs, x: Floats, w: Floats, out: Floats) -> bool:
    """Compute the sums by interpolation in both points; False if no degree resolves the kernel to rounding.

    The moments of w T_j(x) give equivalent weights at the nodes; the sum, a function of x_i, is interpolated from its
    values at the nodes. A kernel that is a polynomial of degree p in x_k - x_i to accuracy e is one of degree p in each
    of the points, and the interpolation has an error of at most (1 + 2 log p)^2 e.
    """
    p, moments, weights, sums = pairs.program, pairs.work[0], pairs.work[1], pairs.work[2]
    distances, found = p.values[0, p.parts[3]], p.values[0, p.outputs[0]]
    low, high = x[0], x[0]
    for i in range(x.size):
        low, high = min(low, x[i]), max(high, x[i])
    level = _sufficient(pairs, high - low) if low < high else -1
    if level < 0:
        return False
    nodes, n, centre, half = pairs.nodes[level], DEGREES[level] + 1, (low + high) / 2, (high - low) / 2
    for j in range(n):
        moments[j] = 0.0
    for i in range(x.size):
        s = (x[i] - centre) / half
        before, now = w[i], w[i] * s
        moments[0] += before
        for j in range(1, n):
            moments[j] += now
            before, now = now, 2 * s * now - before
    for j in range(n):
        moments[j] *= (1.0 if j == 0 else 2.0) / n
    for a in range(n):
        weights[a] = 0.0
        for j in range(n):
            weights[a] += nodes[a, j] * moments[j]
    for a in range(n):
        for b in range(n):
            distances[b] = half * (nodes[b, 1] - nodes[a, 1])
        _run_pairs(p, n)
        sums[a] = _weighted_sum(weights[:n], found)
    for j in range(n):
        moments[j] = 0.0
        for a in range(n):
            moments[j] += (1.0 if j == 0 else 2.0) / n * nodes[a, j] * sums[a]
    for i in range(x.size):
        s = (x[i] - centre) / half
        now, after = 0.0, 0.0
        for j in range(n - 1, 0, -1):
            now, after = moments[j] + 2 * s * now - after, now
        out[i] = moments[0] + s * now - after
    return True


@inner
def _sufficient(pairs: Pairs, length: float) -> int:
    """Return the place of the first degree that resolves the kernel on [-length, length] to rounding; -1 for none."""
    p = pairs.program
    distances, values = p.values[0, p.parts[3]], p.values[0, p.outputs[0]]
    for level in range(len(DEGREES)):
        nodes, n = pairs.nodes[level], DEGREES[level] + 1
        for a in range(n):
            distances[a] = length * nodes[a, 1]
        _run_pairs(p, n)
        tail, largest = 0.0, 0.0
        for j in range(n):
            total = 0.0
            for a in range(n):
                total += nodes[a, j] * values[a]
            size = abs(total) * (0.5 if j == 0 else 1.0)
            largest = max(largest, size)
            if j >= n - TAIL_TERMS:
                tail = max(tail, size)
        if tail <= SUFFICIENT * largest:
            return level
    return -1


@kernel
def sums_over_pairs(pairs: Pairs, X: Floats, w: Floats, out: Floats) -> None:
    """Compute sum_k w_k K(X_k - X_i) for each i."""
    pair_sums(pairs, X, w, out)


@kernel
def rates_of(m: Measure, X: Floats, state: Floats, U: Floats, a: Floats) -> None:
    """Compute velocities U and a = y'' as ``rates``."""
    rates(m, True, X, state, U, a)
