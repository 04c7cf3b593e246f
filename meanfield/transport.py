"""Monge-Kantorovich (Wasserstein) distance W1, with which the thesis compares distributions of particles."""

from __future__ import annotations

import warnings
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist

from dincl import checks
from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.status import Status
from meanfield.density import DEGREE, Density, Panels
from meanfield.solvers.result import SolveFailed

Floats = NDArray[np.float64]

# Arguments of W1, for messages.
MEASURES = "finite points (n,) or (n, nx), Weighted points, a Density or Panels"
# Weights that come from a sum of many terms may miss 1 by this much.
SUM_TOLERANCE = 1e-10
# Gauss points on a panel, where distribution functions have degree DEGREE + 1; the series needs as many coefficients.
SERIES_NODES, SERIES_WEIGHTS = np.polynomial.legendre.leggauss(DEGREE + 2)
# Maps values at the nodes to Legendre coefficients.
TO_SERIES = (np.polynomial.legendre.legvander(SERIES_NODES, DEGREE + 1) * SERIES_WEIGHTS[:, None]).T
TO_SERIES *= (np.arange(DEGREE + 2) + 0.5)[:, None]
# Pieces with a change of sign are halved until their integral, which falls by a factor 4 each time, is below rounding.
NEGLIGIBLE_PIECE, MAX_PIECE_HALVINGS = 1e-17, 60
# Pieces that are integrated together, and rows of distances that are looked at together, for memory.
PIECES_PER_BLOCK, ROWS_PER_BLOCK = 100_000, 256
# Pairs of points in two and three dimensions up to which POT has the matrix of their distances: five matrices at once,
# 1 GB. Above, it computes distances as it needs them, which takes 1.4 to 1.7 times as long and no memory; 10^8 pairs
# take half a minute.
MATRIX_PAIRS, MAX_PAIRS = 25_000_000, 1_000_000_000
# POT's default limit of 1e5 pivots is reached at a thousand points; the simplex method terminates without a limit.
MAX_PIVOTS = 10**9
# Largest gap between cost and lower bound, in units of the largest distance: the simplex method's accuracy is 1e-12.
GAP = 1e-11


class Weighted(NamedTuple):
    """Measure sum_i w_i delta(x - x_i): points (n,) or (n, nx), weights w >= 0 (n,) that sum to 1."""

    points: ArrayLike
    weights: ArrayLike


Measure: TypeAlias = ArrayLike | Weighted | Density | Panels


class _Points(NamedTuple):
    at: Floats  # (n, nx)
    mass: Floats  # (n,)


def w1(a: Measure, b: Measure) -> float:
    """Compute W1(a, b) = sup { int phi d(a - b) : Lip(phi) <= 1 }; in one dimension int |F_a(x) - F_b(x)| dx.

    In one dimension the value is exact to rounding, for points and densities. In two and three dimensions a and b must
    be points; the value is exact to 1e-11 of their diameter, which the dual variables of POT prove.

    Parameters
    ----------
    a, b
        points (n,) or (n, nx) of equal weight; ``Weighted`` points; a ``Density``; or ``Panels``, as
        ``GridMotion.density`` returns them.

    Raises
    ------
    InvalidProblem
        if a or b is no measure, their dimensions differ, or one is a density in two or three dimensions: draw points by
        ``sample()`` then, or use ``Weighted(*density.nodes(n))``; or if two and three dimensions have more than 1e9
        pairs of points.
    SolveFailed
        if the linear program of exact transport was not solved.

    Notes
    -----
    (5.59), where phi is printed with values in R^nx instead of R.
    """
    one, other = _measure("a", a), _measure("b", b)
    dimensions = [1 if isinstance(m, Panels) else m.at.shape[1] for m in (one, other)]
    if dimensions[0] != dimensions[1]:
        raise InvalidProblem(f"b has {dimensions[1]} dimensions: must have as many as a, {dimensions[0]}")
    if isinstance(one, Panels):
        return _w1_panels(one, other) if isinstance(other, Panels) else _w1_points_panels(other, one)
    if isinstance(other, Panels):
        return _w1_points_panels(one, other)
    if dimensions[0] == 1:
        return _w1_points(one, other)
    return _w1_space(one, other)


def _measure(name: str, value: Measure) -> _Points | Panels:
    if isinstance(value, Panels):
        return value
    if isinstance(value, Density):
        if value.nx > 1:
            raise InvalidProblem(
                f"{name} is a density in {value.nx} dimensions: must be points; draw them by sample(), or use "
                "Weighted(*density.nodes(n))"
            )
        return value.panels
    weighted = isinstance(value, Weighted)
    label = f"{name}.points" if weighted else name
    raw = checks.array(label, value.points if isinstance(value, Weighted) else value, MEASURES)
    points = checks.shaped(label, raw[:, None] if raw.ndim == 1 else raw, (None, None))
    if not isinstance(value, Weighted):
        return _Points(points, np.full(len(points), 1.0 / len(points)))
    weights = checks.shaped(f"{name}.weights", value.weights, (len(points),))
    if (weights < 0).any() or abs(weights.sum() - 1.0) > SUM_TOLERANCE:
        found = f"least {weights.min():.3g}, sum {weights.sum():.12g}"
        raise InvalidProblem(f"{name}.weights ({found}): must be >= 0 and sum to 1")
    return _Points(points, weights / weights.sum())


def _levels(points: _Points) -> tuple[Floats, Floats]:
    """Sort points of one dimension; return them and F at them (n,), the last value exactly 1."""
    order = np.argsort(points.at[:, 0], kind="stable")
    level = np.cumsum(points.mass[order])
    equal = points.mass[0] == points.mass
    if equal.all():
        level = np.arange(1, len(level) + 1) / len(level)
    level[-1] = 1.0
    return points.at[order, 0], level


