"""Steps of the catch-up schemes."""

from typing import Any

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats
from dincl.drifts.functions import call_drift
from dincl.steps.loop import Stepping, step_function, stepping_at
from dincl.steps.programs import project
from dincl.system.arrays import OK, SETS, evaluate, longest, system_at


@inner
def drift_step(run: Stepping, t: float, at: Floats, h: float) -> int:
    """Write x + h F(t, at) into y."""
    system, x, y, rate = system_at(run.place), run.x, run.projection.y, run.rate
    code = evaluate(system.drift, system.sets.shift.shape[1], t, at, rate)
    for k in range(x.size):
        y[k] = x[k] + h * rate[k]
    return code


@inner
def call_projection(
    run: Stepping, place: int, t: float, around: Floats, later: float, radius: float, tol: float
) -> int:
    """Project y, searched from ``around``; a linearisation is carried with its sets to a later time."""
    given, question = run.projection.around, run.projection.question
    for k in range(given.size):
        given[k] = around[k]
    question[0], question[1], question[2] = later, radius, tol
    code = call_drift(run.projection.address, t, given, run.projection.z, place, 0, question)
    return SETS if code == OK and system_at(run.place).sets.request[1] != 0.0 else code


@inner
def finish_step(run: Stepping) -> None:
    """Copy z to the state after the step."""
    after, z = run.after, run.projection.z
    for k in range(after.size):
        after[k] = z[k]


@step_function
def nearest_point(t: float, x: Any, z: Any, place: int, d: int, question: Any) -> int:
    """Project onto S(t), or onto its linearisation; see ``dincl.steps.loop.ProjectionArrays``."""
    run = stepping_at(place)
    return project(run.place, t, run.projection.around, question[1], question[0], question[3] != 0.0, question[2])


@step_function
def catch_up(t: float, x: Any, after: Any, place: int, d: int, setting: Any) -> int:
    """P_S(x + h F(t, x)) with the set at t + h; setting = h, tolerance."""
    run, h = stepping_at(place), setting[0]
    code = drift_step(run, t, run.x, h)
    if code == OK:
        radius = 2.0 * h * longest(run.rate, system_at(run.place).sets.shift.shape[1])
        code = call_projection(run, place, t + h, run.x, t + h, radius, setting[1])
    finish_step(run)
    return code


@step_function
def midpoint_catch_up(t: float, x: Any, after: Any, place: int, d: int, setting: Any) -> int:
    """P_{S~(m)} (x + h F(t + h/2, m)), m the middle of a step of linearised catch-up, which may be less accurate."""
    run, h, tol = stepping_at(place), setting[0], setting[1]
    start, middle, z = run.x, run.after, run.projection.z
    code = drift_step(run, t, start, h)
    length = h * longest(run.rate, system_at(run.place).sets.shift.shape[1])
    if code == OK:
        code = call_projection(run, place, t + h, start, t + h, 2.0 * length, max(tol, np.sqrt(tol * length)))
    for k in range(start.size):
        middle[k] = 0.5 * (start[k] + z[k])
    if code == OK:
        code = drift_step(run, t + 0.5 * h, middle, h)
    if code == OK:
        code = call_projection(run, place, t + 0.5 * h, middle, t + h, 2.0 * length, tol)
    finish_step(run)
    return code
