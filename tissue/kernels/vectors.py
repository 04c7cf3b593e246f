"""Lanes, several doubles in one register as one value of kernels: their type, arithmetic and form in LLVM.

Eight tissues side by side in lanes take 2.2 to 2.3 times less than one after the other; a step in space takes 1.4 times
less with the coordinates of a point in four lanes. LLVM finds neither by itself.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global
from numba.extending import lower_builtin, lower_cast, models, register_model

# Number of runs side by side, the length of a row of an array (n, WIDTH).
WIDTH = 8
DOUBLE, SINGLE, SHORT, LONG = ir.DoubleType(), ir.FloatType(), ir.IntType(32), ir.IntType(64)
# Decorators whose types do not say what they take.
_globally: Any = infer_global
_lowered: Any = lower_builtin
_cast: Any = lower_cast


class LanesType(types.Type):
    """The type of so many doubles in one register, or in several where the processor has shorter ones."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"Lanes({width})")


LANES = LanesType(WIDTH)


@register_model(LanesType)
class _Model(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, ir.VectorType(DOUBLE, fe_type.width))  # type: ignore[no-untyped-call]


def kind_of(*parts: Any) -> Any:
    """Find the type of entries of arrays, or of values computed from them: lanes if one of them is, else a double."""
    wide = (part for part in parts if isinstance(part, LanesType))
    rows = any(isinstance(part, types.Array) and part.ndim == 2 for part in parts)
    return next(wide, LANES if rows else types.float64)


def like(kind: Any, element: Any) -> Any:
    """Return the type in LLVM of one of these elements, or of as many as there are lanes."""
    return ir.VectorType(element, kind.width) if isinstance(kind, LanesType) else element


def constant(value: ir.Type, number: float) -> ir.Constant:
    """Make a constant of LLVM with the same number in all lanes."""
    return ir.Constant(value, [number] * value.count if isinstance(value, ir.VectorType) else number)


def broadcast(builder: Any, number: Any, width: int = WIDTH) -> Any:
    """Put a number of LLVM into all lanes."""
    undefined = ir.Constant(ir.VectorType(number.type, width), ir.Undefined)
    one = builder.insert_element(undefined, number, ir.Constant(SHORT, 0))
    return builder.shuffle_vector(one, undefined, ir.Constant(ir.VectorType(SHORT, width), [0] * width))


def address_of(context: Any, builder: Any, kind: Any, element: Any, array: Any, index: Any) -> Any:
    """Compute the address of entry ``index`` of an array."""
    data = context.make_array(kind)(context, builder, array).data
    if kind.ndim == 2:
        index = builder.mul(index, ir.Constant(LONG, WIDTH))
    return builder.bitcast(builder.gep(data, [index]), like(kind_of(kind), element).as_pointer())


def load_at(builder: Any, place: Any) -> Any:
    """Load from an address, which is a multiple of 8 bytes and no more."""
    loaded = builder.load(place)
    loaded.align = 8
    return loaded


def call_llvm(builder: Any, name: str, *parts: Any) -> Any:
    """Call an intrinsic function of LLVM on values of one type."""
    value = parts[0].type
    element = value.element if isinstance(value, ir.VectorType) else value
    letter = "f64" if element == DOUBLE else "f32"
    suffix = f"v{value.count}{letter}" if isinstance(value, ir.VectorType) else letter
    kind = ir.FunctionType(value, [value] * len(parts))
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.{suffix}")
    return builder.call(function, parts)


@_cast(types.Float, LanesType)
def _widen(context: Any, builder: Any, kind: Any, target: Any, value: Any) -> Any:
    return broadcast(builder, context.cast(builder, value, kind, types.float64), target.width)


def _operator(function: Callable[..., Any], operation: str, operands: int) -> None:
    """Let an operator of Python work on lanes, and on lanes and numbers."""

    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            lanes = [kind for kind in args if isinstance(kind, LanesType)]
            return lanes[0](*[lanes[0]] * len(args)) if lanes else None

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return getattr(builder, operation)(*values)

    _globally(function)(Template)
    _lowered(function, *[LanesType] * operands)(generate)


_BINARY: Any = {operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv"}
for _function, _operation in _BINARY.items():
    _operator(_function, _operation, 2)
_operator(operator.neg, "fneg", 1)
