"""Velocities from drifts that are called by their address: one compiled kernel serves every drift."""

from __future__ import annotations

import numpy as np

from dincl.compiled import call, inner
from dincl.compiled.dispatchers import DRIFT
from dincl.constants import LARGEST
from dincl.kernels.arrays import Floats

# What ``velocity`` returns.
OK, FAILED, NOT_A_NUMBER = 0, 1, 2

# call_drift(address, t, x, out, n, d, data): DRIFT at the address. The arrays, float64 and C-contiguous, of any shape,
# must be as long as the function takes them to be.
call_drift = call(DRIFT)


@inner
def velocity(address: int, t: float, x: Floats, out: Floats, n: int, d: int, data: Floats) -> int:
    """out = F(t, x), with the check that all numbers are finite and at most LARGEST in magnitude.

    Parameters
    ----------
    address : int
        Of the drift, see ``call_drift``.
    t : float
        Time.
    x, out : (n, d) or (n d,)
        Positions [length] and velocities [length / time], two arrays; out is overwritten.
    n, d : int
        Particles and dimension.
    data : (k,)
        What the drift needs.

    Returns
    -------
    int
        OK, FAILED if the drift says so, NOT_A_NUMBER if a number of out is none or too large.
    """
    out.flat[0] = np.nan  # stays if the function returns early without saying so, as an interrupted callback does
    if call_drift(address, t, x, out, n, d, data) != 0:
        return FAILED
    for k in range(n * d):
        if not abs(out.flat[k]) <= LARGEST:
            return NOT_A_NUMBER
    return OK
