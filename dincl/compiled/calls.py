"""C functions by address: how kernels call them, and drifts that users compile."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Any, cast

import numba
from llvmlite import ir
from numba import types
from numba.core.errors import NumbaError
from numba.extending import intrinsic, is_jitted
from numba.np.arrayobj import populate_array

# The type of an argument that is the address of doubles: kernels pass a C-contiguous array of them, of any shape.
DOUBLES: Any = types.CPointer(types.float64)
_PLAIN: dict[Any, Any] = {int: types.int64, float: types.float64, None: types.void}
# Kernels call an intrinsic without ``typing``, the first argument of its definition; numba's own types do not say so.
instruction: Callable[[Callable[..., Any]], Callable[..., Any]] = cast("Any", intrinsic)
_carray: Any = numba.carray  # type: ignore[attr-defined]


def signature(returned: Any, *arguments: Any) -> Any:
    """Describe a C function by the types of its result and arguments.

    Each is int, float, DOUBLES or the type of a struct (``struct_type``); the result may be None, too.
    """
    return _plain(returned)(*map(_plain, arguments))


def _plain(kind: Any) -> Any:
    return types.Tuple([*map(_plain, kind)]) if isinstance(kind, tuple) else _PLAIN.get(kind, kind)


# int64 f(double t, double *x, double *out, int64 n, int64 d, double *data): out = F(t, x); 0 is success.
DRIFT: Any = signature(int, float, DOUBLES, DOUBLES, int, int, DOUBLES)
# int64 f(double t, double *x, int64 request): Python writes what is requested of the sets at (t, x).
SETS: Any = signature(int, float, DOUBLES, int)

_C_TYPES: Any = {types.int64: ctypes.c_int64, types.float64: ctypes.c_double, DOUBLES: ctypes.c_void_p}


def c_type(described: Any) -> Any:
    """Return the type of C functions of this signature, which makes one of a Python function; arrays are addresses."""
    return ctypes.CFUNCTYPE(_C_TYPES[described.return_type], *(_C_TYPES[kind] for kind in described.args))


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
    return instruction(define)


def _fits(expected: Any, given: Any) -> bool:
    """Return whether a value of this type can be passed; a float is not cut to an integer."""
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


_READ_ONLY = types.Array(types.float64, 2, "C", readonly=True)


def is_dispatcher(function: Any) -> bool:
    """Return whether a user made this function with ``numba.njit``."""
    return bool(is_jitted(function))


def compile_drift(function: Any) -> Any:
    """Compile a user's function (t, x) -> (n, d) as a C function DRIFT; None if it returns no array of two axes."""

    def drift(t, x, out, n, d, data):  # type: ignore[no-untyped-def]
        try:  # numba prints an error that is not caught here
            value = function(t, _as_read_only(_carray(x, (n, d))))
        except Exception:  # noqa: BLE001  # of any kind: Python calls the function again, which raises it
            return 1
        if value.shape != (n, d):
            return 1
        for i in range(n):
            for k in range(d):
                out[i * d + k] = value[i, k]
        return 0

    try:
        function.compile((types.float64, _READ_ONLY))
        returned = function.overloads[types.float64, _READ_ONLY].signature.return_type
        kinds = (types.Float, types.Integer)
        if not (isinstance(returned, types.Array) and returned.ndim == 2 and isinstance(returned.dtype, kinds)):
            return None
        compiled = numba.cfunc(DRIFT)(drift)
    except (NumbaError, RuntimeError):  # RuntimeError if the types of the function are declared
        return None
    function = None  # which the machine code does not need; the user may forget it
    return compiled


@instruction
def floats_at(typing: Any, place: Any, size: Any) -> Any:
    """Return the numbers at an address as an array of this length; numba's own needs references to be counted."""
    kind = types.Array(types.float64, 1, "C")

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        array, step = context.make_array(kind)(context, builder), ir.Constant(ir.IntType(64), 8)
        populate_array(array, values[0], [values[1]], [step], step, None)
        return array._getvalue()

    return kind(DOUBLES, types.int64), generate


@instruction
def _as_read_only(typing: Any, array: Any) -> Any:
    """Return the same array for functions that must not write to it."""
    return _READ_ONLY(array), lambda context, builder, signature, values: values[0]
