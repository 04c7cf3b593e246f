"""Points in space as four doubles that follow one another, x, y, z and nothing: one load, one store.

A sum over pairs that are scattered in memory takes three loads for each point if x, y and z are in three arrays. What
is here works on four doubles as ``tissue.kernels.lanes`` does on eight, with the same bits as on one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global
from numba.extending import lower_builtin, lower_cast, models, register_model

from tissue.kernels.lanes import ARITHMETIC, instruction

QUAD_WIDTH = 4
_DOUBLE, _PLACE, _LONG = ir.DoubleType(), ir.IntType(32), ir.IntType(64)
_FOUR, _SINGLES = ir.VectorType(_DOUBLE, QUAD_WIDTH), ir.VectorType(ir.FloatType(), QUAD_WIDTH)
# Decorators whose types do not say what they take.
_globally: Any = infer_global
_lowered: Any = lower_builtin
_cast: Any = lower_cast


class QuadType(types.Type):
    """The type of four doubles in one register."""

    def __init__(self) -> None:
        super().__init__(name="Quad")


QUAD = QuadType()


@register_model(QuadType)
class _Model(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, _FOUR)  # type: ignore[no-untyped-call]


@_cast(types.Float, QUAD)
def _widened(context: Any, builder: Any, kind: Any, wanted: Any, value: Any) -> Any:
    return _in_all(builder, context.cast(builder, value, kind, types.float64))


def _operator(function: Callable[..., Any], operation: str) -> None:
    """Let an operator of Python work on quads, and on quads and numbers."""

    class Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            return QUAD(QUAD, QUAD) if QUAD in args else None

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return getattr(builder, operation)(*values)

    _globally(function)(Template)
    _lowered(function, QUAD, QUAD)(generate)


for _function, _operation in ARITHMETIC.items():
    _operator(_function, _operation)


def _in_all(builder: Any, number: Any) -> Any:
    undefined = ir.Constant(_FOUR, ir.Undefined)
    one = builder.insert_element(undefined, number, ir.Constant(_PLACE, 0))
    return builder.shuffle_vector(one, undefined, _places(0, 0, 0, 0))


def _places(*numbers: int) -> ir.Constant:
    return ir.Constant(ir.VectorType(_PLACE, QUAD_WIDTH), list(numbers))


def _call(builder: Any, name: str, *parts: Any) -> Any:
    """An instruction of LLVM on parts of one type."""
    value = parts[0].type
    kind = ir.FunctionType(value, [value] * len(parts))
    suffix = f"v{QUAD_WIDTH}{'f64' if value == _FOUR else 'f32'}"
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.{suffix}"), parts)


def _address(context: Any, builder: Any, kind: Any, array: Any, place: Any) -> Any:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [place]), _FOUR.as_pointer())


@instruction
def quad_of(typing: Any, x: Any, y: Any, z: Any) -> Any:
    """x, y, z and 0."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        made = ir.Constant(_FOUR, [0.0] * QUAD_WIDTH)
        for k, value in enumerate(values):
            made = builder.insert_element(made, value, ir.Constant(_PLACE, k))
        return made

    return QUAD(types.float64, types.float64, types.float64), generate


@instruction
def load_quad(typing: Any, a: Any, k: Any) -> Any:
    """Entries k to k + 3 of a flat array of doubles."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        loaded = builder.load(_address(context, builder, signature.args[0], *values))
        loaded.align = 8
        return loaded

    return QUAD(a, types.intp), generate


@instruction
def four_places(typing: Any, listed: Any, k: Any) -> Any:
    """Four times each of the entries k to k + 3 of an array of short integers: where the points of these begin."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, values[0]).data
        first = builder.gep(data, [values[1]])
        found = [builder.load(builder.gep(first, [ir.Constant(_LONG, k)])) for k in range(QUAD_WIDTH)]
        parts = [builder.shl(builder.sext(place, _LONG), ir.Constant(_LONG, 2)) for place in found]
        return context.make_tuple(builder, signature.return_type, parts)

    return types.UniTuple(types.int64, QUAD_WIDTH)(listed, types.intp), generate


@instruction
def store_quad(typing: Any, a: Any, k: Any, v: Any) -> Any:
    """Entries k to k + 3 of a flat array of doubles become v."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        builder.store(values[2], _address(context, builder, signature.args[0], *values[:2])).align = 8
        return context.get_dummy_value()

    return types.none(a, types.intp, QUAD), generate


@instruction
def fma_quad(typing: Any, a: Any, b: Any, c: Any) -> Any:
    """a b + c in one instruction, where the processor has one."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _call(builder, "fmuladd", *values)

    return QUAD(QUAD, QUAD, QUAD), generate


@instruction
def less_product(typing: Any, c: Any, a: Any, b: Any) -> Any:
    """c - a b likewise."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        c, a, b = values
        return _call(builder, "fmuladd", builder.fneg(a), b, c)

    return QUAD(QUAD, QUAD, QUAD), generate


@instruction
def floored_quad(typing: Any, v: Any) -> Any:
    """The largest whole numbers <= v."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _call(builder, "floor", *values)

    return QUAD(QUAD), generate


@instruction
def each_of_quad(typing: Any, v: Any) -> Any:
    """Each number of v in all four places."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        parts = [builder.shuffle_vector(values[0], values[0], _places(*[k] * QUAD_WIDTH)) for k in range(QUAD_WIDTH)]
        return context.make_tuple(builder, signature.return_type, parts)

    return types.UniTuple(QUAD, QUAD_WIDTH)(QUAD), generate


@instruction
def turned_quads(typing: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Four points turned: all x, all y, all z."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        def mixed(one: Any, other: Any, *places: int) -> Any:
            return builder.shuffle_vector(one, other, _places(*places))

        a, b, c, d = values
        x_z_ab, y_ab = mixed(a, b, 0, 4, 2, 6), mixed(a, b, 1, 5, 3, 7)
        x_z_cd, y_cd = mixed(c, d, 0, 4, 2, 6), mixed(c, d, 1, 5, 3, 7)
        parts = mixed(x_z_ab, x_z_cd, 0, 1, 4, 5), mixed(y_ab, y_cd, 0, 1, 4, 5), mixed(x_z_ab, x_z_cd, 2, 3, 6, 7)
        return context.make_tuple(builder, signature.return_type, parts)

    return types.UniTuple(QUAD, 3)(QUAD, QUAD, QUAD, QUAD), generate


@instruction
def repelling_quad(typing: Any, square: Any) -> Any:
    """Four times ``tissue.model.repulsion.repelling``: 2 / d - 1 where two soft balls overlap, else 0, from d^2."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        (square,), one, zero = values, ir.Constant(_FOUR, [1.0] * QUAD_WIDTH), ir.Constant(_FOUR, [0.0] * QUAD_WIDTH)
        low = _call(builder, "sqrt", builder.fptrunc(square, _SINGLES))
        rough = builder.fpext(builder.fdiv(ir.Constant(_SINGLES, [1.0] * QUAD_WIDTH), low), _FOUR)
        back = builder.fneg(builder.fmul(square, rough))
        twice = builder.fmul(rough, _call(builder, "fmuladd", back, rough, ir.Constant(_FOUR, [3.0] * QUAD_WIDTH)))
        weight = builder.fsub(twice, one)
        return builder.select(builder.fcmp_ordered(">", weight, zero), weight, zero)

    return QUAD(QUAD), generate
