"""Exact optimal transport between weighted points in any dimension, with proved bounds.

The linear program  min sum_ij P_ij |x_i - y_j|  is solved on few candidate pairs (column generation). Its dual
variables (u, v) are then compared with the costs of all pairs, one box of points with another at a time. Pairs with
u_i + v_j > |x_i - y_j| are added, and the program is solved again. Lowering u_i by max_j (u_i + v_j - |x_i - y_j|)
makes the dual variables feasible: their value is a lower bound of W1. The plan gives an upper bound. When the bounds
meet, the value is proved, although most pairs were never part of the program.

This is the only module that imports POT.
"""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.spatial import cKDTree

from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.status import Status
from meanfield.errors import SolveFailed

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

# Up to this number of pairs, the program has all of them: 8 MB for the costs, about 0.2 s.
ALL_PAIRS = 1_000_000
# Different points on each side: at 1e5 points one value takes 2 to 4 minutes and 0.6 GB.
MAX_TRANSPORT_POINTS = 200_000
# Largest gap between the bounds, in units of the diameter: the simplex method is accurate to about 1e-12.
GAP = 1e-11
# Relative gap of a coarse program, which only supplies candidate pairs and dual variables for the next finer program.
COARSE_GAP = 1e-3
# Points per coarse point; points per box whose costs are computed together; nearest points that become candidates.
CLUSTER_SIZE, BOX_SIZE, NEIGHBOURS = 4, 64, 10
# Violated pairs added per point and round, the most violated first.
PAIRS_PER_POINT = 6
# Measured: 3 to 12 rounds, from 1e3 to 1e5 points.
MAX_ROUNDS = 30
# The total mass in integer units: a power of 2, so that POT's rescaling of one sum to the other is exact.
MASS_UNITS = 2.0**52
# POT's default limit of 1e5 pivots is reached at a thousand points; the simplex method terminates without a limit.
MAX_PIVOTS = 10**9


class Bounds(NamedTuple):
    """lower <= W1 <= upper, up to the rounding of sums."""

    lower: float
    upper: float


class _Points(NamedTuple):
    at: Floats  # (n, d)
    mass: Floats  # (n,), integers

    def merged(self) -> _Points:
        """Merge points at the same place and drop points without mass."""
        present = self.mass > 0
        at, place = np.unique(self.at[present], axis=0, return_inverse=True)
        return _Points(at, np.bincount(place.ravel(), self.mass[present]).astype(np.float64))


class _Plan(NamedTuple):
    rows: Indices
    columns: Indices
    u: Floats
    v: Floats
    bounds: Bounds


class _Boxes(NamedTuple):
    members: list[Indices]
    low: Floats
    high: Floats


def bounds(x: Floats, a: Floats, y: Floats, b: Floats, gap: float = 0.0) -> Bounds:
    """Compute proved bounds of W1 of sum_i a_i delta(x_i) and sum_j b_j delta(y_j), for the Euclidean distance.

    Parameters
    ----------
    x, a
        points (n, d) and their masses > 0 (n,), which sum to 1.
    y, b
        points (k, d) and masses (k,) of the other measure.
    gap
        stop when upper - lower <= gap upper; 0: when the gap is at rounding, 1e-11 of the diameter.

    Raises
    ------
    InvalidProblem
        if a measure has more than 200 000 different points.
    SolveFailed
        if the linear program did not reach its optimum; there is no partial result.
    """
    size = float(np.linalg.norm(np.maximum(x.max(0), y.max(0)) - np.minimum(x.min(0), y.min(0))))
    if size == 0.0:
        return Bounds(0.0, 0.0)
    middle, masses = y.mean(axis=0), _integer_masses(a, b)
    one, other = (_Points((at - middle) / size, mass).merged() for at, mass in zip((x, y), masses, strict=True))
    if max(len(one.at), len(other.at)) > MAX_TRANSPORT_POINTS:
        raise InvalidProblem(
            f"{len(one.at)} and {len(other.at)} points: must be at most {MAX_TRANSPORT_POINTS} each for exact transport"
        )
    found = _solve(one, other, gap).bounds
    return Bounds(max(found.lower, 0.0) * size, found.upper * size)


