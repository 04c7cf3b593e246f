"""A function that numba compiles, (t, x) -> (N, d), as a C function."""

from typing import Any

import numba
from numba import types
from numba.core.errors import NumbaError
from numba.extending import intrinsic

from dincl.kernels.drifts import DRIFT

_READ_ONLY = types.Array(types.float64, 2, "C", readonly=True)
_instruction: Any = intrinsic  # whose types do not say that the first argument is not the caller's


@_instruction
def _view(typing: Any, pointer: Any, n: Any, d: Any) -> Any:
    """A read-only array (n, d) of the numbers at an address, without a copy."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        from numba.np.arrayobj import populate_array

        array = context.make_array(_READ_ONLY)(context, builder)
        size = context.get_constant(types.intp, 8)
        populate_array(
            array,
            data=values[0],
            shape=values[1:],
            strides=[builder.mul(values[2], size), size],
            itemsize=size,
            meminfo=None,
        )
        return array._getvalue()

    return _READ_ONLY(pointer, types.int64, types.int64), generate


def as_c_function(drift: Any) -> Any:
    """The dispatcher as a C function, see ``call_drift``; None if it does not compile to an array of two axes."""
    try:
        drift.compile((types.float64, _READ_ONLY))
        returned = drift.overloads[types.float64, _READ_ONLY].signature.return_type
        kinds = (types.Float, types.Integer)
        if not (isinstance(returned, types.Array) and returned.ndim == 2 and isinstance(returned.dtype, kinds)):
            return None
        call = _wrapped(drift)
        compiled = numba.cfunc(DRIFT)(call)
    except (NumbaError, RuntimeError):  # the latter if its types are declared, and others
        return None
    call.__closure__[0].cell_contents = None  # the machine code needs it no longer, and it may be forgotten
    return compiled


def _wrapped(drift: Any) -> Any:
    def call(t, x, out, n, d, data):  # type: ignore[no-untyped-def]
        try:  # what nobody catches here is printed
            value = drift(t, _view(x, n, d))
        except Exception:  # noqa: BLE001  # of any kind: it is raised again outside
            return 1
        if value.shape != (n, d):
            return 1
        for i in range(n):
            for k in range(d):
                out[i * d + k] = value[i, k]
        return 0

    return call
