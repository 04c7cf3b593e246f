"""The numbers of a run as kernels get them: a struct for each type of cell, one behind the other in memory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, get_type_hints

from dincl.compiled import StructPointer, reader, struct_type
from dincl.compiled.structs import struct_after
from tissue.state.numbers import Numbers

# Yes and no are integers in memory.
_EXAMPLE: Any = Numbers._make(0.0 if kind is float else 0 for kind in get_type_hints(Numbers).values())
NUMBERS = struct_type(_EXAMPLE)
numbers_at = reader(_EXAMPLE)
# numbers_of(numbers, kind): the numbers of the cells of a kind, from those that ``numbers_pointer`` passes to kernels.
numbers_of = struct_after


def numbers_pointer(numbers: Numbers, named: Sequence[Numbers] = ()) -> Any:
    """Make the struct of the numbers of a run: for kernels it is ``Numbers``, those of control cells.

    Behind these lie those of EMT cells, the same, and of the named types, so that ``Cells.kind`` says where.
    """
    kinds = (numbers, numbers, *named)
    return StructPointer(
        tuple(tuple(type(one)(value) for one, value in zip(_EXAMPLE, kind, strict=True)) for kind in kinds), NUMBERS
    )
