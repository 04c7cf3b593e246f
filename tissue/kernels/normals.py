"""Standard normal numbers: Threefry-2x32 (Salmon and others, 2011) and Box and Muller (1958).

A counter-based generator has no state: its numbers are a function of a key and a counter. So they are the same for a
cell of one tissue alone and for one of eight tissues side by side.
"""

from __future__ import annotations

import math
from typing import Any

from dincl.compiled import inner
from dincl.compiled.generators import threefry
from dincl.compiled.lanes import binary_parts, either, fma, twice_rsqrt
from tissue.state.cells import Integers

WORDS = 2.0**32
# Taylor coefficients in x^2 of sin(x)/x and cos x, for |x| <= pi/4, and of artanh(x)/x, for |x| <= 3 - 2 sqrt 2: what
# they leave out is below 1e-13, the accuracy of ``twice_rsqrt``.
TERMS = range(8)
SINE = tuple((-1) ** k / math.factorial(2 * k + 1) for k in TERMS)
COSINE = tuple((-1) ** k / math.factorial(2 * k) for k in TERMS)
ARTANH = tuple(1 / (2 * k + 1) for k in TERMS)
ROOT, LOGARITHM = math.sqrt(2.0), math.log(2.0)


@inner
def _series(c: tuple[float, ...], x: Any) -> Any:
    """c[0] + c[1] x + ... + c[7] x^7 in three rounds (Estrin): one round waits for the one before."""
    square = x * x
    low = fma(fma(x, c[3], c[2]), square, fma(x, c[1], c[0]))
    high = fma(fma(x, c[7], c[6]), square, fma(x, c[5], c[4]))
    return fma(high, square * square, low)


@inner
def normals(key: Integers, counter: Integers, place: int, number: int) -> tuple[Any, Any]:
    """Return two independent N(0, 1), sqrt(-2 ln u) (cos, sin)(2 pi v - pi); arguments as of ``threefry``.

    u and v lie in the middle of 2^32 equal parts of (0, 1), so that no number is beyond 6.8.
    """
    word, other = threefry(key, counter, place, number)
    mantissa, exponent = binary_parts((word + 0.5) * (1 / WORDS))
    above = mantissa - ROOT
    mantissa, exponent = either(above, 0.5 * mantissa, mantissa), either(above, exponent + 1.0, exponent)
    ratio = (mantissa - 1.0) / (mantissa + 1.0)
    square = -2.0 * fma(exponent, LOGARITHM, 2.0 * ratio * _series(ARTANH, ratio * ratio))
    radius = 0.5 * square * twice_rsqrt(square)
    quarter = fma(other + 0.5, 0.5 * math.pi / WORDS, -0.25 * math.pi)
    sine, cosine = quarter * _series(SINE, quarter * quarter), _series(COSINE, quarter * quarter)
    sine, cosine = 2.0 * sine * cosine, fma(-2.0 * sine, sine, 1.0)  # of half the angle
    return radius * fma(-2.0 * sine, sine, 1.0), radius * (2.0 * sine * cosine)
