"""Steps of the mean-field PDE on a line: finite volumes (MUSCL, upwind) and third-order SSP Runge-Kutta."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.compiled import inner, kernel
from meanfield.kernels.field import Measure, rates
from meanfield.kernels.program import BLOCK, Program, compute_common, run_block

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats

# Cells with less density have no outflow. Its products with speeds and time steps could be subnormal numbers, whose
# rounding error is not relative and could make a density negative.
VANISHING = 1e-250
# Each stage is a mean of the start of the step, with these weights, and an Euler step from the previous stage (Shu and
# Osher 1988). SLOPE_WEIGHTS are the resulting weights of the three slopes.
START_WEIGHTS = (0.0, 3 / 4, 1 / 3)
SLOPE_WEIGHTS = (1 / 6, 1 / 6, 2 / 3)
# Mass that the walls may hold back, or that may lie where the model is singular, before a run ends.
NEGLIGIBLE_MASS = 1e-8
# Shortest step relative to the length of the run; shorter steps are lost to rounding when added to the time.
SHORTEST = 1e-14
# Largest outflow fraction for which the next step is planned; above 1 densities may become negative.
OUTFLOW_TARGET = 0.9
# Smallest and largest ratio of consecutive steps, and the safety factor of the step length that the error allows.
SHRINK, GROW, ERROR_SAFETY = 0.2, 2.0, 0.8
# The first steps of a run say little about its length.
WARM_UP_STEPS = 200
# How an advance ended.
REACHED, TOO_SHORT, AT_WALLS, SINGULAR, NO_FORCE, NO_SPEED, TOO_MANY = range(7)


class Grid(NamedTuple):
    """Model on a grid of n cells of a line, and the state of a run.

    Attributes
    ----------
    measure, centres
        the cells as particles at their midpoints (n, 1).
    across, faces
        program of the speed Phi[y'] across faces; midpoints of the faces, walls included, (n + 1, 1).
    spacing
        width of a cell.
    f, z
        (3, n) densities and (3, 2 ny) values of (y, y'): at the start of a step, and two stages.
    speed
        (2, n + 1): speeds across the faces, at the start of a step and of a stage.
    rate
        (4, 2 ny): rates of (y, y') at the start, of the other stages, and at the end of a step.
    line
        (2, n + 1): workspace.
    """

    measure: Measure
    centres: Floats
    across: Program
    faces: Floats
    spacing: float
    f: Floats
    z: Floats
    speed: Floats
    rate: Floats
    line: Floats


@inner
def half_slope(before: float, here: float, after: float) -> float:
    """Compute half the limited slope of a cell: minmod((after - before) / 4, here - before, after - here).

    This is the monotonised central limiter. ``here`` plus or minus the result lies between the neighbours: for
    densities >= 0 both face values are >= 0 and at most 2 ``here``, also after rounding. Where the density is smooth
    and monotone, the slope is the central difference.
    """
    left, right = here - before, after - here
    size = min(abs(left), abs(right), 0.25 * abs(left + right))
    return size if left > 0.0 and right > 0.0 else -size if left < 0.0 and right < 0.0 else 0.0


@inner
def _write_fluxes(f: Floats, speed: Floats, line: Floats) -> None:
    """Write speed times upwind value at the faces into line[0]; cells at the walls have no slope."""
    n = f.size
    flux, slope = line[0], line[1]
    slope[0] = slope[n - 1] = 0.0
    for j in range(1, n - 1):
        slope[j] = half_slope(f[j - 1], f[j], f[j + 1])
    flux[0] = flux[n] = 0.0
    for j in range(1, n):
        upper = f[j - 1] + slope[j - 1] if f[j - 1] >= VANISHING else 0.0
        lower = f[j] - slope[j] if f[j] >= VANISHING else 0.0
        flux[j] = speed[j] * (lower if speed[j] < 0.0 else upper)


@inner
def euler(
    f: Floats, speed: Floats, ratio: float, start: Floats, weight: float, out: Floats, line: Floats
) -> tuple[float, float]:
    """Compute out = new + weight (start - new) with new = f - ratio times the difference of the fluxes.

    The grid has closed walls. The outflow of a cell is at most the fraction  ratio max(u_right, -u_left, 0) 2  of its
    density f, because its two face values are >= 0 and their sum is 2 f. If no fraction exceeds 1, out >= 0 for
    f, start >= 0. (The mean is written as a difference because weight and 1 - weight, rounded, need not sum to 1, and
    the mass would drift.)

    Parameters
    ----------
    f, start, out
        densities >= 0 (n,); ``out`` is overwritten and must be a different array.
    speed
        (n + 1,): speeds u across the faces.
    ratio
        time step over spacing.
    line
        (2, n + 1): workspace.

    Returns
    -------
    outflow, blocked
        largest outflow fraction of a cell; density that the walls held back, summed over the cells at the walls.
    """
    n, flux, outflow = f.size, line[0], 0.0
    _write_fluxes(f, speed, line)
    for j in range(n):
        changed = f[j] - ratio * (flux[j + 1] - flux[j])
        out[j] = changed + weight * (start[j] - changed)
    for j in range(n):
        outflow = max(outflow, 2.0 * (ratio * max(speed[j + 1], -speed[j], 0.0)))
    return outflow, ratio * (max(-speed[0], 0.0) * f[0] + max(speed[n], 0.0) * f[n - 1])


@inner
def _rate(g: Grid, fresh: bool, f: Floats, z: Floats, stage: int, rate: Floats) -> int:
    """Evaluate (5.42): write the rate of z, and the speeds across the faces at the start (0) or in a stage (1).

    The integrals (5.41) are sums over cells of average times value at the midpoint.
    """
    ny, weights = z.size // 2, g.measure.weights
    for j in range(f.size):
        weights[j] = f[j] * g.spacing
    _, wrong_mass = rates(g.measure, fresh, g.centres, z, g.measure.program.none, rate[ny:])
    if wrong_mass > NEGLIGIBLE_MASS:
        return SINGULAR
    for k in range(ny):
        rate[k] = z[ny + k]
        if not np.isfinite(rate[ny + k]):
            return NO_FORCE
    p, total, speed = g.across, 0.0, g.speed[stage]
    compute_common(p, z)
    for begin in range(0, speed.size, BLOCK):
        n = min(BLOCK, speed.size - begin)
        run_block(p, begin // BLOCK, fresh, g.faces, p.none, begin, n)
        values = p.values[begin // BLOCK, p.outputs[0]]
        for k in range(n):
            speed[begin + k] = values[k]
            total += 0.0 * values[k]
    return REACHED if total == 0.0 else NO_SPEED


@inner
def _attempt(g: Grid, dt: float) -> tuple[int, float, float]:
    """Try a step from f[0], z[0] to f[1], z[1]; outflow above 1 makes it invalid.

    Returns
    -------
    code, outflow, blocked
        REACHED or what failed; largest outflow fraction of a cell in a stage; mass that the walls held back.
    """
    largest, blocked = 0.0, 0.0
    for stage in range(3):
        weight, source, target = START_WEIGHTS[stage], (0, 1, 2)[stage], (1, 2, 1)[stage]
        speed = g.speed[0 if stage == 0 else 1]
        outflow, held = euler(g.f[source], speed, dt / g.spacing, g.f[0], weight, g.f[target], g.line)
        largest, blocked = max(largest, outflow), blocked + SLOPE_WEIGHTS[stage] * held * g.spacing
        if not largest <= 1.0:
            return REACHED, largest, blocked
        for k in range(g.z.shape[1]):
            moved = g.z[source, k] + dt * g.rate[stage, k]
            g.z[target, k] = weight * g.z[0, k] + (1 - weight) * moved
        code = _rate(g, False, g.f[target], g.z[target], 1, g.rate[stage + 1])
        if code != REACHED:
            return code, largest, blocked
    return REACHED, largest, blocked


@inner
def _error(g: Grid, dt: float, end: float, size: float) -> tuple[float, float]:
    """Compute the error of a step relative to its tolerance: 1/cells^2 of the size of y and end y' per run.

    The error is the difference from the second-order method with weights 1/2, 1/2, 0 on the same slopes. Returned is
    also the size.
    """
    ny = g.z.shape[1] // 2
    found, reached = 0.0, 0.0
    for k in range(2 * ny):
        scale = 1.0 if k < ny else end
        found = max(found, scale * abs(dt * (2 * g.rate[2, k] - g.rate[0, k] - g.rate[1, k]) / 3))
        reached = max(reached, scale * abs(g.z[1, k]))
    size = max(size, reached, found)
    return (found * end / dt * g.f.shape[1] ** 2 / size if found > 0 else 0.0), size


@kernel
def advance(
    g: Grid, now: float, until: float, end: float, dt: float, blocked: float, size: float, steps: int, most: int
) -> tuple[int, float, float, float, float, int]:
    """Step from ``now`` to exactly ``until``, where g.f[0] and g.z[0] are the state; ``end`` ends the run.

    At the start, to which no steps lead, the rate is evaluated first.

    Returns
    -------
    code, now, dt, blocked, size, steps
        how it ended, and the arguments of the next advance: length of the next step, mass that the walls have held
        back, largest size of y and end y' so far, steps so far.
    """
    if steps == 0:
        code = _rate(g, True, g.f[0], g.z[0], 0, g.rate[0])
        if code != REACHED:
            return code, now, dt, blocked, size, steps
    while now < until:
        if steps >= min(most, WARM_UP_STEPS) and now / end < (steps / most) ** 2:
            return TOO_MANY, now, dt, blocked, size, steps
        count = np.ceil((until - now) / max(dt, SHORTEST * end))
        h = (until - now) / count
        steps += 1
        code, outflow, held = _attempt(g, h)
        if code != REACHED:
            if SHRINK * h < SHORTEST * end:
                return code, now, dt, blocked, size, steps
            dt = SHRINK * h
            continue
        error, valid = 0.0, outflow <= 1.0
        if valid:
            error, size = _error(g, h, end, size)
        dt = h * _growth(outflow, error)
        if not (valid and error <= 1.0):
            if dt < SHORTEST * end:
                return TOO_SHORT, now, dt, blocked, size, steps
            continue
        g.f[0], g.z[0], g.rate[0] = g.f[1], g.z[1], g.rate[3]
        g.speed[0] = g.speed[1]
        blocked += held
        if blocked > NEGLIGIBLE_MASS:
            return AT_WALLS, now, dt, blocked, size, steps
        now = until if count == 1.0 else now + h
    return REACHED, now, dt, blocked, size, steps


@inner
def _growth(outflow: float, error: float) -> float:
    """Compute the ratio of the next step to this step."""
    by_outflow = OUTFLOW_TARGET / max(outflow, OUTFLOW_TARGET / GROW)
    by_error = ERROR_SAFETY / np.sqrt(max(error, (ERROR_SAFETY / GROW) ** 2))
    return float(max(SHRINK, min(by_outflow, by_error)))
