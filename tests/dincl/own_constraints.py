"""Constraints as a user would write them, outside of the package: with as little as is needed, and with more."""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

import dincl
from dincl.matrices import from_equal_rows
from dincl.rows import FormulaRows, RowsOfOneKind
from dincl.rows.formulas import row_formula


@dataclass(frozen=True, eq=False)
class InEllipse(dincl.DifferentiableConstraint):
    """g_i(x) = 1 - sum_k (X_ik / axes_k)^2 >= 0: values and Jacobian, and nothing else."""

    axes: tuple[float, ...]

    def values(self, x):
        return 1 - ((x / self.axes) ** 2).sum(axis=1)

    def jacobian(self, x):
        rows = np.zeros((len(x), *x.shape))
        each = np.arange(len(x))
        rows[each, each] = -2 * x / np.square(self.axes)
        return rows


@dataclass(frozen=True, eq=False)
class EllipseRows(RowsOfOneKind):
    """The same as a kind of row of its own: particles ``i`` (m,)."""

    i: np.ndarray
    axes: np.ndarray

    def __len__(self):
        return len(self.i)

    def values(self, x):
        return 1 - ((x[self.i] / self.axes) ** 2).sum(axis=1)

    def jacobian(self, x):
        d = x.shape[1]
        gradients = -2 * x[self.i] / np.square(self.axes)
        return from_equal_rows(d * self.i[:, None] + np.arange(d), gradients, x.size)

    def take(self, keep):
        return replace(self, i=self.i[keep])

    def keys(self):
        return np.column_stack((self.i, self.i))

    def label(self, k, d):
        return f"particle {self.i[k]}"


@dataclass(frozen=True, eq=False)
class InEllipseByRows(InEllipse):
    """It selects rows of its own kind, and only those of particles that can get out."""

    def select(self, x, search_radius):
        rows = EllipseRows(np.arange(len(x)), np.asarray(self.axes))
        # |X / axes| grows by at most search_radius / min(axes).
        farthest = np.sqrt(1 - rows.values(x)) + search_radius / min(self.axes)
        return rows.take(farthest >= 1)


@dataclass(frozen=True, eq=False)
class InBall(dincl.DifferentiableConstraint):
    """What dincl.InsideBall is, around the origin."""

    distance: float

    def values(self, x):
        return self.distance - np.linalg.norm(x, axis=1)

    def jacobian(self, x):
        rows = np.zeros((len(x), *x.shape))
        each = np.arange(len(x))
        rows[each, each] = -x / np.linalg.norm(x, axis=1, keepdims=True)
        return rows


@row_formula
def bend(t, x, out, entries, d, parameter):
    """g = c - cos(angle at the second of three particles)."""
    first = second = along = 0.0
    for k in range(d):
        u, v = x[k] - x[d + k], x[2 * d + k] - x[d + k]
        first, second, along = first + u * u, second + v * v, along + u * v
    if first == 0.0 or second == 0.0:
        return 1
    lengths = sqrt(first * second)
    for k in range(d):
        u, v = x[k] - x[d + k], x[2 * d + k] - x[d + k]
        out[k] = (along * u / first - v) / lengths
        out[2 * d + k] = (along * v / second - u) / lengths
        out[d + k] = -out[k] - out[2 * d + k]
    out[entries] = parameter[0] - along / lengths
    return 0


@dataclass(frozen=True, eq=False)
class AngleLimit(dincl.Constraint):
    """The cosines of the angles between three neighbours of a chain are at most ``cosine``: a compiled formula."""

    chain: tuple[int, ...]
    cosine: float

    @property
    def triples(self):
        return np.column_stack((self.chain[:-2], self.chain[1:-1], self.chain[2:]))

    def select(self, x, search_radius):
        return FormulaRows(bend, self.triples, np.full((len(self.triples), 1), self.cosine))


@dataclass(frozen=True, eq=False)
class AngleLimitByHand(dincl.DifferentiableConstraint):
    """The same in NumPy, with complex steps for the Jacobian."""

    like: AngleLimit

    def values(self, x):
        i, j, k = self.like.triples.T
        u, v = x[i] - x[j], x[k] - x[j]
        return self.like.cosine - (u * v).sum(axis=1) / np.sqrt((u * u).sum(axis=1) * (v * v).sum(axis=1))

    def jacobian(self, x):
        steps = 1e-30j * np.eye(x.size).reshape(-1, *x.shape)
        return np.array([self.values(x + step).imag for step in steps]).T / 1e-30
