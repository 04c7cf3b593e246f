"""Calls of C functions by their address, so that one compiled kernel serves every drift and every moving set."""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from dincl.compiled import inner
from dincl.constants import LARGEST
from dincl.kernels.arrays import Floats

# What ``velocity`` returns.
OK, FAILED, NOT_A_NUMBER = 0, 1, 2

_instruction: Any = intrinsic  # whose types do not say that the first argument is not the caller's


def _kind(given: Any) -> str:
    """How a C function takes an argument: "f" by value, "i" by value, "p" as the address of the numbers of an array."""
    if isinstance(given, types.Array) and given.dtype == types.float64 and given.layout == "C":
        return "p"
    return "f" if isinstance(given, types.Float) else "i" if isinstance(given, types.Integer) else "?"


@_instruction
def call_drift(typing: Any, address: Any, t: Any, x: Any, out: Any, n: Any, d: Any, data: Any) -> Any:
    """``int64 f(double t, double *x, double *out, int64 n, int64 d, double *data)`` at ``address``; 0 is success.

    The arrays are float64, C-contiguous, of any shape. They must be as long as the function takes them to be.
    """
    if "".join(map(_kind, (address, t, x, out, n, d, data))) != "ifppiip":
        return None
    word, place = types.int64, ir.DoubleType().as_pointer()
    signature = word(word, types.float64, x, out, word, word, data)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        plain = [
            context.make_array(of)(context, builder, value).data if isinstance(of, types.Array) else value
            for of, value in zip(signature.args, values, strict=True)
        ]
        taken = [ir.DoubleType(), place, place, ir.IntType(64), ir.IntType(64), place]
        function = ir.FunctionType(ir.IntType(64), taken)
        return builder.call(builder.inttoptr(plain[0], function.as_pointer()), plain[1:])

    return signature, generate


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
