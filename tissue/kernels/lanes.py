"""One number or eight at once: what a step is written in, that it may be compiled for one tissue and for eight.

An array (n,) holds a double for each cell, an array (n, 8) eight of them, which are one value of type Lanes: a register
of the processor, or several where it has shorter ones. ``load(a, i)`` takes entry i of either, +, -, * and / act on all
lanes, ``store(a, i, v)`` puts it back. What branches for one number is masked for eight: there is no ``if`` on lanes.

Each function here is one instruction, and the same for one number and for each of eight: so are the results, to the
last bit. Sums and products are as written, with ``fma`` where it is meant: a compiler that may choose does so for each
copy of a loop that it makes.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, cast

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global
from numba.extending import intrinsic, lower_builtin, lower_cast, models, register_model

WIDTH = 8

_DOUBLE, _SINGLE, _PLACE, _LONG = ir.DoubleType(), ir.FloatType(), ir.IntType(32), ir.IntType(64)
# Decorators whose types do not say what they take.
_globally: Any = infer_global
_lowered: Any = lower_builtin
_cast: Any = lower_cast


class LanesType(types.Type):
    """The type of eight doubles in one register."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


LANES = LanesType()


@register_model(LanesType)
class _Model(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, ir.VectorType(_DOUBLE, WIDTH))  # type: ignore[no-untyped-call]


def instruction(define: Callable[..., Any]) -> Callable[..., Any]:
    """An intrinsic of numba: a kernel calls it without the first argument of ``define``, the context of its types."""
    return cast("Callable[..., Any]", intrinsic(define))


def kind_of(*parts: Any) -> Any:
    """The type of the entries of an array, or of what is computed of these values: eight doubles, or one."""
    wide = any(part == LANES or (isinstance(part, types.Array) and part.ndim == 2) for part in parts)
    return LANES if wide else types.float64


def like(kind: Any, element: Any) -> Any:
    """One or eight of these in LLVM."""
    return ir.VectorType(element, WIDTH) if kind == LANES else element


def constant(value: ir.Type, number: float) -> ir.Constant:
    """The same number in all lanes of a type of LLVM."""
    return ir.Constant(value, [number] * WIDTH if isinstance(value, ir.VectorType) else number)


def in_all(builder: Any, number: Any) -> Any:
    """A number of LLVM in all of eight lanes."""
    undefined = ir.Constant(ir.VectorType(number.type, WIDTH), ir.Undefined)
    one = builder.insert_element(undefined, number, ir.Constant(_PLACE, 0))
    return builder.shuffle_vector(one, undefined, ir.Constant(ir.VectorType(_PLACE, WIDTH), [0] * WIDTH))


def entry(context: Any, builder: Any, kind: Any, array: Any, index: Any, element: Any) -> Any:
    """The address of entry ``index`` of an array."""
    data = context.make_array(kind)(context, builder, array).data
    if kind.ndim == 2:
        index = builder.mul(index, ir.Constant(_LONG, WIDTH))
    return builder.bitcast(builder.gep(data, [index]), like(kind_of(kind), element).as_pointer())


@_cast(types.Float, LANES)
def _widened(context: Any, builder: Any, kind: Any, wanted: Any, value: Any) -> Any:
    return in_all(builder, context.cast(builder, value, kind, types.float64))


def _operator(function: Callable[..., Any], operation: str) -> None:
    """Let an operator of Python work on lanes, and on lanes and numbers."""

    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            return LANES(LANES, LANES) if LANES in args else None

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return getattr(builder, operation)(*values)

    _globally(function)(Template)
    _lowered(function, LANES, LANES)(generate)


