"""Exact optimal transport between weighted points in any dimension, with a certificate; the only door to POT.

The linear program  min sum_ij P_ij |x_i - y_j|  is solved on few pairs. Its prices (u, v) are then compared with the
cost of all pairs, whole boxes of points at once: pairs with u_i + v_j > |x_i - y_j| are added, and the program is
solved anew. Lowering u_i by max_j (u_i + v_j - |x_i - y_j|) makes the prices feasible, so that their value is a lower
bound of W1; the plan gives an upper one. Where both meet, the value is proved, although most pairs were never in it.
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

# Up to this number of pairs all of them are given to the program at once: 8 MB for the costs, some 0.2 s.
ALL_PAIRS = 1_000_000
# Places on each side: at 1e5 one value takes 2 to 4 minutes and 0.6 GB.
MOST_POINTS = 200_000
# Between the bounds, in units of the diameter: the simplex method keeps its prices to some 1e-12.
CLOSED = 1e-11
# A coarse program only guides the next finer one.
GUIDE = 1e-3
# Points that a coarse point stands for; points of a box that is priced as a whole; nearest points that are candidates.
CLUSTER, BOX, NEAR = 4, 64, 10
# Added for each point and round, the most violated first.
ADDED = 6
# Measured: 3 to 12, from 1e3 to 1e5 points.
MOST_ROUNDS = 30
# Masses are whole numbers of units: of a power of 2, so that POT's scaling of one sum to the other changes nothing.
UNITS = 2.0**52
# Pivots: POT's own limit of 1e5 is reached at a thousand points; the simplex method ends by itself.
MOST_PIVOTS = 10**9


class Bounds(NamedTuple):
    """lower <= W1 <= upper, up to the rounding of sums."""

    lower: float
    upper: float


class _Points(NamedTuple):
    at: Floats  # (n, d)
    mass: Floats  # (n,), whole numbers

    def merged(self) -> _Points:
        """Those that have mass, each place once."""
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
    """W1 of sum_i a_i delta(x_i) and sum_j b_j delta(y_j) for the Euclidean distance, between proved bounds.

    Parameters
    ----------
    x, a
        Points (n, d) and their masses > 0 (n,), which sum to 1.
    y, b
        The same on the other side.
    gap
        Stop where upper - lower <= gap upper; 0: at rounding, 1e-11 of the diameter.

    Raises
    ------
    InvalidProblem
        If there are more points, in different places, than one can wait for.
    SolveFailed
        If the linear program did not end at its optimum; there is no partial result.
    """
    size = float(np.linalg.norm(np.maximum(x.max(0), y.max(0)) - np.minimum(x.min(0), y.min(0))))
    if size == 0.0:
        return Bounds(0.0, 0.0)
    middle, whole = y.mean(axis=0), _whole(a, b)
    one, other = (_Points((at - middle) / size, mass).merged() for at, mass in zip((x, y), whole, strict=True))
    if max(len(one.at), len(other.at)) > MOST_POINTS:
        raise InvalidProblem(
            f"{len(one.at)} and {len(other.at)} points: exact transport in d >= 2 takes {MOST_POINTS} each"
        )
    found = _solve(one, other, gap).bounds
    return Bounds(max(found.lower, 0.0) * size, found.upper * size)


def _whole(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Masses as whole numbers with one sum: then flows are exact, and rounding makes no program infeasible."""
    if len(a) == len(b) and np.all(a == a[0]) and np.all(b == b[0]):
        return np.ones(len(a)), np.ones(len(b))
    # Sums are rounded, not masses: so errors do not add up.
    sums = [np.round(np.cumsum(mass) / mass.sum() * UNITS) for mass in (a, b)]
    for below in sums:
        below[-1] = UNITS
    return np.diff(sums[0], prepend=0.0), np.diff(sums[1], prepend=0.0)


def _solve(x: _Points, y: _Points, gap: float) -> _Plan:
    """Optimal plan and prices: of all pairs if they are few, else of those that coarser points and prices suggest."""
    if len(x.at) * len(y.at) <= ALL_PAIRS:
        return _of_all_pairs(x, y)
    (few_x, in_x, part_x), (few_y, in_y, part_y) = _clustered(x), _clustered(y)
    coarse = _solve(few_x, few_y, GUIDE)
    refined = [
        (np.repeat(part_x[i], len(part_y[j])), np.tile(part_y[j], len(part_x[i])))
        for i, j in zip(coarse.rows.tolist(), coarse.columns.tolist(), strict=True)
    ]
    codes = np.concatenate([rows * len(y.at) + columns for rows, columns in refined] + [_near(x.at, y.at)])
    return _priced(x, y, codes, coarse.u[in_x], coarse.v[in_y], gap)


def _of_all_pairs(x: _Points, y: _Points) -> _Plan:
    costs = _distances(x.at[:, None], y.at)
    plan = _optimum(x, y, costs)
    lacking = np.minimum((costs - plan.u[:, None] - plan.v).min(axis=1), 0.0)
    proved = plan._replace(bounds=_proved(x, y, plan.u + lacking, plan.v, plan.bounds.upper))
    if proved.bounds.upper - proved.bounds.lower > CLOSED:
        raise SolveFailed(Status.NOT_CONVERGED, "(transport: POT stopped before the optimum)", None)
    return proved


