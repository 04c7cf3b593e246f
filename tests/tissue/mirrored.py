"""Tissues seen in a mirror, and rings that are counted from another cell: every rule must treat them alike."""

import numpy as np

from tests.twins.tissue.state import Tissue
from tissue.model.junctions import pairs
from tissue.state.cells import CellLayers, Emt

# Coordinates along the tissue, which change their sign.
ALONG = ("x", "ax", "bx", "along")
# Names of cells: of two daughters the left one keeps that of the mother.
NAMES = ("id", "mother", "chain")


def mirrored(tissue, closed=False):
    """The same tissue from right to left: each number stays with its cell, each rest length with its junction."""
    n, order = len(tissue.cells.x), slice(None, None, -1)
    made = type(tissue.cells)(*(array[order].copy() for array in tissue.cells))
    for name in ALONG:
        getattr(made, name)[:] *= -1.0
    made = _with_junctions(tissue, made, lambda i: n - 1 - i, closed)
    made.emt.since_x[:] *= -1.0
    return made


def turned(tissue, first, length):
    """The same ring of this length, counted from cell ``first``: the cells before it come behind all others."""
    n = len(tissue.cells.x)
    made = type(tissue.cells)(*(np.roll(array, -first) for array in tissue.cells))
    made.along[n - first :] += length
    return _with_junctions(tissue, made, lambda i: (i - first) % n, closed=True)


def _with_junctions(tissue, made, place, closed):
    """Cells that are in other places now, with the rest lengths of their junctions, their layers and EMT cells."""
    layers = CellLayers(*(np.sort(place(layer)) for layer in tissue.layers))
    rest = {frozenset(place(np.array(ends))): length for *ends, length in junctions(tissue, closed)}
    made.rest_aa[:] = 0.0
    for i, j in zip(*pairs(made, layers, closed), strict=True):
        made.rest_aa[i] = rest[frozenset((i, j))]
    number = made.emt[made.emt >= 0]
    made.emt[made.emt >= 0] = np.arange(len(number))
    emt = Emt(*(np.ascontiguousarray(array[..., number]) for array in tissue.emt))
    return Tissue(made, layers, tissue.next_id, emt)


def junctions(tissue, closed=False):
    """The cells i and j of each junction, and its rest length, from left to right."""
    i, j = pairs(tissue.cells, tissue.layers, closed)
    return sorted(zip(i.tolist(), j.tolist(), tissue.cells.rest_aa[i].tolist(), strict=True))


def compare(one, other, closed=False, rounding=1e-10):
    """Fail unless two tissues are the same to rounding, whatever their cells are called."""
    for a, b in zip(one.layers, other.layers, strict=True):
        np.testing.assert_array_equal(a, b)
    for name, a, b in zip(one.cells._fields, one.cells, other.cells, strict=True):
        if name not in (*NAMES, "rest_aa"):
            np.testing.assert_allclose(a, b, rtol=0.0, atol=rounding, err_msg=name)
    for a, b in zip(junctions(one, closed), junctions(other, closed), strict=True):
        np.testing.assert_allclose(a, b, rtol=0.0, atol=rounding, err_msg="junctions")
    for name, a, b in zip(one.emt._fields, one.emt, other.emt, strict=True):
        np.testing.assert_allclose(a, b, rtol=0.0, atol=rounding, err_msg=name)