def _w1_points(a: _Points, b: _Points) -> float:
    """Integrate |F_a - F_b|, which is constant between consecutive points.

    Equal numbers of equal weights are matched in their order.
    """
    if len(a.mass) == len(b.mass) and (a.mass == a.mass[0]).all() and (b.mass == a.mass[0]).all():
        return float(np.abs(np.sort(a.at[:, 0]) - np.sort(b.at[:, 0])).mean())
    (x, F_x), (y, F_y) = _levels(a), _levels(b)
    cuts = np.sort(np.concatenate([x, y]))
    F_a, F_b = (
        np.append(0.0, level)[np.searchsorted(at, cuts[:-1], side="right")] for at, level in ((x, F_x), (y, F_y))
    )
    return float(np.abs(F_a - F_b) @ np.diff(cuts))


def _w1_points_panels(points: _Points, panels: Panels) -> float:
    """Integrate |c - F|, with constant c and monotone F between consecutive points and edges.

    The sign of c - F changes at most once, at the quantile of c. Integrals are computed piece by piece, because small
    values would be lost in a difference of antiderivatives.
    """
    x, level = _levels(points)
    cuts = np.union1d(x, panels.edges)
    c = np.append(0.0, level)[np.searchsorted(x, cuts[:-1], side="right")]
    F = panels.distribution(cuts)
    crossed = (F[:-1] < c) & (c < F[1:])
    low, high = cuts[:-1], cuts[1:].copy()
    between = low[crossed]
    if crossed.any():
        between = np.clip(panels.quantile(c[crossed]), between, high[crossed])
    starts = np.concatenate([low, between])
    ends = np.concatenate([np.where(crossed, np.nan, high), high[crossed]])
    ends[np.flatnonzero(crossed)] = between
    c = np.concatenate([c, c[crossed]])
    # Exact for F on a panel, whose degree is one more than the degree of the density.
    nodes, weights = np.polynomial.legendre.leggauss(panels.coefficients.shape[1] // 2 + 1)
    total = 0.0
    for begin in range(0, len(c), PIECES_PER_BLOCK):
        part = slice(begin, begin + PIECES_PER_BLOCK)
        middle, half = (starts[part] + ends[part]) / 2, (ends[part] - starts[part]) / 2
        values = panels.distribution((middle[:, None] + half[:, None] * nodes).ravel()).reshape(len(middle), -1)
        total += float(half @ np.abs((c[part, None] - values) @ weights))
    return total


def _w1_panels(a: Panels, b: Panels) -> float:
    """Integrate |F_a - F_b|, a polynomial between edges.

    Pieces are halved until the Legendre series proves that the sign is constant, or the integral is negligible.
    """
    cuts = np.union1d(a.edges, b.edges)
    low, high = cuts[:-1], cuts[1:]
    total, size = 0.0, cuts[-1] - cuts[0]
    for _ in range(MAX_PIECE_HALVINGS):
        middle, half = (low + high) / 2, (high - low) / 2
        x = (middle[:, None] + half[:, None] * SERIES_NODES).ravel()
        difference = (a.distribution(x) - b.distribution(x)).reshape(len(middle), -1)
        series = difference @ TO_SERIES.T
        variation = np.abs(series[:, 1:]).sum(axis=1)
        mean = np.abs(series[:, 0])
        undecided = (mean < variation) & (half * variation > NEGLIGIBLE_PIECE * size)
        total += float(2 * half[~undecided] @ mean[~undecided])
        low, middle, high = low[undecided], middle[undecided], high[undecided]
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        if not low.size:
            break
    return total


def _w1_space(a: _Points, b: _Points) -> float:
    """Solve the linear program  min sum_ij P_ij |x_i - y_j|  over all plans by POT.

    Its dual variables u, v are made feasible by lowering u: their value is a lower bound, the cost an upper one.
    """
    with needs("w1 of points in d >= 2", "transport"):
        import ot
    pairs = len(a.at) * len(b.at)
    if pairs > MAX_PAIRS:
        raise InvalidProblem(
            f"{len(a.at)} and {len(b.at)} points: must be at most {MAX_PAIRS} pairs for exact transport in d >= 2"
        )
    a, b = (_Points(one.at[one.mass > 0], one.mass[one.mass > 0]) for one in (a, b))
    middle = b.at.mean(axis=0)
    x, y = a.at - middle, b.at - middle
    how = {"numItermax": MAX_PIVOTS, "log": True, "center_dual": False}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the same message is in the log
        if pairs <= MATRIX_PAIRS:
            cost, log = ot.emd2(a.mass, b.mass, cdist(x, y), **how)
        else:
            cost, log = ot.emd2_lazy(x, y, a.mass, b.mass, metric="euclidean", return_matrix=False, **how)
    u, v = np.asarray(log["u"]), np.asarray(log["v"])
    lower, size = float(b.mass @ v), 0.0
    for begin in range(0, len(x), ROWS_PER_BLOCK):
        part = slice(begin, begin + ROWS_PER_BLOCK)
        costs = cdist(x[part], y)
        size = max(size, float(costs.max()))
        lower += float(a.mass[part] @ (u[part] + np.minimum((costs - u[part, None] - v).min(axis=1), 0.0)))
    if log["warning"] is not None or not cost - lower <= GAP * size:
        raise SolveFailed(Status.NOT_CONVERGED, f"(POT: {log['warning']}, gap {cost - lower:.1e})", None)
    return float(cost)
