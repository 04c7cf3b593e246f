"""Time steps of any scheme in compiled code: the loop over a grid, and the states at output times.

A scheme gives a function that makes one step, compiled by ``step_function`` and called by its address: ``step(t, x,
after, place, d, setting)`` finds its ``Stepping`` at the address ``place``, reads the state at t and writes the one at
t + h, h = setting[0]. So the loop is written, and compiled, once.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import c_function, inner, kernel, reader
from dincl.compiled.arrays import Floats, Offsets
from dincl.compiled.calls import DRIFT
from dincl.constants import LARGEST
from dincl.drifts.functions import call_drift
from dincl.steps.sweeps import NO_FAMILIES, Families
from dincl.system.arrays import NOT_A_NUMBER, OK, bounded


class StepRange(NamedTuple):
    """The steps k = first ... last - 1 from t_k = origin + k end / number."""

    origin: float
    end: float
    number: int
    first: int
    last: int


class OutputArrays(NamedTuple):
    """K output times, increasing, and the states at these times."""

    step: Offsets  # (K,): the step k in which the time lies, t_k < t <= t_{k+1}
    weight: Floats  # (K,): its place there, 1 at the end of the step
    x: Floats  # (K, n): the state at the time, on the straight line of the step  (1.48)
    before: Floats  # (K, n): the state at t_k
    velocity: Floats  # (K, n): the velocity at t_k, for second-order schemes
    filled: Offsets  # (1,): how many output times were reached


class ProjectionArrays(NamedTuple):
    """A projection of y onto S(t), or onto its linearisation, searched from ``around``: z.

    The function at ``address`` has the signature of ``DRIFT``; it gets t, and ``question`` in place of the data.
    """

    address: int
    y: Floats  # (n,)
    around: Floats  # (n,)
    z: Floats  # (n,)
    question: Floats  # (4,): time to which a linearisation is carried, search radius, tolerance, 1 for S(t) itself


class Stepping(NamedTuple):
    """A scheme that is bound to a problem."""

    place: int  # the address of the system
    families: Families
    x: Floats  # (n,): the state
    v: Floats  # (n,): the velocity, (0,) for first-order schemes
    after: Floats  # (n,): the state after a step
    rate: Floats  # (n,): workspace for velocities or forces
    setting: Floats  # the length of the step, and the parameters of the scheme
    projection: ProjectionArrays


_NONE, _TABLE = np.zeros(0), np.zeros((0, 1))
NO_PROJECTION = ProjectionArrays(0, _NONE, _NONE, _NONE, _NONE)
NO_OUTPUT = OutputArrays(np.zeros(0, np.int64), _NONE, _TABLE, _TABLE, _TABLE, np.zeros(1, np.int64))
stepping_at = reader(Stepping(0, NO_FAMILIES, _NONE, _NONE, _NONE, _NONE, _NONE, NO_PROJECTION))
output_at = reader(NO_OUTPUT)


def step_function(function: Callable[..., int]) -> Any:
    """Compile the step of a scheme, at top level of a file."""
    return c_function(DRIFT, function)


@kernel
def advance(place: int, step: int, grid: StepRange, output: int) -> tuple[int, int]:
    """Make steps by the function at the address ``step``; return the code of the last one, and the step reached.

    A step that fails leaves the state as it was. ``place`` and ``output`` are addresses of Stepping and OutputArrays.
    """
    run, found = stepping_at(place), output_at(output)
    x, v, after = run.x, run.v, run.after
    h = grid.end / grid.number
    run.setting[0] = h
    for k in range(grid.first, grid.last):
        t = grid.origin + k * grid.end / grid.number
        code = call_drift(step, t, x, after, place, 0, run.setting)
        if code != OK:
            return code, k
        if not bounded(after, LARGEST):
            return NOT_A_NUMBER, k
        write_output(found, k, x, v, after)
        for i in range(v.size):
            v[i] = (after[i] - x[i]) / h
        for i in range(x.size):
            x[i] = after[i]
    return OK, grid.last


@inner
def write_output(output: OutputArrays, k: int, x: Floats, v: Floats, after: Floats) -> None:
    """Write the states at the output times of step k."""
    step, q = output.step, output.filled[0]
    found, before, velocity = output.x, output.before, output.velocity
    while q < step.size and step[q] == k:
        weight = output.weight[q]
        for i in range(x.size):
            before[q, i] = x[i]
            found[q, i] = after[i] if weight == 1.0 else x[i] + weight * (after[i] - x[i])
        for i in range(v.size):
            velocity[q, i] = v[i]
        q += 1
    output.filled[0] = q
