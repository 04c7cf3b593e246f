"""Standard normal numbers: Threefry-2x32 (Salmon and others, 2011) and Box and Muller (1958).

A counter-based generator has no state: its numbers are a function of a key and a counter. So they are the same for a
cell of one tissue alone and for one of eight tissues side by side.
"""

from __future__ import annotations

import math
from typing import Any

from llvmlite import ir
from numba import types

from dincl.compiled import inner
from tissue.kernels.lanes import (
    constant,
    either,
    entry,
    fma,
    in_all,
    instruction,
    kind_of,
    like,
    load,
    store,
    twice_rsqrt,
)
from tissue.state.cells import Floats, Integers

# Of Threefry-2x32: its rounds, how far each of eight rounds in turn rotates, and the parity of the key.
ROUNDS, ROTATIONS, PARITY = 20, (13, 15, 26, 6, 17, 29, 16, 24), 0x1BD11BDA
WORDS = 2.0**32
_WORD, _LONG, _DOUBLE = ir.IntType(32), ir.IntType(64), ir.DoubleType()
# Taylor coefficients in x^2 of sin(x)/x and cos x, for |x| <= pi/4, and of artanh(x)/x, for |x| <= 3 - 2 sqrt 2: what
# they leave out is below 1e-13, the accuracy of ``twice_rsqrt``.
TERMS = range(8)
SINE = tuple((-1) ** k / math.factorial(2 * k + 1) for k in TERMS)
COSINE = tuple((-1) ** k / math.factorial(2 * k) for k in TERMS)
ARTANH = tuple(1 / (2 * k + 1) for k in TERMS)
ROOT, LOGARITHM = math.sqrt(2.0), math.log(2.0)


@instruction
def threefry(typing: Any, key: Any, counter: Any, place: Any, number: Any) -> Any:
    """Two words, as doubles: a function of the two words of ``key`` and of the counter (counter[place], number).

    All words are whole numbers below 2^32; of eight lanes each has a key and a counter of its own.
    """
    kind = kind_of(key, counter)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        """The rounds, written out."""
        word, (of_key, of_counter, _, _) = like(kind, _WORD), signature.args

        def read(kind: Any, array: Any, index: Any) -> Any:
            loaded = builder.load(entry(context, builder, kind, array, index, _LONG))
            loaded.align = 8
            return builder.trunc(loaded, word)

        keys = [read(of_key, values[0], ir.Constant(_LONG, k)) for k in range(2)]
        x, y = read(of_counter, values[1], values[2]), builder.trunc(values[3], _WORD)
        y = in_all(builder, y) if word != _WORD else y
        keys.append(builder.xor(builder.xor(*keys), constant(word, PARITY)))
        x, y = builder.add(x, keys[0]), builder.add(y, keys[1])
        for k in range(ROUNDS):
            x, turn = builder.add(x, y), ROTATIONS[k % len(ROTATIONS)]
            turned = builder.or_(builder.shl(y, constant(word, turn)), builder.lshr(y, constant(word, 32 - turn)))
            y = builder.xor(turned, x)
            if k % 4 == 3:
                made = (k + 1) // 4
                x = builder.add(x, keys[made % 3])
                y = builder.add(builder.add(y, keys[(made + 1) % 3]), constant(word, made))
        doubles = [builder.uitofp(part, like(kind, _DOUBLE)) for part in (x, y)]
        return context.make_tuple(builder, signature.return_type, doubles)

    return types.UniTuple(kind, 2)(key, counter, types.intp, types.int64), generate


@instruction
def binary_parts(typing: Any, v: Any) -> Any:
    """m and e of v = m 2^e, 1 <= m < 2; v must be positive and normal."""
    kind = kind_of(v)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        long, double = like(kind, _LONG), like(kind, _DOUBLE)
        bits = builder.bitcast(values[0], long)
        shift, mask, one = (constant(long, part) for part in (52, (1 << 52) - 1, 1023 << 52))
        mantissa = builder.bitcast(builder.or_(builder.and_(bits, mask), one), double)
        exponent = builder.fsub(builder.sitofp(builder.lshr(bits, shift), double), constant(double, 1023.0))
        return context.make_tuple(builder, signature.return_type, [mantissa, exponent])

    return types.UniTuple(kind, 2)(kind), generate


@inner
def _series(c: tuple[float, ...], x: Any) -> Any:
    """c[0] + c[1] x + ... + c[7] x^7 in three rounds (Estrin): one round waits for the one before."""
    square = x * x
    low = fma(fma(x, c[3], c[2]), square, fma(x, c[1], c[0]))
    high = fma(fma(x, c[7], c[6]), square, fma(x, c[5], c[4]))
    return fma(high, square * square, low)


@inner
def normals(key: Integers, counter: Integers, place: int, number: int) -> tuple[Any, Any]:
    """Two independent N(0, 1), sqrt(-2 ln u) (cos, sin)(2 pi v - pi); arguments as of ``threefry``.

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


@inner
def shake(x: Floats, y: Floats, ids: Integers, n: int, deviation: float, key: Integers, number: int) -> None:
    """Add N(0, deviation^2) to each coordinate of n nuclei: a function of key, id of the cell and ``number`` alone."""
    for i in range(n):
        along_x, along_y = normals(key, ids, i, number)
        store(x, i, fma(deviation, along_x, load(x, i)))
        store(y, i, fma(deviation, along_y, load(y, i)))
