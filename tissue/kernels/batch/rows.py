"""One row of all arrays of a nested named tuple, inside kernels and outside."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import types
from numba.core import cgutils
from numba.np.arrayobj import populate_array

from tissue.kernels.lanes import instruction

Tree = TypeVar("Tree")


def mapped(function: Callable[..., Any], *trees: Tree) -> Tree:
    """The named tuple whose arrays are function(array of the first, array of the second, ...)."""
    if not isinstance(trees[0], tuple):
        return cast("Tree", function(*trees))
    parts = [mapped(function, *parts) for parts in zip(*trees, strict=True)]
    return type(trees[0])(*parts)


def _is_named_tuple(kind: Any) -> bool:
    return isinstance(kind, types.BaseNamedTuple)


def _row_type(kind: Any) -> Any:
    if _is_named_tuple(kind):
        return types.BaseTuple.from_types([_row_type(part) for part in kind], kind.instance_class)
    return types.Array(kind.dtype, 1, "C")


def _row(context: Any, builder: Any, kind: Any, value: Any, index: Any) -> Any:
    result = _row_type(kind)
    if _is_named_tuple(kind):
        parts = [_row(context, builder, part, builder.extract_value(value, k), index) for k, part in enumerate(kind)]
        return context.make_tuple(builder, result, parts)
    whole, line = context.make_array(kind)(context, builder, value), context.make_array(result)(context, builder)
    shape, strides = (cgutils.unpack_tuple(builder, part, 2) for part in (whole.shape, whole.strides))
    data = cgutils.pointer_add(builder, whole.data, builder.mul(index, strides[0]), line.data.type)
    populate_array(line, data, [shape[1]], [strides[1]], whole.itemsize, None)
    return line._getvalue()


@instruction
def row(typing: Any, tree: Any, index: Any) -> Any:
    """The named tuple of the rows ``index`` of all arrays, which have two axes and are contiguous.

    Written for kernels without reference counts: the rows are views, alive as long as the arrays are.
    """

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        place = context.cast(builder, values[1], signature.args[1], types.intp)
        return _row(context, builder, signature.args[0], values[0], place)

    return _row_type(tree)(tree, index), generate
