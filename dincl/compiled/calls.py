"""Calls of C functions by address: one compiled kernel serves every drift, every rule and every force."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

# The type of an argument that is the address of doubles: kernels pass a C-contiguous array of them, of any shape.
DOUBLES: Any = types.CPointer(types.float64)
_PLAIN: dict[Any, Any] = {int: types.int64, float: types.float64, None: types.void}
_instruction: Any = intrinsic  # whose types do not say that the first argument is not the caller's


def signature(returned: Any, *arguments: Any) -> Any:
    """Describe a C function by the types of its result and arguments.

    Each is int, float, DOUBLES or the type of a struct (``struct_type``); the result may be None, too.
    """
    return _plain(returned)(*map(_plain, arguments))


def _plain(kind: Any) -> Any:
    return types.Tuple([*map(_plain, kind)]) if isinstance(kind, tuple) else _PLAIN.get(kind, kind)


def call(described: Any) -> Callable[..., Any]:
    """Make the function ``f(address, *arguments)`` with which kernels call any C function of this signature."""
    expected = described.args
    silent = described.return_type == types.void

    def define(typing: Any, address: Any, *given: Any) -> Any:
        passed = isinstance(address, types.Integer) and all(map(_fits, expected, given))
        return (described.return_type(types.int64, *map(_as_passed, expected, given)), generate) if passed else None

    def generate(context: Any, builder: Any, known: Any, values: Any) -> Any:
        kinds = [context.get_value_type(kind) for kind in expected]
        result = ir.VoidType() if silent else context.get_value_type(described.return_type)
        function = builder.inttoptr(values[0], ir.FunctionType(result, kinds).as_pointer())
        plain = [
            context.make_array(kind)(context, builder, value).data if isinstance(kind, types.Array) else value
            for kind, value in zip(known.args[1:], values[1:], strict=True)
        ]
        returned = builder.call(function, plain)
        return context.get_dummy_value() if silent else returned

    # Numba reads the number of arguments from the signature of ``define``.
    names = ("typing", "address", *(f"argument_{k}" for k in range(len(expected))))
    define.__signature__ = Signature([Parameter(name, Parameter.POSITIONAL_OR_KEYWORD) for name in names])  # type: ignore[attr-defined]
    made: Callable[..., Any] = _instruction(define)
    return made


def _fits(expected: Any, given: Any) -> bool:
    """Say whether a value of this type can be passed; a float is not cut to an integer."""
    if expected == DOUBLES:
        return isinstance(given, types.Array) and given.dtype == types.float64 and given.layout == "C"
    if isinstance(expected, types.Float):
        return isinstance(given, types.Float)
    if isinstance(expected, types.Integer):
        return isinstance(given, types.Integer | types.Boolean)
    return bool(expected == given)


def _as_passed(expected: Any, given: Any) -> Any:
    """Return the type that numba converts a value to: an array stays one until its address is taken."""
    return given if expected == DOUBLES else expected
