"""Standard normal numbers, eight pairs at once: Threefry-2x32 (Salmon and others, 2011) and Box and Muller (1958).

A counter-based generator has no state: its numbers are a function of a key and a counter. So eight of them are made
side by side, whether they belong to eight cells of one tissue or to one cell of eight tissues, and are the same.
"""

from __future__ import annotations

import math
from typing import Any

from llvmlite import ir
from numba import types
from numpy.random import Generator

from tissue.kernels._numba import kernel
from tissue.kernels.lanes import (
    LANES,
    WIDTH,
    binary_parts,
    either,
    fma,
    instruction,
    load,
    load_words,
    spread,
    store,
    twice_rsqrt,
)
from tissue.model.cells import Floats, Integers

# Of Threefry-2x32: its rounds, how far each of eight rounds in turn rotates, and the parity of the key.
ROUNDS, ROTATIONS, PARITY = 20, (13, 15, 26, 6, 17, 29, 16, 24), 0x1BD11BDA
WORDS = 2.0**32
_WORD = ir.IntType(32)
_VECTOR = ir.VectorType(_WORD, WIDTH)
# Taylor coefficients in x^2 of sin(x)/x and cos x, for |x| <= pi/4, and of artanh(x)/x, for |x| <= 3 - 2 sqrt 2: what
# they leave out is below 1e-13, the accuracy of ``twice_rsqrt``.
TERMS = range(8)
SINE = tuple((-1) ** k / math.factorial(2 * k + 1) for k in TERMS)
COSINE = tuple((-1) ** k / math.factorial(2 * k) for k in TERMS)
ARTANH = tuple(1 / (2 * k + 1) for k in TERMS)
ROOT, LOGARITHM = math.sqrt(2.0), math.log(2.0)


@kernel
def draw_key(noise: Generator, key: Integers) -> None:
    """One key of two words for all lanes: the first word in key[:WIDTH], the second one behind."""
    first, second = int(WORDS * noise.random()), int(WORDS * noise.random())
    for lane in range(WIDTH):
        key[lane], key[WIDTH + lane] = first, second


@instruction
def threefry(typing: Any, key: Any, counter: Any, place: Any, number: Any) -> Any:
    """Two words of each lane, as doubles: a function of its key and of its counter (counter[place + lane], number).

    ``key`` has the first words of the eight keys, then the second ones; all words are whole numbers below 2^32.
    """

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        """The rounds, written out."""
        zero, width = ir.Constant(ir.IntType(64), 0), ir.Constant(ir.IntType(64), WIDTH)
        keys = [load_words(context, builder, signature.args[0], values[0], at) for at in (zero, width)]
        at = context.cast(builder, values[2], signature.args[2], types.intp)
        x = load_words(context, builder, signature.args[1], values[1], at)
        y = _spread(builder, builder.trunc(context.cast(builder, values[3], signature.args[3], types.int64), _WORD))
        keys.append(builder.xor(builder.xor(*keys), _constant(PARITY)))
        x, y = builder.add(x, keys[0]), builder.add(y, keys[1])
        for k in range(ROUNDS):
            x, turn = builder.add(x, y), ROTATIONS[k % len(ROTATIONS)]
            turned = builder.or_(builder.shl(y, _constant(turn)), builder.lshr(y, _constant(32 - turn)))
            y = builder.xor(turned, x)
            if k % 4 == 3:
                made = (k + 1) // 4
                x = builder.add(x, keys[made % 3])
                y = builder.add(builder.add(y, keys[(made + 1) % 3]), _constant(made))
        double = ir.VectorType(ir.DoubleType(), WIDTH)
        return context.make_tuple(builder, signature.return_type, [builder.uitofp(word, double) for word in (x, y)])

    return types.UniTuple(LANES, 2)(key, counter, place, number), generate


def _constant(value: int) -> ir.Constant:
    return ir.Constant(_VECTOR, [value] * WIDTH)


def _spread(builder: Any, word: Any) -> Any:
    undefined, places = ir.Constant(_VECTOR, ir.Undefined), ir.Constant(ir.VectorType(_WORD, WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(builder.insert_element(undefined, word, ir.Constant(_WORD, 0)), undefined, places)


@kernel
def _series(c: tuple[float, ...], x: Any) -> Any:
    """c[0] + c[1] x + ... + c[7] x^7 in three rounds (Estrin): one round waits for the one before."""
    square = x * x
    low = fma(fma(x, c[3], spread(c[2])), square, fma(x, c[1], spread(c[0])))
    high = fma(fma(x, c[7], spread(c[6])), square, fma(x, c[5], spread(c[4])))
    return fma(high, square * square, low)


@kernel
def normals(key: Integers, counter: Integers, place: int, number: int) -> tuple[Any, Any]:
    """Eight pairs of independent N(0, 1), sqrt(-2 ln u) (cos, sin)(2 pi v - pi); arguments as of ``threefry``.

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
    sine, cosine = 2.0 * sine * cosine, fma(-2.0 * sine, sine, spread(1.0))  # of half the angle
    return radius * fma(-2.0 * sine, sine, spread(1.0)), radius * (2.0 * sine * cosine)


@kernel
def shake(x: Floats, y: Floats, ids: Integers, places: int, variance: float, key: Integers, number: int) -> None:
    """Add N(0, variance) to each coordinate of the nuclei: a function of key, id of the cell and ``number`` alone."""
    if variance == 0.0:
        return
    deviation = math.sqrt(variance)
    for place in range(0, places, WIDTH):
        along_x, along_y = normals(key, ids, place, number)
        store(x, place, fma(deviation, along_x, load(x, place)))
        store(y, place, fma(deviation, along_y, load(y, place)))
