"""Reference implementation of position based dynamics and of the penalty method: one row after another.

Rows are looked at one by one, all of them, with Python floats in the order of the kernels, so that both agree bit for
bit; those of sets that move or that Python evaluates agree up to rounding.
"""

import math

import numpy as np

import dincl
from dincl.rows import AffineRows, CustomSweep, DiscPairs, DistanceRows, HeightRows
from dincl.steps.grid import StepState


class Coincident(Exception):
    """A row that is violated has no direction."""


def sweep(problem, t, x):
    """Project x (N, d) onto one row after another, in place, as the sets are at time t; the number of corrections."""
    count = 0
    for constraint in problem.constraints:
        shift = constraint.displacement(t, x.shape[1])
        swept = constraint.at(0.0).sweep_rows(x)
        if constraint.timed and shift is None and not isinstance(swept, CustomSweep):
            swept = constraint.rows_at(t, swept, x.shape)
        if isinstance(swept, DiscPairs):
            count += sum(onto_pair(x, i, j, length) for i, j, length in pairs(swept))
            continue
        if shift is not None:
            x -= shift
        if isinstance(swept, HeightRows):
            count += sum(onto_wall(x[i], swept.normal, float(b)) for i, b in enumerate(swept.bound))
        elif isinstance(swept, CustomSweep):
            work = dincl.Work()
            swept.sweep(t, x, work)
            count += work.constraint_projections
        elif isinstance(swept, DistanceRows):
            count += sum(onto_distance(x, swept, k) for k in range(len(swept)))
        elif isinstance(swept, AffineRows):
            count += sum(onto_affine(x.reshape(-1), swept, k) for k in range(len(swept)))
        else:
            count += sum(onto_curved(x, swept.take(np.arange(len(swept)) == k)) for k in range(len(swept)))
        if shift is not None:
            x += shift
    return count


def pairs(discs):
    """All pairs in their order, with the least distance of their centres."""
    among = range(len(discs.radius)) if discs.among is None else discs.among.tolist()
    for i, one in enumerate(among):
        for j in range(i):
            yield one, among[j], float(discs.radius[i] + discs.radius[j])


def square_distance(a, b):
    """Sum (a_k - b_k)^2 over the axes in their order."""
    total = 0.0  # sum() would compensate for rounding, from Python 3.12 on
    for p, q in zip(a.tolist(), b.tolist(), strict=True):
        total += (p - q) * (p - q)
    return total


def onto_pair(x, i, j, length, sign=1.0):
    """Half of the violation each: with e = (X_i - X_j) / |X_i - X_j|."""
    square = square_distance(x[i], x[j])
    if sign * (square - length * length) >= 0.0:
        return 0
    move = share_of(square, length) * (x[i] - x[j])
    x[i] += move
    x[j] -= move
    return 1


def share_of(square, length):
    """Half of the violation over the distance."""
    inverse = 0.5 * length / square if square > 0.0 else math.inf
    if inverse == math.inf:
        raise Coincident
    return math.sqrt(square) * inverse - 0.5


def onto_distance(x, rows, k):
    """Both ends half the way, or the free end the whole way from a fixed point."""
    i, length = int(rows.i[k]), float(rows.length[k])
    if rows.j is not None:
        return onto_pair(x, i, int(rows.j[k]), length, rows.sign)
    square = square_distance(x[i], rows.anchor[k])
    if rows.sign * (square - length * length) >= 0.0:
        return 0
    x[i] += 2.0 * share_of(square, length) * (x[i] - rows.anchor[k])
    return 1


def onto_wall(x, normal, bound):
    """Along the unit normal."""
    height = 0.0
    for n, p in zip(normal.tolist(), x.tolist(), strict=True):
        height += n * p
    if not height < bound:
        return 0
    x += (bound - height) * normal
    return 1


def onto_affine(x, rows, k):
    """x += (b - a . x) a / |a|^2."""
    entries = slice(rows.matrix.indptr[k], rows.matrix.indptr[k + 1])
    places, row, height = rows.matrix.indices[entries], rows.matrix.data[entries], 0.0
    for a, p in zip(row.tolist(), x[places].tolist(), strict=True):
        height += a * p
    if not height < rows.bound[k]:
        return 0
    x[places] += (float(rows.bound[k]) - height) / float(rows.tabulated(1).numbers["square"][k]) * row
    return 1


def onto_curved(x, row):
    """The fixed point x = y + multiplier grad g(x), g(x) = 0, by plain iteration."""
    if row.values(x)[0] >= 0:
        return 0
    y, last = x.copy(), np.inf
    while np.abs(x - last).max() > 1e-13:
        gradient = row.jacobian(x).toarray()[0]
        lack = gradient @ (x - y).ravel() - row.values(x)[0]
        last = x.copy()
        x[:] = y + (max(lack, 0.0) / (gradient @ gradient) * gradient).reshape(y.shape)
    return 1


class SweepingStepper(dincl.Stepper):
    """PBD, or SecondOrderPBD where there is a velocity at the start."""

    def __init__(self, problem, sweeps, v0=None):
        super().__init__(problem)
        self._sweeps, self._v0 = sweeps, v0

    def start(self):
        return StepState(self.problem.x0, self._v0)

    def step(self, t, h, state):
        rate = self.velocity(t, state.x)
        x = state.x + h * (rate if state.v is None else state.v + h * rate)
        for _ in range(self._sweeps):
            self.work.constraint_projections += sweep(self.problem, t + h, x)
        return StepState(x, None if state.v is None else (x - state.x) / h)


class PushingStepper(dincl.Stepper):
    """The penalty method."""

    def __init__(self, problem, scheme):
        super().__init__(problem)
        self._scheme = scheme

    def step(self, t, h, state):
        velocity, rows = self.velocity(t, state.x), self.problem.rows_within(t, state.x, np.inf)
        overlap = np.maximum(-rows.values(state.x), 0.0)
        push = overlap if self._scheme.exponent == 2 else np.sign(overlap)
        force = (push @ rows.jacobian(state.x)).reshape(state.x.shape)
        return StepState(state.x + h * (velocity + self._scheme.strength * force))
