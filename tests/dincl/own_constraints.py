"""Constraints as a user would write them, outside of the package: with as little as is needed, and with more."""

from dataclasses import dataclass, replace

import numpy as np

import dincl
from dincl.matrices import from_equal_rows
from dincl.rows import RowsOfOneKind


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
