"""Points in space as four doubles that follow one another, x, y, z and nothing: one load, one store.

A sum over pairs that are scattered in memory takes three loads for each point if x, y and z are in three arrays. Four
doubles are lanes as in ``tissue.kernels.lanes``, with the same bits as one number.
"""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import (
    four_integers,
    load_from,
    shuffle,
    store_four,
    three_and_zero,
    twice_rsqrt,
    where_positive,
)

QUAD_WIDTH = 4
Quad = Any  # four doubles

# load_quad(a, k) and store_quad(a, k, v): entries k to k + 3 of a flat array of doubles.
load_quad, store_quad = load_from(QUAD_WIDTH), store_four
_even, _odd, _lower, _upper = shuffle(0, 4, 2, 6), shuffle(1, 5, 3, 7), shuffle(0, 1, 4, 5), shuffle(2, 3, 6, 7)
_first, _second, _third, _fourth = (shuffle(*[k] * QUAD_WIDTH) for k in range(QUAD_WIDTH))


@inner
def quad_of(x: float, y: float, z: float) -> Quad:
    """Return x, y, z and 0."""
    return three_and_zero((x, y, z))


@inner
def four_places(listed: Any, k: int) -> tuple[int, int, int, int]:
    """Return four times each of the entries k to k + 3 of an array: where the points of these begin."""
    p, q, r, s = four_integers(listed, k)
    return 4 * p, 4 * q, 4 * r, 4 * s


@inner
def each_of_quad(v: Quad) -> tuple[Quad, Quad, Quad, Quad]:
    """Return each number of v in all four lanes."""
    return _first(v, v), _second(v, v), _third(v, v), _fourth(v, v)


@inner
def turned_quads(a: Quad, b: Quad, c: Quad, d: Quad) -> tuple[Quad, Quad, Quad]:
    """Return the x, the y and the z of four points."""
    x_z_ab, y_ab, x_z_cd, y_cd = _even(a, b), _odd(a, b), _even(c, d), _odd(c, d)
    return _lower(x_z_ab, x_z_cd), _lower(y_ab, y_cd), _upper(x_z_ab, x_z_cd)


@inner
def repelling_quad(square: Quad) -> Quad:
    """Return 2 / d - 1 where two soft balls overlap, else 0, from d^2, see ``tissue.model.repulsion.repelling``."""
    weight = twice_rsqrt(square) - 1.0
    return where_positive(weight, weight)
