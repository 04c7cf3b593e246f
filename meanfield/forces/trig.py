"""Sine and cosine without branches, with which a loop over particles is vectorised.

x = n pi/2 + r with |r| <= pi/4, where n pi/2 is subtracted in three parts whose products with n are exact (Cody and
Waite); then Taylor polynomials, whose next terms are below 1e-18. The error is below 2e-16 for |x| <= MAX_ANGLE.

Both functions are compiled when this module is imported. Compiled on first use they would inherit the fast-math flags
of the calling loop, which allow the compiler to add the three parts into one.
"""

from __future__ import annotations

import math

import numpy as np

from dincl.compiled.functions import compile_now

# The first two parts of pi/2 have 33 bits, so that products with n < 2^20 are exact.
PART_1, PART_2, PART_3 = 1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21
MAX_ANGLE = 2.0**20
QUARTERS = 2 / math.pi
# Coefficients of (sin r - r) / r^3 and of (cos r - 1 + r^2/2) / r^4 as polynomials in r^2, highest power first.
SINE = tuple((-1) ** k / math.factorial(2 * k + 1) for k in range(8, 0, -1))
COSINE = tuple((-1) ** k / math.factorial(2 * k) for k in range(9, 1, -1))


@compile_now((float, float, float, float), float)
def _pieces(x: float) -> tuple[float, float, float, float]:
    """Compute sin r, cos r, and 1 or 0 for odd or even n and floor(n/2)."""
    n = np.rint(x * QUARTERS)
    r = ((x - n * PART_1) - n * PART_2) - n * PART_3
    z = r * r
    sine, cosine = SINE[0], COSINE[0]
    # Horner's scheme is written out because numba does not unroll a loop over a tuple.
    sine, cosine = sine * z + SINE[1], cosine * z + COSINE[1]
    sine, cosine = sine * z + SINE[2], cosine * z + COSINE[2]
    sine, cosine = sine * z + SINE[3], cosine * z + COSINE[3]
    sine, cosine = sine * z + SINE[4], cosine * z + COSINE[4]
    sine, cosine = sine * z + SINE[5], cosine * z + COSINE[5]
    sine, cosine = sine * z + SINE[6], cosine * z + COSINE[6]
    sine, cosine = sine * z + SINE[7], cosine * z + COSINE[7]
    half = np.floor(0.5 * n)
    return r + r * z * sine, 1.0 - (0.5 * z - z * z * cosine), n - 2.0 * half, half - 2.0 * np.floor(0.5 * half)


@compile_now(float, float)
def sin(x: float) -> float:
    """Compute the sine of |x| <= MAX_ANGLE."""
    sine, cosine, odd, odd_half = _pieces(x)
    return (1.0 - 2.0 * odd_half) * (cosine if odd == 1.0 else sine)


@compile_now(float, float)
def cos(x: float) -> float:
    """Compute the cosine of |x| <= MAX_ANGLE."""
    sine, cosine, odd, odd_half = _pieces(x)
    sign = (1.0 - 2.0 * odd_half) * (1.0 - 2.0 * odd)
    return sign * (sine if odd == 1.0 else cosine)
