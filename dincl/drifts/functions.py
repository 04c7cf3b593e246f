"""Drifts in compiled code, called by their address, so that one kernel serves all drifts; and the affine drift."""

from functools import partial

import numpy as np

from dincl.compiled import c_function, call, inner
from dincl.compiled.arrays import Floats
from dincl.compiled.calls import DRIFT
from dincl.constants import LARGEST

# Return values of ``velocity``.
OK, FAILED, NOT_A_NUMBER = 0, 1, 2

# call_drift(address, t, x, out, n, d, data) calls the C function at an address. The arrays, float64 and C-contiguous,
# of any shape, must be as long as the function expects.
call_drift = call(DRIFT)


@inner
def velocity(address: int, t: float, x: Floats, out: Floats, n: int, d: int, data: Floats) -> int:
    """Write F(t, x) to ``out``, and check that all numbers are finite and at most LARGEST in magnitude.

    Parameters
    ----------
    address : int
        The address of the drift, see ``call_drift``.
    t : float
        Time.
    x, out : (n, d) or (n d,)
        Positions [length] and velocities [length / time], two arrays; out is overwritten.
    n, d : int
        Particles and dimension.
    data : (k,)
        The data of the drift.

    Returns
    -------
    int
        OK, FAILED if the drift fails, NOT_A_NUMBER if a number of out is not finite or too large.
    """
    out.flat[0] = np.nan  # remains if the function returns early without a code, as an interrupted callback does
    if call_drift(address, t, x, out, n, d, data) != 0:
        return FAILED
    wrong = 0
    for k in range(n * d):
        wrong += not abs(out.flat[k]) <= LARGEST
    return OK if wrong == 0 else NOT_A_NUMBER


@partial(c_function, DRIFT)
def affine(t: float, x: Floats, out: Floats, n: int, d: int, data: Floats) -> int:
    """Write F_i = c_i + a_i X_i + b_i J X_i, added from left to right; J X = (-X_1, X_0) in the plane.

    data begins with two numbers for each of c, a, b: the index of its first number, 0 if there is none, and the step
    from one particle to the next.
    """
    c, c_step, a, a_step = int(data[0]), int(data[1]), int(data[2]), int(data[3])
    b, b_step = int(data[4]), int(data[5])
    if c and c_step == d:
        for k in range(n * d):
            out[k] = data[c + k]
    else:
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
