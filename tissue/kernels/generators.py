"""Random numbers in kernels: generators of NumPy by address, and Threefry-2x32 for one number or eight lanes.

With generators as arguments numba would compile a kernel for one tissue and once more for eight: the first run of eight
would take 1.5 times as long.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numpy.random import Generator
from numpy.typing import NDArray

from dincl.compiled.calls import instruction
from tissue.kernels.vectors import DOUBLE, LONG, SHORT, address_of, broadcast, constant, kind_of, like, load_at

# The words of a generator: the state of its bits, and the functions that take a double and 64 bits from there.
GENERATOR = 3
# Threefry-2x32: its rounds, the rotation of each of eight rounds in turn [bits], and the parity of the key.
ROUNDS, ROTATIONS, PARITY = 20, (13, 15, 26, 6, 17, 29, 16, 24), 0x1BD11BDA


def generator_words(generator: Generator) -> NDArray[np.int64]:
    """Make the words that ``generator_at`` reads, (GENERATOR,); the generator must outlive them."""
    bits: Any = generator.bit_generator
    functions = (
        ctypes.cast(getattr(bits.ctypes, name), ctypes.c_void_p).value for name in ("next_double", "next_uint64")
    )
    return np.array([bits.ctypes.state_address, *functions], dtype=np.int64)


@instruction
def generator_at(typing: Any, words: Any, k: Any) -> Any:
    """Return generator k of an array (k, GENERATOR): a ``numpy.random.Generator`` for doubles and normal numbers."""
    kind, bits_kind = types.npy_rng, types.npy_bitgen

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, values[0]).data
        begin = builder.gep(data, [builder.mul(values[1], context.get_constant(types.intp, GENERATOR))])
        state, double, long = (builder.load(cgutils.gep_inbounds(builder, begin, k)) for k in range(GENERATOR))
        bits = cgutils.create_struct_proxy(bits_kind)(context, builder)
        bits.state_address = bits.state = state
        bits.fnptr_next_double, bits.fnptr_next_uint64 = double, long
        made = cgutils.create_struct_proxy(kind)(context, builder)
        made.bit_generator = bits._getvalue()
        return made._getvalue()

    return kind(words, types.intp), generate


@instruction
def threefry(typing: Any, key: Any, counter: Any, place: Any, number: Any) -> Any:
    """Compute two words, as doubles: a function of the two words of ``key`` and of (counter[place], number).

    All words are whole numbers below 2^32; of eight lanes each has a key and a counter of its own.
    """
    kind = kind_of(key, counter)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        """Write out the rounds."""
        word, (of_key, of_counter, _, _) = like(kind, SHORT), signature.args

        def read(kind: Any, array: Any, index: Any) -> Any:
            return builder.trunc(load_at(builder, address_of(context, builder, kind, LONG, array, index)), word)

        keys = [read(of_key, values[0], ir.Constant(LONG, k)) for k in range(2)]
        x, y = read(of_counter, values[1], values[2]), builder.trunc(values[3], SHORT)
        y = broadcast(builder, y) if word != SHORT else y
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
        doubles = [builder.uitofp(part, like(kind, DOUBLE)) for part in (x, y)]
        return context.make_tuple(builder, signature.return_type, doubles)

    return types.UniTuple(kind, 2)(key, counter, types.intp, types.int64), generate
