"""The Monge-Kantorovich (Wasserstein) distance W1, by which the thesis compares distributions of particles."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dincl import checks
from dincl.errors import InvalidProblem
from dincl.extras import needs
from meanfield.density.density import Density
from meanfield.density.panels import DEGREE, Panels
from meanfield.density.weights import checked

Floats = NDArray[np.float64]

# What W1 is of, for messages.
MEASURES = "finite points (n,) or (n, nx), Weighted points, a Density or Panels"
# Exact for a distribution function on a panel, of degree DEGREE + 1, with one point to spare for signs.
NODES, SHARES = np.polynomial.legendre.leggauss(DEGREE + 2)
# Values at the nodes -> Legendre coefficients.
TO_SERIES = (np.polynomial.legendre.legvander(NODES, DEGREE + 1) * SHARES[:, None]).T
TO_SERIES *= (np.arange(DEGREE + 2) + 0.5)[:, None]
# Pieces with a change of sign are halved until what is left of them is below rounding: a factor 4 each time.
ROUNDING, MOST_HALVINGS = 1e-17, 60
# Pieces that are integrated together, to stay in memory.
BLOCK = 100_000


class Weighted(NamedTuple):
    """The measure sum_i w_i delta(x - x_i): points (n,) or (n, nx), weights w >= 0 (n,) that sum to 1."""

    points: ArrayLike
    weights: ArrayLike


Measure: TypeAlias = ArrayLike | Weighted | Density | Panels


class _Points(NamedTuple):
    at: Floats  # (n, nx)
    mass: Floats  # (n,)


def w1(a: Measure, b: Measure) -> float:
    """W1(a, b) = sup { int phi d(a - b) : Lip(phi) <= 1 }; in one dimension int |F_a(x) - F_b(x)| dx.

    In one dimension it is exact to rounding, for points, densities, and points against densities. In two and three it
    takes points only, and is exact to 1e-11 of their diameter, which ``meanfield.transport.discrete`` proves.

    Parameters
    ----------
    a, b
        Points (n,) or (n, nx) of equal weight; ``Weighted`` points; a ``Density``; or ``Panels``, as
        ``GridMotion.density`` returns them.

    Raises
    ------
    InvalidProblem
        If a or b is something else, if their dimensions differ, or if there is a density in d >= 2: there, draw points
        by ``sample()``, or take ``Weighted(*density.nodes(n))``.
    SolveFailed
        If the linear program of exact transport was not solved.

    Notes
    -----
    (5.59), where phi is printed with values in R^nx instead of R.
    """
    one, other = _measure("a", a), _measure("b", b)
    dimensions = [1 if isinstance(m, Panels) else m.at.shape[1] for m in (one, other)]
    if dimensions[0] != dimensions[1]:
        raise InvalidProblem(f"b has {dimensions[1]} dimensions: must have those of a, {dimensions[0]}")
    if isinstance(one, Panels):
        return _panels_apart(one, other) if isinstance(other, Panels) else _points_from_panels(other, one)
    if isinstance(other, Panels):
        return _points_from_panels(one, other)
    if dimensions[0] == 1:
        return _points_apart(one, other)
    with needs("w1 of points in d >= 2", "meanfield"):
        from meanfield.transport import discrete

    return discrete.bounds(one.at, one.mass, other.at, other.mass).upper


def _measure(name: str, value: Measure) -> _Points | Panels:
    if isinstance(value, Panels):
        return value
    if isinstance(value, Density):
        if value.nx > 1:
            raise InvalidProblem(
                f"{name} is a density in {value.nx} dimensions: W1 must be taken of points there; draw them by "
                "sample(), or take Weighted(*density.nodes(n))"
            )
        return value.panels
    weighted = isinstance(value, Weighted)
    label = f"{name}.points" if weighted else name
    raw = checks.array(label, value.points if isinstance(value, Weighted) else value, MEASURES)
    points = checks.shaped(label, raw[:, None] if raw.ndim == 1 else raw, (None, None))
    if not isinstance(value, Weighted):
        return _Points(points, np.full(len(points), 1.0 / len(points)))
    weights = checked(f"{name}.weights", value.weights, len(points))
    return _Points(points, weights / weights.sum())


def _levels(points: _Points) -> tuple[Floats, Floats]:
    """Points of one dimension in increasing order, and F there (n,), the last one exactly 1."""
    order = np.argsort(points.at[:, 0], kind="stable")
    level = np.cumsum(points.mass[order])
    equal = points.mass[0] == points.mass
    if equal.all():
        level = np.arange(1, len(level) + 1) / len(level)
    level[-1] = 1.0
    return points.at[order, 0], level


def _points_apart(a: _Points, b: _Points) -> float:
    """Both distribution functions are constant between consecutive points."""
    (x, below_x), (y, below_y) = _levels(a), _levels(b)
    cuts = np.sort(np.concatenate([x, y]))
    below = [
        np.append(0.0, level)[np.searchsorted(at, cuts[:-1], side="right")]
        for at, level in ((x, below_x), (y, below_y))
    ]
    return float(np.abs(below[0] - below[1]) @ np.diff(cuts))


def _points_from_panels(points: _Points, panels: Panels) -> float:
    """Between points and edges |c - F| with constant c and monotone F: signs change at the quantile of c, if at all.

    Integrals of c - F are taken piece by piece: a difference of antiderivatives would lose their small values.
    """
    x, level = _levels(points)
    cuts = np.union1d(x, panels.edges)
    c = np.append(0.0, level)[np.searchsorted(x, cuts[:-1], side="right")]
    below = panels.distribution(cuts)
    crossed = (below[:-1] < c) & (c < below[1:])
    low, high = cuts[:-1], cuts[1:].copy()
    between = low[crossed]
    if crossed.any():
        between = np.clip(panels.quantile(c[crossed]), between, high[crossed])
    starts = np.concatenate([low, between])
    ends = np.concatenate([np.where(crossed, np.nan, high), high[crossed]])
    ends[np.flatnonzero(crossed)] = between
    c = np.concatenate([c, c[crossed]])
    # Exact for F on a panel: its degree is one more than that of the density.
    nodes, shares = np.polynomial.legendre.leggauss(panels.coefficients.shape[1] // 2 + 1)
    total = 0.0
    for begin in range(0, len(c), BLOCK):
        part = slice(begin, begin + BLOCK)
        middle, half = (starts[part] + ends[part]) / 2, (ends[part] - starts[part]) / 2
        values = panels.distribution((middle[:, None] + half[:, None] * nodes).ravel()).reshape(len(middle), -1)
        total += float(half @ np.abs((c[part, None] - values) @ shares))
    return total


def _panels_apart(a: Panels, b: Panels) -> float:
    """Between edges a polynomial: pieces are halved until the Legendre series shows a sign, or nothing is left."""
    cuts = np.union1d(a.edges, b.edges)
    low, high = cuts[:-1], cuts[1:]
    total, size = 0.0, cuts[-1] - cuts[0]
    for _ in range(MOST_HALVINGS):
        middle, half = (low + high) / 2, (high - low) / 2
        x = (middle[:, None] + half[:, None] * NODES).ravel()
        apart = (a.distribution(x) - b.distribution(x)).reshape(len(middle), -1)
        series = apart @ TO_SERIES.T
        varies = np.abs(series[:, 1:]).sum(axis=1)
        mean = np.abs(series[:, 0])
        open_ = (mean < varies) & (half * varies > ROUNDING * size)
        total += float(2 * half[~open_] @ mean[~open_])
        low, middle, high = low[open_], middle[open_], high[open_]
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        if not low.size:
            break
    return total
