"""Operations on one number or on several at once: a step written with them is compiled for one run and for eight.

An array (n,) holds a double for each cell, an array (n, WIDTH) eight of them, which are one value of type Lanes.
``load(a, i)`` loads entry i of either, +, -, * and / act on all lanes, ``store(a, i, v)`` stores it. Masks take the
place of branches: there is no ``if`` on lanes. A number in place of an array stands for zeros that cost nothing, such
as a third coordinate in the plane: so formulas are written once for two axes and for three.

Each function here is one instruction, the same for one number and for each lane, and so are the results, to the last
bit. Sums and products are as written, with ``fma`` where one is intended: a compiler that may choose does so for each
copy of a loop that it makes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types

from dincl.compiled.calls import instruction
from tissue.kernels.vectors import (
    DOUBLE,
    LANES,
    LONG,
    SHORT,
    SINGLE,
    WIDTH,
    LanesType,
    address_of,
    broadcast,
    call_llvm,
    constant,
    kind_of,
    like,
    load_at,
)

__all__ = [
    "WIDTH", "binary_parts", "either", "floored", "fma", "four_integers", "gather", "load", "load_from", "load_wide",
    "lowest_bit", "maximum", "positive_bits", "root", "shuffle", "spread", "store", "store_four", "three_and_zero",
    "twice_rsqrt", "where_positive",
]  # fmt: skip


@instruction
def load(typing: Any, a: Any, i: Any) -> Any:
    """Load entry i of an array of doubles; 0 if a is a number, which stands for an array that is not there."""
    if isinstance(a, types.Float):
        return types.float64(a, types.intp), lambda c, b, s, values: constant(DOUBLE, 0.0)
    return kind_of(a)(a, types.intp), lambda c, b, s, values: load_at(b, address_of(c, b, a, DOUBLE, *values))


@instruction
def gather(typing: Any, a: Any, place: Any, k: Any) -> Any:
    """Load entry ``place`` + k of a flat array, for a place or one of each lane; a place is a whole number >= 0."""
    kind = kind_of(place)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, values[0]).data
        if not isinstance(kind, LanesType):
            return builder.load(builder.gep(data, [builder.add(builder.fptosi(values[1], LONG), values[2])]))
        places = builder.fptosi(values[1], like(kind, LONG))
        found: Any = ir.Constant(like(kind, DOUBLE), ir.Undefined)
        for lane in (ir.Constant(SHORT, number) for number in range(kind.width)):
            one = builder.add(builder.extract_element(places, lane), values[2])
            found = builder.insert_element(found, builder.load(builder.gep(data, [one])), lane)
        return found

    return kind(a, kind, types.intp), generate


@instruction
def load_wide(typing: Any, a: Any, i: Any) -> Any:
    """Load entry i of an array of doubles into eight lanes: eight numbers, or one in all of them."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        loaded = load_at(builder, address_of(context, builder, a, DOUBLE, *values))
        return loaded if kind_of(a) == LANES else broadcast(builder, loaded)

    return LANES(a, types.intp), generate


@instruction
def store(typing: Any, a: Any, i: Any, v: Any) -> Any:
    """Store v as entry i of an array of doubles; nowhere if a is a number, which stands for an array not there."""
    if isinstance(a, types.Float):
        return types.none(a, types.intp, v), lambda c, b, s, values: c.get_dummy_value()

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        builder.store(values[2], address_of(context, builder, a, DOUBLE, *values[:2])).align = 8
        return context.get_dummy_value()

    return types.none(a, types.intp, kind_of(a)), generate


def load_from(width: int) -> Callable[..., Any]:
    """Make the function ``f(a, k)`` that loads entries k to k + width - 1 of a flat array of doubles, for any k."""

    @instruction
    def load_lanes(typing: Any, a: Any, k: Any) -> Any:
        return LanesType(width)(a, types.intp), lambda c, b, s, values: load_at(b, _lanes_at(c, b, a, width, *values))

    return load_lanes


@instruction
def store_four(typing: Any, a: Any, k: Any, v: Any) -> Any:
    """Store v as entries k to k + 3 of a flat array of doubles."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        builder.store(values[2], _lanes_at(context, builder, a, 4, *values[:2])).align = 8
        return context.get_dummy_value()

    return types.none(a, types.intp, LanesType(4)), generate


def _lanes_at(context: Any, builder: Any, kind: Any, width: int, array: Any, place: Any) -> Any:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [place]), ir.VectorType(DOUBLE, width).as_pointer())


@instruction
def four_integers(typing: Any, a: Any, k: Any) -> Any:
    """Return entries k to k + 3 of a flat array of 32-bit integers."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, values[0]).data
        first = builder.gep(data, [values[1]])
        found = (builder.load(builder.gep(first, [ir.Constant(LONG, k)])) for k in range(4))
        return context.make_tuple(builder, signature.return_type, [builder.sext(one, LONG) for one in found])

    return types.UniTuple(types.int64, 4)(a, types.intp), generate


