"""Plain Python twins of the kernels of dincl: same arguments, same bits, written to be read and not to be fast.

They loop over Python floats in the order of the kernels, because a sum taken in another order may round differently.
"""

import math

import numpy as np

from dincl.kernels.arrays import Floats, Indices, Offsets
from dincl.kernels.sweeps import COINCIDENT, OK, STALE


def _square_distance(a: Floats, b: Floats) -> float:
    """Sum (a_k - b_k)^2 over the axes in their order."""
    total = 0.0  # sum() would compensate for rounding, from Python 3.12 on
    for p, q in zip(a.tolist(), b.tolist(), strict=True):
        total += (p - q) * (p - q)
    return total


def _dot(a: Floats, b: Floats) -> float:
    """Sum a_k b_k over the axes in their order."""
    total = 0.0
    for p, q in zip(a.tolist(), b.tolist(), strict=True):
        total += p * q
    return total


def near_pairs(x: Floats, reach: Floats) -> tuple[Offsets, Indices]:
    """Twin of ``neighbours.near_pairs`` and ``neighbours.brute_force_pairs``."""
    rows = [
        [j for j in range(i) if _square_distance(x[i], x[j]) <= float(reach[i] + reach[j]) * float(reach[i] + reach[j])]
        for i in range(x.shape[0])
    ]
    start = np.cumsum([0, *map(len, rows)], dtype=np.int64)
    return start, np.array([j for row in rows for j in row], dtype=np.int32)


def sweep_pairs(
    x: Floats, start: Offsets, partner: Indices, radius: Floats, reference: Floats, slack: float
) -> tuple[int, int, int, int]:
    """Twin of ``sweeps.sweep_pairs``."""
    corrections = 0
    for i in range(x.shape[0]):
        for j in partner[start[i] : start[i + 1]].tolist():
            square = _square_distance(x[i], x[j])
            length = float(radius[i] + radius[j])
            if square >= length * length:
                continue
            inverse = 0.5 * length / square if square > 0.0 else math.inf
            if inverse == math.inf:
                return corrections, COINCIDENT, i, j
            move = (math.sqrt(square) * inverse - 0.5) * (x[i] - x[j])
            x[i] += move
            x[j] -= move
            corrections += 1
            if max(_square_distance(x[i], reference[i]), _square_distance(x[j], reference[j])) > slack * slack:
                return corrections, STALE, i, j
    return corrections, OK, -1, -1


def drifted(x: Floats, reference: Floats, slack: float, backup: Floats) -> bool:
    """Twin of ``sweeps.drifted``."""
    backup[:] = x
    return any(_square_distance(a, b) > slack * slack for a, b in zip(x, reference, strict=True))


def sweep_distance(
    x: Floats, i: Offsets, j: Offsets, length: Floats, sign: float, anchor: Floats
) -> tuple[int, int, int]:
    """Twin of ``sweeps.sweep_distance``."""
    corrections = 0
    for row in range(len(length)):
        fixed = j[row] < 0
        other = anchor[row].copy() if fixed else x[j[row]]
        square, wanted = _square_distance(x[i[row]], other), float(length[row])
        if sign * (square - wanted * wanted) >= 0.0:
            continue
        stretch = wanted / math.sqrt(square) if square > 0.0 else math.inf
        if stretch == math.inf:
            return corrections, COINCIDENT, row
        move = (1.0 if fixed else 0.5) * (stretch - 1.0) * (x[i[row]] - other)
        x[i[row]] += move
        if not fixed:
            x[j[row]] -= move
        corrections += 1
    return corrections, OK, -1


def sweep_affine(x_flat: Floats, indptr: Offsets, indices: Offsets, data: Floats, bound: Floats, norm2: Floats) -> int:
    """Twin of ``sweeps.sweep_affine``."""
    corrections = 0
    for row in range(len(bound)):
        entries = range(indptr[row], indptr[row + 1])
        missing = float(bound[row])
        for p in entries:
            missing -= float(data[p] * x_flat[indices[p]])
        if missing > 0.0:
            for p in entries:
                x_flat[indices[p]] += missing / norm2[row] * data[p]
            corrections += 1
    return corrections


def sweep_half_space(x: Floats, normal: Floats, bound: Floats) -> int:
    """Twin of ``sweeps.sweep_half_space``."""
    corrections = 0
    for i in range(x.shape[0]):
        height = _dot(normal, x[i])
        if height < bound[i]:
            x[i] += (bound[i] - height) * normal
            corrections += 1
    return corrections


def dual_sweeps(
    z: Floats,
    indptr: Offsets,
    indices: Offsets,
    data: Floats,
    bound: Floats,
    norm2: Floats,
    multipliers: Floats,
    max_sweeps: int,
    tol: float,
) -> tuple[int, float]:
    """Twin of ``sweeps.dual_sweeps``."""
    residual = math.inf
    for sweep in range(max_sweeps):
        residual = 0.0
        for row in range(len(bound)):
            entries = range(indptr[row], indptr[row + 1])
            missing = float(bound[row])
            for p in entries:
                missing -= float(data[p] * z[indices[p]])
            delta = max(-float(multipliers[row]), missing / float(norm2[row]))
            if delta == 0.0:
                continue
            multipliers[row] += delta
            for p in entries:
                z[indices[p]] += delta * data[p]
            residual = max(residual, abs(delta) * math.sqrt(norm2[row]))
        if residual <= tol:
            return sweep + 1, residual
    return max_sweeps, residual
