"""Steps of DOP853 for y, v and the particles, with SciPy's error estimate and control of the step length."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.compiled import inner, kernel
from dincl.events.runge_kutta import RungeKutta, stage_point
from meanfield.kernels.field import Measure, rates
from meanfield.kernels.program import Program, evaluate_into

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

# Safety factor and bounds of the ratio of consecutive steps; the error of a step is of order 8.
SAFETY, SHRINK, GROW, EXPONENT = 0.9, 0.2, 10.0, -1 / 8
EPS = float(np.finfo(np.float64).eps)
# Unknowns besides y and v: the particles; none, as X follows from y in closed form; mean and second moment of X.
PARTICLES, CLOSED_FORM, MOMENTS = 0, 1, 2


class System(NamedTuple):
    """System z' = h(z) of z = (y, v, X), (y, v), or (y, v, rho, upper half of sigma).

    Attributes
    ----------
    measure, kind, positions, level
        particles; PARTICLES, CLOSED_FORM, where ``positions`` gives X from the constants ``level`` (Q, nx) and y, or
        MOMENTS, where 2 nx + 1 particles have the moments.
    pair
        tableau of DOP853.
    allowed, relative
        (n,): error allowed for each component, absolute and relative.
    X, U
        workspace: positions and velocities of the particles (Q, nx) at the last evaluation.
    rate, after
        workspace: rates (17, n) of the stages; z at the end of the step.
    """

    measure: Measure
    kind: int
    positions: Program
    level: Floats
    pair: RungeKutta
    allowed: Floats
    relative: Floats
    X: Floats
    U: Floats
    rate: Floats
    after: Floats


@inner
def _derivative(s: System, z: Floats, out: Floats) -> int:
    """Write z' into ``out`` (n,); return the number of particles with a wrong sign of det dg/dX."""
    ny, nx = s.measure.mass.shape[0], s.X.shape[1]
    if s.kind == CLOSED_FORM:
        evaluate_into(s.positions, s.level, s.positions.none, z[:ny], s.X)
    elif s.kind == MOMENTS:
        _points(z[2 * ny :], s.X, s.measure.weights)
    else:
        for i in range(s.X.shape[0]):
            for j in range(nx):
                s.X[i, j] = z[2 * ny + nx * i + j]
    wrong, _ = rates(s.measure, True, s.X, z, s.U, out[ny : 2 * ny])
    for k in range(ny):
        out[k] = z[ny + k]
    if s.kind == MOMENTS:
        _moment_rates(s.X, s.U, s.measure.weights, out[2 * ny :])
    elif s.kind == PARTICLES:
        for i in range(s.X.shape[0]):
            for j in range(nx):
                out[2 * ny + nx * i + j] = s.U[i, j]
    return wrong


@inner
def _points(moments: Floats, X: Floats, w: Floats) -> None:
    """Write 2 nx + 1 points with given moments: the mean, and the mean plus and minus multiples of columns l_j.

    The covariance is sum_j d_j l_j l_j^T. In trial steps d_j may be negative, and then its two points have negative
    weights; if no d_j is, the mean has the weight 0. Integrals of polynomials of degree two are exact in any case.
    """
    nx = X.shape[1]
    w[2 * nx] = 1.0
    for j in range(nx):
        X[2 * nx, j] = moments[j]
        arm, k = X[nx + j], nx
        for a in range(nx):
            arm[a] = 0.0
            for b in range(a, nx):
                if a == j:
                    X[j, b] = moments[k] - moments[a] * moments[b]
                k += 1
        for i in range(j):
            sign = 1.0 if w[i] > 0.0 else -1.0
            for b in range(j, nx):
                X[j, b] -= sign * X[nx + i, j] * X[nx + i, b]
        pivot = X[j, j]
        for b in range(j, nx):
            arm[b] = X[j, b] / np.sqrt(abs(pivot)) if pivot != 0.0 else 0.0
        w[j] = w[nx + j] = (0.5 if pivot >= 0.0 else -0.5) / nx
        w[2 * nx] -= 2 * w[j]
    for j in range(nx):
        for i in range(nx):
            arm_i = np.sqrt(float(nx)) * X[nx + j, i]
            X[j, i], X[nx + j, i] = moments[i] + arm_i, moments[i] - arm_i


@inner
def _moment_rates(X: Floats, U: Floats, w: Floats, out: Floats) -> None:
    """Write rho' = sum_q w_q U_q and the upper half of sigma' = sum_q w_q (X_q U_q^T + U_q X_q^T)."""
    nx, k = X.shape[1], X.shape[1]
    for a in range(nx):
        out[a] = 0.0
        for q in range(X.shape[0]):
            out[a] += w[q] * U[q, a]
        for b in range(a, nx):
            out[k] = 0.0
            for q in range(X.shape[0]):
                out[k] += w[q] * (X[q, a] * U[q, b] + U[q, a] * X[q, b])
            k += 1


@inner
def _stages(s: System, z: Floats, h: float, begin: int, end: int) -> int:
    wrong = 0
    for i in range(begin, end):
        stage_point(s.pair, z, s.rate, h, i, s.after)
        wrong = _derivative(s, s.after, s.rate[i])
    return wrong


@kernel
def stages(s: System, z: Floats, h: float, begin: int, end: int) -> int:
    """Evaluate some stages of a step from z; return the number of particles with a wrong sign at the last one."""
    return _stages(s, z, h, begin, end)


@kernel
def step(s: System, z: Floats, t: float, end: float, length: float) -> tuple[float, float, int, int]:
    """Make a step of at most ``length`` from z, whose rate is ``s.rate[0]``, to ``s.after``.

    Returns
    -------
    h, length, evaluations, wrong
        length of the step, 0 if it vanished; longest next step; evaluations; particles with a wrong sign at its end.
    """
    evaluations, wrong, rejected = 0, 0, False
    least = 10 * EPS * t + 1e-300
    length = max(length, least)
    while length >= least:
        h = min(length, end - t)
        wrong = _stages(s, z, h, 1, s.pair.stages + 1)
        evaluations += s.pair.stages
        error = _error(s, z, h)
        if error < 1.0:
            factor = min(GROW, SAFETY * error**EXPONENT) if error > 0.0 else GROW
            return h, h * (min(factor, 1.0) if rejected else factor), evaluations, wrong
        shrink = SAFETY * error**EXPONENT
        length, rejected = h * (shrink if shrink > SHRINK else SHRINK), True
    return 0.0, length, evaluations, wrong


@inner
def _error(s: System, z: Floats, h: float) -> float:
    """Estimate the error of a step over the allowed one, as the root of the mean square."""
    first, second, count = 0.0, 0.0, s.pair.stages + 1
    for k in range(z.size):
        one, other = 0.0, 0.0
        for i in range(count):
            one += s.pair.error[0, i] * s.rate[i, k]
            other += s.pair.error[1, i] * s.rate[i, k]
        scale = s.allowed[k] + max(abs(z[k]), abs(s.after[k])) * s.relative[k]
        first += (one / scale) ** 2
        second += (other / scale) ** 2
    if first == 0.0 and second == 0.0:
        return 0.0
    return float(abs(h) * first / np.sqrt((first + 0.01 * second) * z.size))
