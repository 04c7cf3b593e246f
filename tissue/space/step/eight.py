"""Eight numbers of a flat array that follow one another, wherever they begin."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types

from tissue.kernels.lanes import LANES, WIDTH, instruction


@instruction
def load_from(typing: Any, a: Any, k: Any) -> Any:
    """Entries k to k + 7 of a flat array of doubles."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, values[0]).data
        eight = ir.VectorType(ir.DoubleType(), WIDTH).as_pointer()
        loaded = builder.load(builder.bitcast(builder.gep(data, [values[1]]), eight))
        loaded.align = 8
        return loaded

    return LANES(a, types.intp), generate
