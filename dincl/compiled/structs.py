"""Structs by address: named tuples of arrays and numbers in memory, of which kernels read the fields that they need.

A tuple of sixty arrays is four hundred numbers. Thirty functions that pass it on by value take 3.3 times as long to
compile as with one address, and a call from Python takes 3 times as long.
"""

from __future__ import annotations

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
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)
from numba.np.arrayobj import populate_array
from numpy.typing import NDArray

from dincl.compiled.calls import instruction

# Decorators whose types do not say what they take.
_lowering: Any = lower_getattr_generic
_unboxing: Any = unbox
_typing: Any = typeof_impl
_NOTHING: Any = ctypes.c_char * 0


class StructType(types.Type):
    """The type of the address of a named tuple; a field is read on access."""

    def __init__(self, kind: Any) -> None:
        self.kind = kind
        super().__init__(name=f"Struct({kind})")


@register_model(StructType)
class _StructModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.IntType(64))  # type: ignore[no-untyped-call]


@infer_getattr
class _Fields(AttributeTemplate):
    key = StructType

    def generic_resolve(self, struct: Any, name: str) -> Any:  # type: ignore[override]
        if name in struct.kind.fields:
            field = struct.kind[struct.kind.fields.index(name)]
            return StructType(field) if isinstance(field, types.BaseNamedTuple) else field
        if name not in (known := entries_of(struct.kind)):
            return None
        part, k = known[name]
        inside: Any = struct.kind[struct.kind.fields.index(part)]
        if not isinstance(inside, types.Array):
            return inside[k]
        return inside.dtype if inside.ndim == 1 else _row_of(inside)


def entries_of(kind: Any) -> dict[str, tuple[str, int]]:
    """Return the names for parts of fields, field and place, that the class of a named tuple gives by ``entries``.

    They stand for a number of a named tuple or of an array (n,), or for a row of an array (m, n), and may grow: kernels
    that do not read them stay as they are.
    """
    find = getattr(kind.instance_class, "entries", None)
    return find() if find else {}


def names_in(struct: Any) -> list[Any]:
    """Return all such names in a struct, on which the machine code of what reads them depends."""
    if not isinstance(struct, StructType):
        return []
    inside = [StructType(field) for field in struct.kind if isinstance(field, types.BaseNamedTuple)]
    return [*entries_of(struct.kind).items(), *(name for part in inside for name in names_in(part))]


def _row_of(array: Any) -> Any:
    return types.Array(array.dtype, 1, "C")


@_lowering(StructType)
def _read(context: Any, builder: Any, struct: Any, value: Any, name: str) -> Any:
    place, kind = builder.inttoptr(value, context.get_value_type(struct.kind).as_pointer()), struct.kind
    part = None if name in kind.fields else entries_of(kind)[name]
    index = kind.fields.index(part[0] if part else name)
    field = cgutils.gep_inbounds(builder, place, 0, index)
    if part and isinstance(kind[index], types.BaseNamedTuple):
        return builder.load(cgutils.gep_inbounds(builder, field, 0, part[1]))
    if isinstance(kind[index], types.BaseNamedTuple):
        return builder.ptrtoint(field, ir.IntType(64))
    if part is None:
        return builder.load(field)
    array, k = context.make_array(kind[index])(context, builder, builder.load(field)), ir.IntType(64)(part[1])
    if kind[index].ndim == 1:
        return builder.load(builder.gep(array.data, [k]))
    (_, n), (_, stride) = (cgutils.unpack_tuple(builder, sizes, 2) for sizes in (array.shape, array.strides))
    row = context.make_array(_row_of(kind[index]))(context, builder)
    start = builder.gep(array.data, [builder.mul(k, n)])
    populate_array(row, data=start, shape=[n], strides=[stride], itemsize=array.itemsize, meminfo=None)
    return row._getvalue()


def struct_type(example: Any) -> StructType:
    """Find the type of structs like this named tuple; raises TypeError for numbers that do not take eight bytes."""
    kind = numba.typeof(example)
    _require_words(kind)
    return StructType(kind)


