"""Steps of the catch-up schemes."""

from functools import partial

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats
from dincl.steps.grid import TimeGrid
from dincl.steps.loop import Stepping, loop_of
from dincl.steps.programs import project_onto_linearisation, project_onto_set
from dincl.system.arrays import OK, SystemArrays, evaluate, longest, system_at


@inner
def drift_step(system: SystemArrays, t: float, at: Floats, h: float, x: Floats, rate: Floats) -> int:
    """Write x + h F(t, at) into y, and F into ``rate``."""
    y = system.program.y
    code = evaluate(system, t, at, rate)
    for k in range(x.size):
        y[k] = x[k] + h * rate[k]
    return code


@inner
def catch_up(run: Stepping, t: float, h: float, x: Floats, v: Floats, after: Floats, axes: tuple[()]) -> int:
    """P_S(x + h F(t, x)) with the set at t + h."""
    system = system_at(run.system)
    code = drift_step(system, t, x, h, x, run.rate)
    length = h * longest(run.rate, system.sets.shift.shape[1])
    if code == OK:
        code = project_onto_set(system, t + h, x, 2.0 * length, t + h, run.settings.tol)
    for k in range(x.size):
        after[k] = system.program.z[k]
    return int(code)


@inner
def linearised(run: Stepping, t: float, h: float, x: Floats, v: Floats, after: Floats, axes: tuple[()]) -> int:
    """The same for the linearisation of the set.

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
        code = project_onto_linearisation(system, t + h, x, 2.0 * length, t + h, tol)
    if code == OK and settings.midpoint != 0:
        for k in range(x.size):
            after[k] = 0.5 * (x[k] + z[k])
        code = drift_step(system, t + 0.5 * h, after, h, x, run.rate)
        if code == OK:
            code = project_onto_linearisation(system, t + 0.5 * h, after, 2.0 * length, t + h, settings.tol)
    for k in range(x.size):
        after[k] = z[k]
    return int(code)


_catch_up, _linearised = loop_of(catch_up), loop_of(linearised)


@partial(kernel, references=False)
def run_catch_up(place: int, grid: TimeGrid, output: int, axes: tuple[()]) -> tuple[int, int]:
    """Make steps of catch-up, see ``dincl.steps.loop.loop_of``."""
    return _catch_up(place, grid, output, axes)


@partial(kernel, references=False)
def run_linearised(place: int, grid: TimeGrid, output: int, axes: tuple[()]) -> tuple[int, int]:
    """Make steps of linearised or midpoint catch-up."""
    return _linearised(place, grid, output, axes)
