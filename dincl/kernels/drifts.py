"""The drifts of ``dincl.drifts`` as a C function."""

from functools import partial

from dincl.compiled import c_function
from dincl.compiled.dispatchers import DRIFT
from dincl.kernels.arrays import Floats


@partial(c_function, DRIFT)
def affine(t: float, x: Floats, out: Floats, n: int, d: int, data: Floats) -> int:
    """F_i = c_i + a_i X_i + b_i J X_i, added up from left to right; J X = (-X_1, X_0) in the plane.

    data holds two numbers for each of c, a, b: where its numbers begin, 0 if there are none, and how far those of one
    particle lie from those of the next one.
    """
    c, c_step, a, a_step = int(data[0]), int(data[1]), int(data[2]), int(data[3])
    b, b_step = int(data[4]), int(data[5])
    for i in range(n):
        for k in range(d):
            out[i * d + k] = data[c + i * c_step + k] if c else -0.0  # -0 + y is y, but 0 + y is not where y is -0
    if a:
        for i in range(n):
            for k in range(d):
                out[i * d + k] += data[a + i * a_step] * x[i * d + k]
    if b:
        for i in range(n):
            out[2 * i] -= data[b + i * b_step] * x[2 * i + 1]
            out[2 * i + 1] += data[b + i * b_step] * x[2 * i]
    return 0
