"""Functions that users compile with numba themselves."""

from __future__ import annotations

from typing import Any

import numba
from llvmlite.binding import get_host_cpu_name
from numba import types
from numba.core.errors import NumbaError
from numba.extending import intrinsic, is_jitted

from dincl.compiled.calls import DOUBLES, signature

# int64 f(double t, double *x, double *out, int64 n, int64 d, double *data): out = F(t, x); 0 is success.
DRIFT: Any = signature(int, float, DOUBLES, DOUBLES, int, int, DOUBLES)
_READ_ONLY = types.Array(types.float64, 2, "C", readonly=True)
_instruction: Any = intrinsic  # whose types do not say that the first argument is not the caller's
carray: Any = numba.carray  # type: ignore[attr-defined]


def is_dispatcher(function: Any) -> bool:
    """Say whether this is a function that numba compiles."""
    return bool(is_jitted(function))


def drift_of(function: Any) -> Any:
    """Compile a user's function (t, x) -> (n, d) as a C function DRIFT; None if it returns no array of two axes."""
    try:
        function.compile((types.float64, _READ_ONLY))
        returned = function.overloads[types.float64, _READ_ONLY].signature.return_type
        kinds = (types.Float, types.Integer)
        if not (isinstance(returned, types.Array) and returned.ndim == 2 and isinstance(returned.dtype, kinds)):
            return None
        call = _wrapped(function)
        compiled = numba.cfunc(DRIFT)(call)
    except (NumbaError, RuntimeError):  # the latter if its types are declared, and others
        return None
    call.__closure__[0].cell_contents = None  # the machine code needs it no longer, and it may be forgotten
    return compiled


@_instruction
def _read_only(typing: Any, array: Any) -> Any:
    """Return the same array for functions that must not write to it."""
    return _READ_ONLY(array), lambda context, builder, signature, values: values[0]


def _wrapped(function: Any) -> Any:
    def call(t, x, out, n, d, data):  # type: ignore[no-untyped-def]
        try:  # what nobody catches here is printed
            value = function(t, _read_only(carray(x, (n, d))))
        except Exception:  # noqa: BLE001  # of any kind: it is raised again outside
            return 1
        if value.shape != (n, d):
            return 1
        for i in range(n):
            for k in range(d):
                out[i * d + k] = value[i, k]
        return 0

    return call


def processor_name() -> str:
    """Return the name of this processor, for whose instructions machine code is made."""
    name: str = get_host_cpu_name()
    return name
