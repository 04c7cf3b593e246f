"""Steps of DOP853 for y, v and the particles, with SciPy's error estimate and control of the step length."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.compiled import inner, kernel
from dincl.events.runge_kutta import RungeKutta, stage_point
from meanfield.kernels.field import Measure, rates

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats

# Safety factor and bounds of the ratio of consecutive steps; the error of a step is of order 8.
SAFETY, SHRINK, GROW, EXPONENT = 0.9, 0.2, 10.0, -1 / 8
EPS = float(np.finfo(np.float64).eps)


class System(NamedTuple):
    """System z' = h(z) of z = (y, v, X).

    Attributes
    ----------
    measure
        particles.
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
    for i in range(s.X.shape[0]):
        for j in range(nx):
            s.X[i, j] = z[2 * ny + nx * i + j]
    wrong, _ = rates(s.measure, True, s.X, z, s.U, out[ny : 2 * ny])
    for k in range(ny):
        out[k] = z[ny + k]
    for i in range(s.X.shape[0]):
        for j in range(nx):
            out[2 * ny + nx * i + j] = s.U[i, j]
    return wrong


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
