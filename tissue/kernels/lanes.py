"""Eight numbers at once: vector instructions, written out.

A loop over whole arrays is turned into vector instructions by the compiler only where it can prove that they do not
overlap, which it cannot for a dozen arrays. Here the programmer says it: ``load(a, i)`` takes a[i : i + 8] as one value
of type Lanes, +, -, * act on all eight, and ``store(a, i, v)`` puts them back. On processors with shorter registers the
compiler uses several.

``fma`` rounds once, and ``twice_rsqrt`` is accurate to 2e-13, so that results agree with plain NumPy to rounding only.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, models, overload, register_model

WIDTH = 8
# For the estimate of a root alone. Sums and products are as written, with ``fma`` where it is meant: a compiler that
# may choose does so for each copy of a loop it makes, and the last bits of a cell would depend on its place.
ESTIMATE = ("arcp", "afn", "contract", "nsz")

_DOUBLE = ir.DoubleType()
_VECTOR = ir.VectorType(_DOUBLE, WIDTH)
_SINGLES = ir.VectorType(ir.FloatType(), WIDTH)
_PLACES = ir.VectorType(ir.IntType(32), WIDTH)
_LONGS = ir.VectorType(ir.IntType(64), WIDTH)


class LanesType(types.Type):
    """The type of eight doubles in one register."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


LANES = LanesType()


@register_model(LanesType)
class _Model(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, _VECTOR)  # type: ignore[no-untyped-call]


def _constant(value: float) -> ir.Constant:
    return ir.Constant(_VECTOR, [value] * WIDTH)


def _spread(context: Any, builder: Any, value: Any, kind: Any) -> Any:
    """A number in all lanes; lanes as they are."""
    if kind == LANES:
        return value
    number = context.cast(builder, value, kind, types.float64)
    undefined = ir.Constant(_VECTOR, ir.Undefined)
    one = builder.insert_element(undefined, number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, undefined, ir.Constant(_PLACES, [0] * WIDTH))


def _place(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    """The address of a[i] as that of eight doubles."""
    array = context.make_array(signature.args[0])(context, builder, values[0])
    index = context.cast(builder, values[1], signature.args[1], types.intp)
    return builder.bitcast(builder.gep(array.data, [index]), _VECTOR.as_pointer())


def instruction(define: Callable[..., Any]) -> Callable[..., Any]:
    """An intrinsic of numba: a kernel calls it without the first argument of ``define``, the context of its types."""
    return cast("Callable[..., Any]", intrinsic(define))


@instruction
def load(typing: Any, a: Any, i: Any) -> Any:
    """a[i : i + 8]; the array must be that long."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        loaded = builder.load(_place(context, builder, signature, values))
        loaded.align = 8  # a window begins anywhere
        return loaded

    return LANES(a, i), generate


@instruction
def store(typing: Any, a: Any, i: Any, v: Any) -> Any:
    """a[i : i + 8] = v."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        builder.store(values[2], _place(context, builder, signature, values)).align = 8
        return context.get_dummy_value()

    return types.none(a, i, v), generate


def load_words(context: Any, builder: Any, kind: Any, array: Any, index: Any) -> Any:
    """a[i : i + 8] of whole numbers, the last 32 bits of each, for an intrinsic."""
    data = builder.gep(context.make_array(kind)(context, builder, array).data, [index])
    loaded = builder.load(builder.bitcast(data, _LONGS.as_pointer()))
    loaded.align = 8
    return builder.trunc(loaded, _PLACES)


@instruction
def spread(typing: Any, number: Any) -> Any:
    """The same number in all lanes."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _spread(context, builder, values[0], signature.args[0])

    return LANES(number), generate


def _define(function: Callable[..., Any], operation: str) -> None:
    """Let an operator of Python work on lanes, and on lanes and numbers."""

    @instruction
    def apply(typing: Any, a: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            left, right = (_spread(context, builder, *pair) for pair in zip(values, signature.args, strict=True))
            return getattr(builder, operation)(left, right)

        return LANES(a, b), generate

    def operate(a: Any, b: Any) -> Any:
        return apply(a, b)

    @overload(function)
    def choose(a: Any, b: Any) -> Any:
        return operate if LANES in (a, b) else None


ARITHMETIC = {operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv"}
for _function, _operation in ARITHMETIC.items():
    _define(_function, _operation)


@instruction
def where_positive(typing: Any, condition: Any, v: Any) -> Any:
    """v where ``condition`` > 0, else 0; a NaN of v stays where the condition holds."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        positive = builder.fcmp_ordered(">", values[0], _constant(0.0))
        return builder.select(positive, values[1], _constant(0.0))

    return LANES(condition, v), generate


@instruction
def either(typing: Any, condition: Any, v: Any, otherwise: Any) -> Any:
    """v where ``condition`` > 0, else ``otherwise``, in each lane."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", values[0], _constant(0.0)), *values[1:])

    return LANES(condition, v, otherwise), generate


@instruction
def fma(typing: Any, a: Any, b: Any, c: Any) -> Any:
    """a b + c in one instruction, where the processor has one."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind = ir.FunctionType(_VECTOR, [_VECTOR] * 3)
        parts = [_spread(context, builder, *pair) for pair in zip(values, signature.args, strict=True)]
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"llvm.fmuladd.v{WIDTH}f64"), parts)

    return LANES(a, b, c), generate