def _proved(x: _Points, y: _Points, u: Floats, v: Floats, upper: float) -> Bounds:
    """The value of feasible prices below that of a plan."""
    return Bounds(min(float(x.mass @ u + y.mass @ v) / float(x.mass.sum()), upper), upper)


def _priced(x: _Points, y: _Points, codes: Indices, u: Floats, v: Floats, gap: float) -> _Plan:
    """Solve on candidate pairs, code = row n_y + column, and add violated ones until the bounds meet."""
    boxes_x, boxes_y = _boxes(x.at), _boxes(y.at)
    codes = np.unique(codes)
    for tried in range(MOST_ROUNDS):
        rows, columns = np.divmod(codes, len(y.at))
        # Known prices, taken off the costs, lead the first pivots: ten times faster.
        costs = _distances(x.at[rows], y.at[columns]) - u[rows] - v[columns]
        plan = _optimum(x, y, coo_array((costs, (rows, columns)), shape=(len(x.at), len(y.at))))
        u, v = plan.u + u, plan.v + v
        violated, lacking = _violated(x.at, y.at, u, v, boxes_x, boxes_y)
        proved = _proved(x, y, u + lacking, v, plan.bounds.upper)
        if proved.upper - proved.lower <= max(CLOSED, gap * proved.upper):
            return plan._replace(u=u, v=v, bounds=proved)
        if tried == 0:
            # Most candidates are far from use. Later ones stay, so that the rounds cannot run in circles.
            reduced = costs - plan.u[rows] - plan.v[columns]
            codes = np.append(codes[reduced <= np.median(reduced)], plan.rows * len(y.at) + plan.columns)
        codes = np.unique(np.append(codes, violated))
    detail = f"(transport: not all pairs are priced after {MOST_ROUNDS} rounds)"
    raise SolveFailed(Status.NOT_CONVERGED, detail, None)


def _optimum(x: _Points, y: _Points, costs: Floats | coo_array) -> _Plan:
    """The optimal plan for given costs, of all pairs or of some; its upper bound is the distance that it carries."""
    with needs("w1 of points in d >= 2", "meanfield"):
        import ot

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the same message is in the log
        plan, log = ot.emd(x.mass, y.mass, costs, numItermax=MOST_PIVOTS, log=True, center_dual=False)
    if log["warning"] is not None:
        raise SolveFailed(Status.NOT_CONVERGED, f"(POT: {log['warning']})", None)
    flow = coo_array(plan)
    rows, columns = flow.row.astype(np.int64), flow.col.astype(np.int64)
    cost = float(_distances(x.at[rows], y.at[columns]) @ flow.data) / float(x.mass.sum())
    return _Plan(rows, columns, np.asarray(log["u"]), np.asarray(log["v"]), Bounds(cost, cost))


def _violated(x: Floats, y: Floats, u: Floats, v: Floats, boxes_x: _Boxes, boxes_y: _Boxes) -> tuple[Indices, Floats]:
    """Codes of pairs with |x_i - y_j| < u_i + v_j, up to ADDED for each i, and min_j (|x_i - y_j| - u_i - v_j, 0)."""
    highest = np.array([v[members].max() for members in boxes_y.members])
    lacking, found = np.zeros(len(x)), [np.empty(0, dtype=np.int64)]
    for mine, low, high in zip(*boxes_x, strict=True):
        apart = np.linalg.norm(np.maximum(np.maximum(boxes_y.low - high, low - boxes_y.high), 0.0), axis=1)
        close = np.flatnonzero(apart < u[mine].max() + highest)
        if not close.size:
            continue
        others = np.concatenate([boxes_y.members[k] for k in close])
        reduced = _distances(x[mine][:, None], y[others][None]) - u[mine][:, None] - v[others]
        lacking[mine] = np.minimum(reduced.min(axis=1), 0.0)
        most = min(ADDED, len(others)) - 1
        worst = np.argpartition(reduced, most, axis=1)[:, : most + 1]
        row, place = np.nonzero(np.take_along_axis(reduced, worst, axis=1) < -CLOSED)
        found.append(mine[row] * len(y) + others[worst[row, place]])
    return np.concatenate(found), lacking


def _near(x: Floats, y: Floats) -> Indices:
    """Codes of each point with its nearest ones on the other side."""
    from_x = cKDTree(y).query(x, min(NEAR, len(y)))[1].reshape(len(x), -1)
    from_y = cKDTree(x).query(y, min(NEAR, len(x)))[1].reshape(len(y), -1)
    one = np.arange(len(x))[:, None] * len(y) + from_x
    other = from_y * len(y) + np.arange(len(y))[:, None]
    return np.concatenate([one.ravel(), other.ravel()])


def _clustered(points: _Points) -> tuple[_Points, Indices, list[Indices]]:
    """The centres of mass of small boxes; for each point its box, and for each box its points."""
    parts = _boxes(points.at, CLUSTER).members
    label = np.empty(len(points.at), dtype=np.int64)
    label[np.concatenate(parts)] = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    mass = np.bincount(label, points.mass).astype(np.float64)
    centre = [np.bincount(label, points.mass * column) / mass for column in points.at.T]
    return _Points(np.stack(centre, axis=1), mass), label, parts


def _boxes(points: Floats, most: int = BOX) -> _Boxes:
    """The points in boxes of at most ``most``, from the leaves of a tree."""
    leaves, waiting = [], [cKDTree(points, leafsize=most).tree]
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
