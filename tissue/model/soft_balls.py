"""The soft repulsion of nuclei (3.13): balls of radius R_soft = 1 push each other apart where they overlap.

A sum over pairs that are scattered in memory takes three loads for each point if x, y and z are in three arrays. So
points are four doubles that follow one another, x, y, z and nothing: one load, one store, with the bits of one number.
"""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import (
    floored,
    fma,
    four_integers,
    load_from,
    shuffle,
    store_four,
    three_and_zero,
    twice_rsqrt,
    where_positive,
)
from tissue.kernels.pair_lists import row_of
from tissue.kernels.surface_workspace import PAIRS, QUAD_WIDTH, SurfaceWorkspace, periods
from tissue.kernels.workspace import FAR

Quad = Any  # four doubles

# load_quad(a, k) and store_quad(a, k, v): entries k to k + 3 of a flat array of doubles.
load_quad, store_quad = load_from(QUAD_WIDTH), store_four
_even, _odd, _lower, _upper = shuffle(0, 4, 2, 6), shuffle(1, 5, 3, 7), shuffle(0, 1, 4, 5), shuffle(2, 3, 6, 7)
_first, _second, _third, _fourth = (shuffle(*[k] * QUAD_WIDTH) for k in range(QUAD_WIDTH))


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


@inner
def push_nuclei(work: SurfaceWorkspace, n: int) -> None:
    """Push of the soft balls on each nucleus, the sum of (2 / d - 1) (X_i - X_j) over j. The lists must hold.

    Sums are added up in the order of the places, of those before p from first to last. Behind the last place is one
    that is far from all, with which rows are filled up to fours.
    """
    at, pushed, order = work.at, work.pushed, work.order
    for p in range(n):
        i = order[p]
        store_quad(at, 4 * p, three_and_zero((work.x[i], work.y[i], work.z[i])))
        store_quad(pushed, 4 * p, three_and_zero((0.0, 0.0, 0.0)))
    if work.repulsion[0] != 0.0:
        store_quad(at, 4 * n, three_and_zero((0.0, FAR, 0.0)))
        pairs = 0
        for p in range(n):
            begin, end = row_of(work, p, n)
            _push_from(work, p, begin, end)
            pairs += end - begin
        work.counts[PAIRS] += pairs
    for p in range(n):
        i = order[p]
        work.push_x[i], work.push_y[i], work.push_z[i] = pushed[4 * p], pushed[4 * p + 1], pushed[4 * p + 2]


@inner
def _push_from(work: SurfaceWorkspace, p: int, begin: int, end: int) -> None:
    """Push place p and those listed from ``begin`` to ``end`` apart."""
    at, pushed, listed = work.at, work.pushed, work.listed
    length_x, by_x, length_z, by_z = periods(work)
    length, inverse = three_and_zero((length_x, 0.0, length_z)), three_and_zero((by_x, 0.0, by_z))
    here, total = load_quad(at, 4 * p), three_and_zero((0.0, 0.0, 0.0))
    for k in range(begin, end, QUAD_WIDTH):
        q_0, q_1, q_2, q_3 = four_places(listed, k)
        d_0, d_1 = _from_image(here, at, q_0, length, inverse), _from_image(here, at, q_1, length, inverse)
        d_2, d_3 = _from_image(here, at, q_2, length, inverse), _from_image(here, at, q_3, length, inverse)
        x, y, z = turned_quads(d_0, d_1, d_2, d_3)
        w_0, w_1, w_2, w_3 = each_of_quad(repelling_quad(fma(x, x, fma(y, y, z * z))))
        total = _push(pushed, q_0, w_0, d_0, total)
        total = _push(pushed, q_1, w_1, d_1, total)
        total = _push(pushed, q_2, w_2, d_2, total)
        total = _push(pushed, q_3, w_3, d_3, total)
    store_quad(pushed, 4 * p, load_quad(pushed, 4 * p) + total)


@inner
def _from_image(here: Quad, at: Any, q: int, length: Quad, inverse: Quad) -> Quad:
    """Return the difference to the nearest image of a place."""
    d = here - load_quad(at, q)
    return fma(-length, floored(fma(d, inverse, three_and_zero((0.5, 0.5, 0.5)))), d)


@inner
def _push(pushed: Any, q: int, weight: Quad, d: Quad, total: Quad) -> Quad:
    """Push place q by -``weight`` d; ``total`` and the opposite."""
    store_quad(pushed, q, fma(-weight, d, load_quad(pushed, q)))
    return fma(weight, d, total)