@instruction
def maximum(typing: Any, a: Any, b: Any) -> Any:
    """The larger number in each lane; b where one is NaN."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", *values), *values)

    return LANES(a, b), generate


@instruction
def twice_rsqrt(typing: Any, v: Any) -> Any:
    """2 / sqrt(v) to 2e-13: y (3 - v y^2) for a quick estimate y in single precision, one Newton step.

    v must lie between 1e-37 and 1e37. Twice, because this has one instruction less than once, and users have a factor
    to put it into.
    """

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind = ir.FunctionType(_SINGLES, [_SINGLES])
        root = cgutils.get_or_insert_function(builder.module, kind, f"llvm.sqrt.v{WIDTH}f32")
        single = builder.call(root, [builder.fptrunc(values[0], _SINGLES)], fastmath=ESTIMATE)
        rough = builder.fpext(builder.fdiv(ir.Constant(_SINGLES, [1.0] * WIDTH), single, flags=ESTIMATE), _VECTOR)
        square = builder.fmul(builder.fmul(values[0], rough, flags=("contract",)), rough, flags=("contract",))
        change = builder.fsub(_constant(3.0), square, flags=("contract",))
        return builder.fmul(rough, change, flags=("contract",))

    return LANES(v), generate


@instruction
def binary_parts(typing: Any, v: Any) -> Any:
    """m and e of v = m 2^e, 1 <= m < 2; v must be positive and normal."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        bits = builder.bitcast(values[0], _LONGS)
        shift, mask, one = (ir.Constant(_LONGS, [part] * WIDTH) for part in (52, (1 << 52) - 1, 1023 << 52))
        mantissa = builder.bitcast(builder.or_(builder.and_(bits, mask), one), _VECTOR)
        exponent = builder.fsub(builder.sitofp(builder.lshr(bits, shift), _VECTOR), _constant(1023.0))
        return context.make_tuple(builder, signature.return_type, [mantissa, exponent])

    return types.UniTuple(LANES, 2)(v), generate


@instruction
def positive_bits(typing: Any, v: Any) -> Any:
    """An integer with bit k set where v > 0 in lane k."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        positive = builder.fcmp_ordered(">", values[0], _constant(0.0))
        return builder.zext(builder.bitcast(positive, ir.IntType(WIDTH)), ir.IntType(64))

    return types.int64(v), generate


@instruction
def lowest_bit(typing: Any, bits: Any) -> Any:
    """The place of the lowest bit that is set; there must be one."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.cttz(values[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), generate
