"""The soft repulsion of nuclei (3.13): balls of radius R_soft = 1 push each other apart where they overlap."""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import floored, fma
from tissue.kernels.pair_lists import row_of
from tissue.kernels.quads import (
    QUAD_WIDTH,
    Quad,
    each_of_quad,
    four_places,
    load_quad,
    quad_of,
    repelling_quad,
    store_quad,
    turned_quads,
)
from tissue.kernels.surface_workspace import PAIRS, SurfaceWorkspace, periods
from tissue.kernels.workspace import FAR


@inner
def push_nuclei(work: SurfaceWorkspace, n: int) -> None:
    """Push of the soft balls on each nucleus, the sum of (2 / d - 1) (X_i - X_j) over j. The lists must hold.

    Sums are added up in the order of the places, of those before p from first to last. Behind the last place is one
    that is far from all, with which rows are filled up to fours.
    """
    at, pushed, order = work.at, work.pushed, work.order
    for p in range(n):
        i = order[p]
        store_quad(at, 4 * p, quad_of(work.x[i], work.y[i], work.z[i]))
        store_quad(pushed, 4 * p, quad_of(0.0, 0.0, 0.0))
    if work.repulsion[0] != 0.0:
        store_quad(at, 4 * n, quad_of(0.0, FAR, 0.0))
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
    length, inverse = quad_of(length_x, 0.0, length_z), quad_of(by_x, 0.0, by_z)
    here, total = load_quad(at, 4 * p), quad_of(0.0, 0.0, 0.0)
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
    return fma(-length, floored(fma(d, inverse, quad_of(0.5, 0.5, 0.5))), d)


@inner
def _push(pushed: Any, q: int, weight: Quad, d: Quad, total: Quad) -> Quad:
    """Push place q by -``weight`` d; ``total`` and the opposite."""
    store_quad(pushed, q, fma(-weight, d, load_quad(pushed, q)))
    return fma(weight, d, total)
