"""Tuples of arrays that are handed on by their address.

A tuple of sixty arrays has four hundred numbers. Passed by value they cost a minute of compiling.
"""

import ctypes
import struct
from collections.abc import Callable, Mapping
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic, models, register_model

from dincl.kernels.arrays import Offsets

# Decorators whose types do not say what they take.
_instruction: Any = intrinsic
_lowering: Any = lower_getattr_generic
_NOTHING: Any = ctypes.c_char * 0


class Handle(types.Type):
    """The address of a tuple of this kind; its fields are read when they are asked for."""

    def __init__(self, kind: Any) -> None:
        self.kind = kind
        super().__init__(name=f"Handle({kind})")


@register_model(Handle)
class _HandleModel(models.PrimitiveModel):
    def __init__(self, manager: Any, handle: Any) -> None:
        super().__init__(manager, handle, ir.IntType(64))  # type: ignore[no-untyped-call]


@infer_getattr
class _Fields(AttributeTemplate):
    key = Handle

    def generic_resolve(self, handle: Any, name: str) -> Any:  # type: ignore[override]
        if name not in handle.kind.fields:
            return None
        field = handle.kind[handle.kind.fields.index(name)]
        return Handle(field) if isinstance(field, types.BaseNamedTuple) else field


@_lowering(Handle)
def _read(context: Any, builder: Any, handle: Any, value: Any, name: str) -> Any:
    place = builder.inttoptr(value, context.get_value_type(handle.kind).as_pointer())
    index = handle.kind.fields.index(name)
    field = cgutils.gep_inbounds(builder, place, 0, index)
    if isinstance(handle.kind[index], types.BaseNamedTuple):
        return builder.ptrtoint(field, ir.IntType(64))
    return builder.load(field)


def reader(example: Any) -> Callable[[int], Any]:
    """The function that makes a handle of the address of words that ``written`` made of a tuple like this one."""
    kind = Handle(numba.typeof(example))

    @_instruction
    def read(typing: Any, address: Any) -> Any:
        return kind(types.int64), lambda context, builder, signature, values: values[0]

    found: Callable[[int], Any] = read
    return found


def written(parts: Any) -> Offsets:
    """The words of a tuple of arrays, tuples and numbers, as numba has them in memory; the arrays must outlive them."""
    words: list[int] = []
    _write(parts, words)
    return np.array(words, dtype=np.int64)


def _write(parts: Any, words: list[int]) -> None:
    for part in parts:
        if isinstance(part, np.ndarray):
            # Three times as fast as ``part.ctypes.data``, and refused if it is read-only or has gaps.
            place = ctypes.addressof(_NOTHING.from_buffer(part))
            words += (0, 0, part.size, part.itemsize, place, *part.shape, *part.strides)
        elif isinstance(part, tuple):
            _write(part, words)
        elif isinstance(part, float):
            words += struct.unpack("q", struct.pack("d", part))
        else:
            words.append(part)


class StructPointer:
    """A named tuple of arrays, named tuples and numbers in memory; kernels are given its address.

    Attributes
    ----------
    value
        The named tuple, whose arrays kernels change in place.
    address
        Where it is in memory, as long as this object lives.
    """

    def __init__(self, value: Any) -> None:
        self.value = value
        self._words = written(value)
        self.address = int(self._words.ctypes.data)

    def replace(self, arrays: Mapping[str, Any]) -> None:
        """Put other arrays of the same types in place of some: ``replace({"pairs.partner": longer})``."""
        for path, array in arrays.items():
            self.value = _replaced(self.value, path.split("."), array)
        self._words[:] = written(self.value)


def _replaced(value: Any, names: list[str], array: Any) -> Any:
    name, *rest = names
    return value._replace(**{name: _replaced(getattr(value, name), rest, array) if rest else array})