def _require_words(kind: Any) -> None:
    for name, field in zip(kind.fields, kind, strict=True):
        if isinstance(field, types.BaseNamedTuple):
            _require_words(field)
        elif not (isinstance(field, types.Array) or field in (types.int64, types.float64)):
            raise TypeError(f"{name} is {field}: a struct has arrays, named tuples, int and float")


def reader(example: Any) -> Callable[[int], Any]:
    """Make the function with which kernels get the struct at an address, of the type of this named tuple."""
    kind = struct_type(example)

    @instruction
    def read(typing: Any, address: Any) -> Any:
        return kind(types.int64), lambda context, builder, signature, values: values[0]

    return read


@instruction
def struct_after(typing: Any, first: Any, k: Any) -> Any:
    """Return struct k of several of one type that follow one another in memory, of which ``first`` is the first."""
    if not isinstance(first, StructType):
        return None

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        size = ir.Constant(ir.IntType(64), context.get_abi_sizeof(context.get_value_type(first.kind)))
        return builder.add(values[0], builder.mul(values[1], size))

    return first(first, types.int64), generate


class StructPointer:
    """A named tuple of arrays, named tuples and numbers in memory; kernels are given its address.

    Attributes
    ----------
    value
        The named tuple, whose arrays kernels change in place; or several of one type, of which kernels get the first.
    address
        Its address, as long as this object lives.
    """

    def __init__(self, value: Any, kind: StructType | None = None) -> None:
        self.value = value
        self._kind = kind
        self._words = to_words(value)
        self.address: int = self._words.ctypes.data

    @property
    def kind(self) -> StructType:
        """The type for kernels whose argument is this object; found on use, since that takes 0.6 ms."""
        if self._kind is None:
            self._kind = struct_type(self.value)
        return self._kind

    def replace(self, parts: Mapping[str, Any]) -> None:
        """Put arrays or named tuples of the same types in place of others: ``replace({"pairs.partner": longer})``."""
        for path, part in parts.items():
            self.value = _replaced(self.value, path.split("."), part)
        self._words[:] = to_words(self.value)


def _replaced(value: Any, names: list[str], part: Any) -> Any:
    """Return the named tuple with another part at the end of the path."""
    name, *rest = names
    old = getattr(value, name)
    if rest:
        return value._replace(**{name: _replaced(old, rest, part)})
    if not _alike(old, part):
        raise TypeError(f"{name} is {numba.typeof(old)}: it cannot become {numba.typeof(part)}")
    return value._replace(**{name: part})


def _alike(old: Any, new: Any) -> bool:
    """Return whether two parts are of one type; ``numba.typeof`` would take 40 times as long."""
    if isinstance(old, np.ndarray):
        return isinstance(new, np.ndarray) and (old.dtype, old.ndim) == (new.dtype, new.ndim)
    return type(old) is type(new) and (not isinstance(old, tuple) or all(map(_alike, old, new)))


@_typing.register(StructPointer)
def _type_of(pointer: StructPointer, _: Any) -> StructType:
    return pointer.kind


@_unboxing(StructType)
def _address(kind: Any, pointer: Any, c: Any) -> Any:
    """Pass the address to kernels whose argument is the object."""
    number = c.pyapi.object_getattr_string(pointer, "address")
    address = c.pyapi.long_as_longlong(number)
    c.pyapi.decref(number)
    return NativeValue(address, is_error=c.pyapi.c_api_error())


def to_words(value: Any) -> NDArray[np.int64]:
    """Make the words by which numba represents a tuple of arrays, tuples and numbers; the arrays must outlive them."""
    words: list[int] = []
    _write(value, words)
    return np.array(words, dtype=np.int64)


def _write(value: Any, words: list[int]) -> None:
    """Add the words of each part; an array is its owner and parent, size, item size, address, shape and strides."""
    for part in value:
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
