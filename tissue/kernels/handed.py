"""What is handed to kernels by its address: a tuple of arrays and numbers, and generators of random numbers."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any, get_type_hints

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import NativeValue, unbox
from numpy.random import Generator

from dincl.compiled.structs import Handle, reader, written
from tissue.kernels.lanes import instruction
from tissue.state.cells import Integers
from tissue.state.numbers import Numbers

# The words of a generator: the state of its bits, and the functions that take a double and 64 bits from there.
GENERATOR = 3


class Handed:
    """A named tuple of arrays and numbers in memory; kernels take it as its address, see ``dincl.compiled.structs``.

    Attributes
    ----------
    parts
        The arrays, which kernels change in place.
    address
        Where the tuple is, as long as this object lives.
    """

    def __init__(self, parts: Any, kind: Any) -> None:
        self.parts = parts
        self._words = written(parts)
        self.address: int = self._words.ctypes.data
        self._numba_type_ = kind  # how numba knows its type


_unboxing: Any = unbox  # whose types do not say what it takes


@_unboxing(Handle)
def _address(kind: Any, held: Any, c: Any) -> Any:
    """Kernels that are given the object get its address."""
    number = c.pyapi.object_getattr_string(held, "address")
    address = c.pyapi.long_as_longlong(number)
    c.pyapi.decref(number)
    return NativeValue(address, is_error=c.pyapi.c_api_error())


def kind_of_handle(example: Any) -> Any:
    """The type of what is handed like this tuple."""
    return Handle(numba.typeof(example))


# Of what numbers are made in memory: yes and no are whole numbers.
_EXAMPLE: Any = Numbers._make(0.0 if kind is float else 0 for kind in get_type_hints(Numbers).values())
NUMBERS = kind_of_handle(_EXAMPLE)
numbers_at = reader(_EXAMPLE)


def handed_numbers(numbers: Numbers, named: Sequence[Numbers] = ()) -> Any:
    """The numbers of a run, ``Handed``: for kernels they are ``Numbers``, those of control cells.

    Behind these lie those of EMT cells, the same, and of the named types, so that ``Cells.kind`` says where.
    """
    kinds = (numbers, numbers, *named)
    return Handed(
        tuple(tuple(type(one)(value) for one, value in zip(_EXAMPLE, kind, strict=True)) for kind in kinds), NUMBERS
    )


@instruction
def numbers_of(typing: Any, numbers: Any, kind: Any) -> Any:
    """The numbers of the cells of a kind; given are those that ``handed_numbers`` hands to kernels."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        size = ir.Constant(ir.IntType(64), np.dtype(np.int64).itemsize * len(_EXAMPLE))
        return builder.add(values[0], builder.mul(values[1], size))

    return numbers(numbers, types.int64), generate


def generator_words(generator: Generator) -> Integers:
    """What ``generator_at`` reads, (GENERATOR,); the generator must outlive it."""
    bits: Any = generator.bit_generator
    functions = (
        ctypes.cast(getattr(bits.ctypes, name), ctypes.c_void_p).value for name in ("next_double", "next_uint64")
    )
    return np.array([bits.ctypes.state_address, *functions], dtype=np.int64)


@instruction
def generator_at(typing: Any, words: Any, k: Any) -> Any:
    """Generator k of an array (k, GENERATOR): a ``numpy.random.Generator`` for doubles and normal numbers."""
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