def _integer_masses(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Round masses to integers of equal sum: flows are then exact, and rounding cannot make a program infeasible."""
    if len(a) == len(b) and np.all(a == a[0]) and np.all(b == b[0]):
        return np.ones(len(a)), np.ones(len(b))
    # Cumulative sums are rounded instead of masses, so that errors do not accumulate.
    sums = [np.round(np.cumsum(mass) / mass.sum() * MASS_UNITS) for mass in (a, b)]
    for cumulative in sums:
        cumulative[-1] = MASS_UNITS
    return np.diff(sums[0], prepend=0.0), np.diff(sums[1], prepend=0.0)


def _solve(x: _Points, y: _Points, gap: float) -> _Plan:
    """Compute an optimal plan and its dual variables.

    The program has all pairs if they are few. Otherwise a coarser problem, solved the same way, supplies candidate
    pairs and dual variables.
    """
    if len(x.at) * len(y.at) <= ALL_PAIRS:
        return _solve_all_pairs(x, y)
    (coarse_x, in_x, part_x), (coarse_y, in_y, part_y) = _cluster(x), _cluster(y)
    coarse = _solve(coarse_x, coarse_y, COARSE_GAP)
    refined = [
        (np.repeat(part_x[i], len(part_y[j])), np.tile(part_y[j], len(part_x[i])))
        for i, j in zip(coarse.rows.tolist(), coarse.columns.tolist(), strict=True)
    ]
    codes = np.concatenate([rows * len(y.at) + columns for rows, columns in refined] + [_nearest(x.at, y.at)])
    return _generate_columns(x, y, codes, coarse.u[in_x], coarse.v[in_y], gap)


def _solve_all_pairs(x: _Points, y: _Points) -> _Plan:
    costs = _distances(x.at[:, None], y.at)
    plan = _optimum(x, y, costs)
    correction = np.minimum((costs - plan.u[:, None] - plan.v).min(axis=1), 0.0)
    proved = plan._replace(bounds=_proved(x, y, plan.u + correction, plan.v, plan.bounds.upper))
    if proved.bounds.upper - proved.bounds.lower > GAP:
        raise SolveFailed(Status.NOT_CONVERGED, "(transport: POT stopped before the optimum)", None)
    return proved


def _proved(x: _Points, y: _Points, u: Floats, v: Floats, upper: float) -> Bounds:
    """Return the value of feasible dual variables as lower bound, beside the upper bound of a plan."""
    return Bounds(min(float(x.mass @ u + y.mass @ v) / float(x.mass.sum()), upper), upper)


def _generate_columns(x: _Points, y: _Points, codes: Indices, u: Floats, v: Floats, gap: float) -> _Plan:
    """Solve on candidate pairs, code = row n_y + column, and add violated pairs until the bounds meet."""
    boxes_x, boxes_y = _boxes(x.at), _boxes(y.at)
    codes = np.unique(codes)
    for attempt in range(MAX_ROUNDS):
        rows, columns = np.divmod(codes, len(y.at))
        # With known dual variables subtracted from the costs, the simplex method is ten times faster.
        costs = _distances(x.at[rows], y.at[columns]) - u[rows] - v[columns]
        plan = _optimum(x, y, coo_array((costs, (rows, columns)), shape=(len(x.at), len(y.at))))
        u, v = plan.u + u, plan.v + v
        violated, correction = _violated(x.at, y.at, u, v, boxes_x, boxes_y)
        proved = _proved(x, y, u + correction, v, plan.bounds.upper)
        if proved.upper - proved.lower <= max(GAP, gap * proved.upper):
            return plan._replace(u=u, v=v, bounds=proved)
        if attempt == 0:
            # Half of the first candidates are dropped. Pairs added later stay, so that the rounds cannot cycle.
            reduced = costs - plan.u[rows] - plan.v[columns]
            codes = np.append(codes[reduced <= np.median(reduced)], plan.rows * len(y.at) + plan.columns)
        codes = np.unique(np.append(codes, violated))
    detail = f"(transport: pairs are still violated after {MAX_ROUNDS} rounds)"
    raise SolveFailed(Status.NOT_CONVERGED, detail, None)


def _optimum(x: _Points, y: _Points, costs: Floats | coo_array) -> _Plan:
    """Compute the optimal plan for given costs of all or some pairs; its upper bound is the cost in distances."""
    with needs("w1 of points in d >= 2", "transport"):
        import ot

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the same message is in the log
        plan, log = ot.emd(x.mass, y.mass, costs, numItermax=MAX_PIVOTS, log=True, center_dual=False)
    if log["warning"] is not None:
        raise SolveFailed(Status.NOT_CONVERGED, f"(POT: {log['warning']})", None)
    flow = coo_array(plan)
    rows, columns = flow.row.astype(np.int64), flow.col.astype(np.int64)
    cost = float(_distances(x.at[rows], y.at[columns]) @ flow.data) / float(x.mass.sum())
    return _Plan(rows, columns, np.asarray(log["u"]), np.asarray(log["v"]), Bounds(cost, cost))


def _violated(x: Floats, y: Floats, u: Floats, v: Floats, boxes_x: _Boxes, boxes_y: _Boxes) -> tuple[Indices, Floats]:
    """Find pairs with |x_i - y_j| < u_i + v_j, and corrections of u that make the dual variables feasible.

    Returns the codes of at most PAIRS_PER_POINT pairs for each i, and min_j (|x_i - y_j| - u_i - v_j, 0).
    """
    largest = np.array([v[members].max() for members in boxes_y.members])
    correction, found = np.zeros(len(x)), [np.empty(0, dtype=np.int64)]
    for members, low, high in zip(*boxes_x, strict=True):
        separation = np.linalg.norm(np.maximum(np.maximum(boxes_y.low - high, low - boxes_y.high), 0.0), axis=1)
        candidates = np.flatnonzero(separation < u[members].max() + largest)
        if not candidates.size:
            continue
        others = np.concatenate([boxes_y.members[k] for k in candidates])
        reduced = _distances(x[members][:, None], y[others][None]) - u[members][:, None] - v[others]
        correction[members] = np.minimum(reduced.min(axis=1), 0.0)
        last = min(PAIRS_PER_POINT, len(others)) - 1
        worst = np.argpartition(reduced, last, axis=1)[:, : last + 1]
        row, column = np.nonzero(np.take_along_axis(reduced, worst, axis=1) < -GAP)
        found.append(members[row] * len(y) + others[worst[row, column]])
    return np.concatenate(found), correction


def _nearest(x: Floats, y: Floats) -> Indices:
    """Return the codes of all pairs of a point and one of its nearest points on the other side."""
    from_x = cKDTree(y).query(x, min(NEIGHBOURS, len(y)))[1].reshape(len(x), -1)
    from_y = cKDTree(x).query(y, min(NEIGHBOURS, len(x)))[1].reshape(len(y), -1)
    one = np.arange(len(x))[:, None] * len(y) + from_x
    other = from_y * len(y) + np.arange(len(y))[:, None]
    return np.concatenate([one.ravel(), other.ravel()])


def _cluster(points: _Points) -> tuple[_Points, Indices, list[Indices]]:
    """Return the centres of mass of small boxes, the box of each point, and the points of each box."""
    parts = _boxes(points.at, CLUSTER_SIZE).members
    label = np.empty(len(points.at), dtype=np.int64)
    label[np.concatenate(parts)] = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    mass = np.bincount(label, points.mass).astype(np.float64)
    centre = [np.bincount(label, points.mass * column) / mass for column in points.at.T]
    return _Points(np.stack(centre, axis=1), mass), label, parts


def _boxes(points: Floats, size: int = BOX_SIZE) -> _Boxes:
    """Divide points into boxes of at most ``size`` points, the leaves of a tree."""
    leaves, waiting = [], [cKDTree(points, leafsize=size).tree]
    while waiting:
        node = waiting.pop()
        if node.lesser is None:
            leaves.append(node.indices.astype(np.int64))
        else:
            waiting += [node.lesser, node.greater]
    low = np.array([points[leaf].min(axis=0) for leaf in leaves])
    high = np.array([points[leaf].max(axis=0) for leaf in leaves])
    return _Boxes(leaves, low, high)


def _distances(x: Floats, y: Floats) -> Floats:
    distance: Floats = np.sqrt(((x - y) ** 2).sum(axis=-1))
    return distance
