"""The noise of the nuclei: once per dt from a generator, or in each substep as a function of a key.

Standard normal numbers of substeps are those of Threefry-2x32 (Salmon and others, 2011) and Box and Muller (1958). A
counter-based generator has no state: its numbers are a function of a key and a counter. So they are the same for a cell
of one tissue alone and for one of eight tissues side by side.
"""

from __future__ import annotations

import math
from typing import Any

from numpy.random import Generator

from dincl.compiled import inner
from tissue.kernels.generators import threefry
from tissue.kernels.lanes import binary_parts, either, fma, load, positive_bits, twice_rsqrt
from tissue.kernels.lanes import store as put
from tissue.state.cells import Integers
from tissue.state.running import CELLS, TissueState
from tissue.state.space import SPATIAL

# How many values each of the two words of a key has.
WORD_VALUES = 2.0**32
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
def normal_pair(key: Integers, counter: Integers, place: int, number: int) -> tuple[Any, Any]:
    """Return two independent N(0, 1), sqrt(-2 ln u) (cos, sin)(2 pi v - pi); arguments as of ``threefry``.

    u and v lie in the middle of 2^32 equal parts of (0, 1), so that no number is beyond 6.8.
    """
    word, other = threefry(key, counter, place, number)
    mantissa, exponent = binary_parts((word + 0.5) * (1 / WORD_VALUES))
    above = mantissa - ROOT
    mantissa, exponent = either(above, 0.5 * mantissa, mantissa), either(above, exponent + 1.0, exponent)
    ratio = (mantissa - 1.0) / (mantissa + 1.0)
    square = -2.0 * fma(exponent, LOGARITHM, 2.0 * ratio * _series(ARTANH, ratio * ratio))
    radius = 0.5 * square * twice_rsqrt(square)
    quarter = fma(other + 0.5, 0.5 * math.pi / WORD_VALUES, -0.25 * math.pi)
    sine, cosine = quarter * _series(SINE, quarter * quarter), _series(COSINE, quarter * quarter)
    sine, cosine = 2.0 * sine * cosine, fma(-2.0 * sine, sine, 1.0)  # of half the angle
    return radius * fma(-2.0 * sine, sine, 1.0), radius * (2.0 * sine * cosine)


# Added to the number of a substep where the depth is drawn: along x and y the noise is that of the section z = 0.
DEPTH = 1 << 31


@inner
def add_noise(state: TissueState, variance: float, noise: Generator) -> None:
    """Add N(0, variance) to each coordinate of the nuclei, (3.35); draw nothing if there is no variance."""
    if variance == 0.0:
        return
    deviation, x, y, z = math.sqrt(variance), state.cells.x, state.cells.y, state.cells.z
    for i in range(state.sizes[CELLS]):
        x[i] += deviation * noise.standard_normal()
        y[i] += deviation * noise.standard_normal()
        if state.space.dimension == SPATIAL:
            z[i] += deviation * noise.standard_normal()


@inner
def add_substep_noise(work: Any, rows: int, number: int) -> None:
    """Add N(0, deviation^2) to each coordinate of the nuclei, if noise comes in substeps; the workspace is in rows.

    It is a function of the key, the id of the cell and the number of the substep alone.
    """
    deviation, x, y, z = load(work.deviation, 0), work.x, work.y, work.z
    if positive_bits(deviation):
        for i in range(rows):
            along_x, along_y = normal_pair(work.noise_key, work.id, i, number)
            along_z, _ = normal_pair(work.noise_key, work.id, i, DEPTH + number)
            put(x, i, fma(deviation, along_x, load(x, i)))
            put(y, i, fma(deviation, along_y, load(y, i)))
            put(z, i, fma(deviation, along_z, load(z, i)))
