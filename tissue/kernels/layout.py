"""Workspaces of two forms on the same memory: flat, a double for each cell, and in rows, WIDTH of them at once.

A workspace is a named tuple whose annotations are its layout: which fields have a number for each cell, which a few for
each tissue, and which are arrays of a shape of their own. All other fields are numbers with a default.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import NDArray

from tissue.kernels.lanes import WIDTH
from tissue.state.cells import Floats, Integers


class Size(NamedTuple):
    """Sizes that the shapes of arrays depend on."""

    cells: int  # in each tissue
    width: int = 1  # tissues side by side: 1 or WIDTH
    edges: int = 0


@dataclass(frozen=True)
class PerCell:
    """A number for each cell, flat (m,), in rows (m / WIDTH, WIDTH): cell i of a tissue alone is number i, cell i of
    tissue k of eight number WIDTH i + k.
    """

    kind: type = np.float64


@dataclass(frozen=True)
class PerTissue:
    """Some numbers for each tissue, flat (count width,), in rows (count, WIDTH); those of a tissue alone are apart."""

    count: int
    kind: type = np.float64


@dataclass(frozen=True)
class Shared:
    """An array of this shape, the same in both forms."""

    shape: Callable[[Size], Any]
    kind: type = np.int64


# A double, or eight; a point in the plane.
Lane = Any
Plane = tuple[Lane, Lane]

CellFloats = Annotated[Floats, PerCell()]
CellIntegers = Annotated[Integers, PerCell(np.int64)]
OfCells = Annotated[Integers, Shared(lambda size: size.cells)]


def both_forms(kind: Any, size: Size, **given: Any) -> tuple[Any, Any]:
    """Make a workspace of zeros, flat and in rows; ``given``: the numbers, where they are not the defaults, and what
    there is for each tissue: one number for all, or one for each.
    """
    flat, rows, layout = dict(given), dict(given), _layout(kind)
    lines = iter(_aligned(sum(isinstance(mark, PerCell) for mark in layout.values()), size.cells * size.width))
    for name, mark in layout.items():
        if isinstance(mark, PerCell):
            flat[name] = next(lines).view(mark.kind)
            rows[name] = flat[name].reshape(-1, WIDTH)
        elif isinstance(mark, PerTissue):
            rows[name] = np.zeros((mark.count, WIDTH), mark.kind)
            rows[name][:] = given.get(name, 0)
            flat[name] = rows[name].ravel() if size.width == WIDTH else rows[name][:, 0].copy()
        else:
            flat[name] = rows[name] = np.zeros(mark.shape(size), mark.kind)
    return kind(**flat), kind(**rows)


@cache
def _layout(kind: Any) -> dict[str, Any]:
    """Return what the annotations say of the arrays of a workspace, by their names."""
    hints = get_type_hints(kind, include_extras=True)
    return {name: hint.__metadata__[0] for name, hint in hints.items() if hasattr(hint, "__metadata__")}


def _aligned(lines: int, length: int) -> list[NDArray[np.float64]]:
    """Make lines of zeros of this length, up to a multiple of WIDTH: no two lines share a place in the cache, since
    there are eight numbers between them, a line of the cache.
    """
    whole = -(-length // WIDTH) * WIDTH
    zeros = np.zeros(lines * (whole + WIDTH) + WIDTH - 1)
    begin = -zeros.ctypes.data % (8 * WIDTH) // 8
    return [zeros[k : k + whole] for k in range(begin, begin + lines * (whole + WIDTH), whole + WIDTH)]
