"""Reference implementations of kernels of dincl in plain Python: same arguments, same bits, written to be read.

They loop over Python floats in the order of the kernels, because a sum taken in another order may round differently.
"""

import numpy as np

from dincl.compiled.arrays import Floats, Offsets


def _square_distance(a: Floats, b: Floats) -> float:
    """Sum (a_k - b_k)^2 over the axes in their order."""
    total = 0.0  # sum() would compensate for rounding, from Python 3.12 on
    for p, q in zip(a.tolist(), b.tolist(), strict=True):
        total += (p - q) * (p - q)
    return total


def neighbour_pairs(x: Floats, radius: Floats) -> tuple[Offsets, Offsets]:
    """Reference implementation of ``neighbour_pairs``."""
    pairs = [
        (i, j)
        for i in range(x.shape[0])
        for j in range(i)
        if _square_distance(x[i], x[j]) <= float(radius[i] + radius[j]) * float(radius[i] + radius[j])
    ]
    i, j = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return i, j