@instruction
def three_and_zero(typing: Any, numbers: Any) -> Any:
    """Put three doubles into the first of four lanes, and 0 into the last."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        lanes: Any = ir.Constant(ir.VectorType(DOUBLE, 4), [0.0] * 4)
        for k in range(3):
            lanes = builder.insert_element(lanes, builder.extract_value(values[0], k), ir.Constant(SHORT, k))
        return lanes

    return LanesType(4)(types.UniTuple(types.float64, 3)), generate


def shuffle(*places: int) -> Callable[..., Any]:
    """Make the function ``f(a, b)`` whose lane k is number ``places[k]`` of the lanes of a, then of b."""

    @instruction
    def mix(typing: Any, a: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            chosen = ir.Constant(ir.VectorType(SHORT, len(places)), list(places))
            return builder.shuffle_vector(values[0], values[1], chosen)

        return LanesType(len(places))(a, b), generate

    return mix


@instruction
def spread(typing: Any, a: Any, number: Any) -> Any:
    """Return the number as an entry of this array would be: alone, or in all lanes."""
    wide = kind_of(a) == LANES
    return kind_of(a)(a, types.float64), lambda c, b, s, values: broadcast(b, values[1]) if wide else values[1]


def _computed(parts: Any, compute: Callable[..., Any]) -> Any:
    """Describe an instruction on values: all are lanes if one is, and so is the result."""
    kind = kind_of(*parts)
    return kind(*[kind] * len(parts)), lambda context, builder, signature, values: compute(builder, *values)


def _is_positive(builder: Any, v: Any) -> Any:
    return builder.fcmp_ordered(">", v, constant(v.type, 0.0))


@instruction
def where_positive(typing: Any, condition: Any, v: Any) -> Any:
    """Return v where ``condition`` > 0, else 0; a NaN of v stays where the condition holds."""
    return _computed((condition, v), lambda b, c, v: b.select(_is_positive(b, c), v, constant(v.type, 0.0)))


@instruction
def either(typing: Any, condition: Any, v: Any, otherwise: Any) -> Any:
    """Return v where ``condition`` > 0, else ``otherwise``, in each lane."""
    return _computed((condition, v, otherwise), lambda b, c, v, o: b.select(_is_positive(b, c), v, o))


@instruction
def maximum(typing: Any, a: Any, b: Any) -> Any:
    """Return the larger number in each lane; b where one is NaN."""
    return _computed((a, b), lambda builder, a, b: builder.select(builder.fcmp_ordered(">", a, b), a, b))


@instruction
def fma(typing: Any, a: Any, b: Any, c: Any) -> Any:
    """Compute a b + c in one instruction, where the processor has one."""
    return _computed((a, b, c), lambda builder, a, b, c: call_llvm(builder, "fmuladd", a, b, c))


@instruction
def floored(typing: Any, v: Any) -> Any:
    """Return the largest whole number <= v."""
    return _computed((v,), lambda builder, v: call_llvm(builder, "floor", v))


@instruction
def root(typing: Any, v: Any) -> Any:
    """Compute the square root, rounded correctly."""
    return _computed((v,), lambda builder, v: call_llvm(builder, "sqrt", v))


@instruction
def twice_rsqrt(typing: Any, v: Any) -> Any:
    """Compute 2 / sqrt(v) to 2e-14: y (3 - v y^2) for y in single precision, one Newton step.

    v must lie between 1e-37 and 1e37. Twice, because this has one instruction less than once, and users have a factor
    to put it into.
    """
    kind = kind_of(v)

    def compute(builder: Any, v: Any) -> Any:
        single = like(kind, SINGLE)
        low = call_llvm(builder, "sqrt", builder.fptrunc(v, single))
        rough = builder.fpext(builder.fdiv(constant(single, 1.0), low), v.type)
        back = builder.fneg(builder.fmul(v, rough))
        return builder.fmul(rough, call_llvm(builder, "fmuladd", back, rough, constant(v.type, 3.0)))

    return _computed((v,), compute)


@instruction
def binary_parts(typing: Any, v: Any) -> Any:
    """Return m and e of v = m 2^e, 1 <= m < 2; v must be positive and normal."""
    kind = kind_of(v)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        long, double = like(kind, LONG), like(kind, DOUBLE)
        bits = builder.bitcast(values[0], long)
        shift, mask, one = (constant(long, part) for part in (52, (1 << 52) - 1, 1023 << 52))
        mantissa = builder.bitcast(builder.or_(builder.and_(bits, mask), one), double)
        exponent = builder.fsub(builder.sitofp(builder.lshr(bits, shift), double), constant(double, 1023.0))
        return context.make_tuple(builder, signature.return_type, [mantissa, exponent])

    return types.UniTuple(kind, 2)(kind), generate


@instruction
def positive_bits(typing: Any, v: Any) -> Any:
    """Return an integer with bit k set where v > 0 in lane k."""
    kind = kind_of(v)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        positive = _is_positive(builder, values[0])
        if isinstance(kind, LanesType):
            positive = builder.bitcast(positive, ir.IntType(kind.width))
        return builder.zext(positive, LONG)

    return types.int64(kind), generate


@instruction
def lowest_bit(typing: Any, bits: Any) -> Any:
    """Return the place of the lowest bit that is set; there must be one."""
    return types.int64(types.int64), lambda c, b, s, values: b.cttz(values[0], ir.Constant(ir.IntType(1), 1))
