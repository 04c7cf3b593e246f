"""Steps of the catch-up schemes."""

from functools import partial

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats
from dincl.steps.grid import TimeGrid
from dincl.steps.loop import Stepping, loop_of
from dincl.steps.programs import project
from dincl.system.arrays import OK, SystemArrays, evaluate, longest, system_at


@inner
def drift_step(system: SystemArrays, t: float, at: Floats, h: float, x: Floats, rate: Floats) -> int:
    """Write x + h F(t, at) into y, and F into ``rate``."""
    y = system.program.y
    code = evaluate(system.drift, system.sets.shift.shape[1], t, at, rate)
    for k in range(x.size):
        y[k] = x[k] + h * rate[k]
    return code


@inner
def catch_up(run: Stepping, t: float, h: float, x: Floats, v: Floats, after: Floats, axes: tuple[()]) -> int:
    """P_S(x + h F(t, x)) with the set at t + h, or onto its linearisation.

    The midpoint scheme goes on from there: P_{S~(m)} (x + h F(t + h/2, m)), m the middle of a step of linearised
    catch-up, which may be less accurate.
    """
    system, settings = system_at(run.system), run.settings
    z, tol = system.program.z, settings.tol
    code = drift_step(system, t, x, h, x, run.rate)
    length = h * longest(run.rate, system.sets.shift.shape[1])
    if settings.midpoint != 0:
        tol = max(tol, np.sqrt(tol * length))
    if code == OK:
        code = project(system, t + h, x, 2.0 * length, t + h, settings.exact != 0, tol)
    if code == OK and settings.midpoint != 0:
        for k in range(x.size):
            after[k] = 0.5 * (x[k] + z[k])
        code = drift_step(system, t + 0.5 * h, after, h, x, run.rate)
        if code == OK:
            code = project(system, t + 0.5 * h, after, 2.0 * length, t + h, False, settings.tol)
    for k in range(x.size):
        after[k] = z[k]
    return code


_loop = loop_of(catch_up)


@partial(kernel, references=False)
def run_catch_up(place: int, grid: TimeGrid, output: int, axes: tuple[()]) -> tuple[int, int]:
    """Make steps of a catch-up scheme, see ``dincl.steps.loop.loop_of``."""
    return _loop(place, grid, output, axes)