ARITHMETIC = {operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv"}
for _function, _operation in ARITHMETIC.items():
    _operator(_function, _operation)


@instruction
def load(typing: Any, a: Any, i: Any) -> Any:
    """Entry i of an array of doubles."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        loaded = builder.load(entry(context, builder, signature.args[0], values[0], values[1], _DOUBLE))
        loaded.align = 8
        return loaded

    return kind_of(a)(a, types.intp), generate


@instruction
def gather(typing: Any, a: Any, place: Any, k: Any) -> Any:
    """Entry ``place`` + k of a flat array, for a place or one of each lane; a place is a whole number >= 0."""
    kind = kind_of(place)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, values[0]).data
        if kind != LANES:
            return builder.load(builder.gep(data, [builder.add(builder.fptosi(values[1], _LONG), values[2])]))
        places = builder.fptosi(values[1], like(LANES, _LONG))
        found: Any = ir.Constant(like(LANES, _DOUBLE), ir.Undefined)
        for lane in (ir.Constant(_PLACE, number) for number in range(WIDTH)):
            one = builder.add(builder.extract_element(places, lane), values[2])
            found = builder.insert_element(found, builder.load(builder.gep(data, [one])), lane)
        return found

    return kind(a, kind, types.intp), generate


@instruction
def load_wide(typing: Any, a: Any, i: Any) -> Any:
    """Entry i of an array of doubles in eight lanes: eight numbers, or one in all of them."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        loaded = builder.load(entry(context, builder, signature.args[0], values[0], values[1], _DOUBLE))
        loaded.align = 8
        return loaded if kind_of(a) == LANES else in_all(builder, loaded)

    return LANES(a, types.intp), generate


@instruction
def store(typing: Any, a: Any, i: Any, v: Any) -> Any:
    """Entry i of an array of doubles becomes v."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        place = entry(context, builder, signature.args[0], values[0], values[1], _DOUBLE)
        builder.store(values[2], place).align = 8
        return context.get_dummy_value()

    return types.none(a, types.intp, kind_of(a)), generate


@instruction
def spread(typing: Any, a: Any, number: Any) -> Any:
    """The number as an entry of this array would be: alone, or in all lanes."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return in_all(builder, values[1]) if signature.return_type == LANES else values[1]

    return kind_of(a)(a, types.float64), generate


def _computed(parts: Any, compute: Callable[..., Any]) -> Any:
    """What an instruction on values is: all are lanes if one is, and so is the result."""
    kind = kind_of(*parts)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return compute(builder, *values)

    return kind(*[kind] * len(parts)), generate


def _is_positive(builder: Any, v: Any) -> Any:
    return builder.fcmp_ordered(">", v, constant(v.type, 0.0))


def _call(builder: Any, name: str, *parts: Any) -> Any:
    """An instruction of LLVM on parts of one type."""
    value = parts[0].type
    letter = "f64" if value in (_DOUBLE, like(LANES, _DOUBLE)) else "f32"
    suffix = f"v{WIDTH}{letter}" if isinstance(value, ir.VectorType) else letter
    kind = ir.FunctionType(value, [value] * len(parts))
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.{suffix}")
    return builder.call(function, parts)


@instruction
def where_positive(typing: Any, condition: Any, v: Any) -> Any:
    """v where ``condition`` > 0, else 0; a NaN of v stays where the condition holds."""
    return _computed((condition, v), lambda b, c, v: b.select(_is_positive(b, c), v, constant(v.type, 0.0)))


@instruction
def either(typing: Any, condition: Any, v: Any, otherwise: Any) -> Any:
    """v where ``condition`` > 0, else ``otherwise``, in each lane."""
    return _computed((condition, v, otherwise), lambda b, c, v, o: b.select(_is_positive(b, c), v, o))


@instruction
def maximum(typing: Any, a: Any, b: Any) -> Any:
    """The larger number in each lane; b where one is NaN."""
    return _computed((a, b), lambda builder, a, b: builder.select(builder.fcmp_ordered(">", a, b), a, b))


@instruction
def fma(typing: Any, a: Any, b: Any, c: Any) -> Any:
    """a b + c in one instruction, where the processor has one."""
    return _computed((a, b, c), lambda builder, a, b, c: _call(builder, "fmuladd", a, b, c))


@instruction
def floored(typing: Any, v: Any) -> Any:
    """The largest whole number <= v."""
    return _computed((v,), lambda builder, v: _call(builder, "floor", v))


@instruction
def root(typing: Any, v: Any) -> Any:
    """The square root, rounded correctly."""
    return _computed((v,), lambda builder, v: _call(builder, "sqrt", v))


@instruction
def twice_rsqrt(typing: Any, v: Any) -> Any:
    """2 / sqrt(v) to 2e-14: y (3 - v y^2) for y in single precision, one Newton step.

    v must lie between 1e-37 and 1e37. Twice, because this has one instruction less than once, and users have a factor
    to put it into.
    """

    def compute(builder: Any, v: Any) -> Any:
        single = like(kind, _SINGLE)
        low = _call(builder, "sqrt", builder.fptrunc(v, single))
        rough = builder.fpext(builder.fdiv(constant(single, 1.0), low), v.type)
        back = builder.fneg(builder.fmul(v, rough))
        return builder.fmul(rough, _call(builder, "fmuladd", back, rough, constant(v.type, 3.0)))

    kind = kind_of(v)
    return _computed((v,), compute)


@instruction
def positive_bits(typing: Any, v: Any) -> Any:
    """An integer with bit k set where v > 0 in lane k."""
    kind = kind_of(v)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        positive = _is_positive(builder, values[0])
        return builder.zext(builder.bitcast(positive, ir.IntType(WIDTH)) if kind == LANES else positive, _LONG)

    return types.int64(kind), generate


@instruction
def lowest_bit(typing: Any, bits: Any) -> Any:
    """The place of the lowest bit that is set; there must be one."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.cttz(values[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), generate
