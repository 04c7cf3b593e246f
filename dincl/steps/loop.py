"""Time steps of any scheme: the loop over a grid, and what is kept of it.

A scheme gives a function that makes one step, compiled by ``step_function`` and called by its address: ``step(t, x,
after, place, d, setting)`` finds its ``Stepping`` at the address ``place``, reads the state at t from it and writes the
one at t + h, h = setting[0]. So the loop is written, and compiled, once.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import c_function, inner, kernel, reader
from dincl.compiled.arrays import Floats, Offsets
from dincl.compiled.dispatchers import DRIFT
from dincl.constants import LARGEST
from dincl.drifts.functions import call_drift
from dincl.steps import sweeps as sets
from dincl.steps.sweeps import Families
from dincl.system.arrays import NOT_A_NUMBER, OK, bounded


class StepRange(NamedTuple):
    """The steps k = first ... last - 1 from t_k = origin + k end / number."""

    origin: float
    end: float
    number: int
    first: int
    last: int


class OutputArrays(NamedTuple):
    """K output times, increasing, and what is kept for each of them."""

    step: Offsets  # (K,): the step k in which the time lies, t_k < t <= t_{k+1}
    weight: Floats  # (K,): its place there, 1 at the end of the step
    x: Floats  # (K, n): the state at the time, on the straight line of the step  (1.48)
    before: Floats  # (K, n): the state at t_k
    velocity: Floats  # (K, n): and, for second-order schemes, the velocity
    filled: Offsets  # (1,): how many are kept so far


class ProjectionArrays(NamedTuple):
    """The nearest point of S(t), or of its linearisation, to y, searched from ``around``: z.

    The function at ``address`` has the signature of ``DRIFT``: it is given t, and ``question`` in place of the data.
    """

    address: int
    y: Floats  # (n,)
    around: Floats  # (n,)
    z: Floats  # (n,)
    question: Floats  # the time to which the linearisation is carried, the reach, the tolerance


class Stepping(NamedTuple):
    """A scheme that is bound to a problem."""

    place: int  # the address of the system
    families: Families
    x: Floats  # (n,): the state
    v: Floats  # (n,): the velocity, (0,) for first-order schemes
    after: Floats  # (n,): the state after a step
    rate: Floats  # (n,): velocities or forces, to write to
    setting: Floats  # the length of the step, and what the scheme was given
    output: OutputArrays
    projection: ProjectionArrays


def no_output(n: int) -> OutputArrays:
    """Output of no time, for n coordinates."""
    steps, table = np.zeros(0, dtype=np.int64), np.zeros((0, n))
    return OutputArrays(steps, np.zeros(0), table, table, table, np.zeros(1, dtype=np.int64))


# Those of a scheme that looks at all near rows together.
NO_FAMILIES = sets.EXAMPLE
_NONE = np.zeros(0)
NO_PROJECTION = ProjectionArrays(0, _NONE, _NONE, _NONE, _NONE)
stepping_at = reader(Stepping(0, NO_FAMILIES, _NONE, _NONE, _NONE, _NONE, _NONE, no_output(0), NO_PROJECTION))


def step_function(function: Callable[..., int]) -> Any:
    """Compile the step of a scheme, at top level of a file."""
    return c_function(DRIFT, function)


@kernel
def advance(place: int, step: int, grid: StepRange) -> tuple[int, int]:
    """Make steps by the function at the address ``step``; how it ended, and the step reached.

    A step that cannot be made leaves the state as it was.
    """
    run = stepping_at(place)
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
        keep(run.output, k, x, v, after)
        for i in range(v.size):
            v[i] = (after[i] - x[i]) / h
        for i in range(x.size):
            x[i] = after[i]
    return OK, grid.last


@inner
def keep(output: OutputArrays, k: int, x: Floats, v: Floats, after: Floats) -> None:
    """Keep the states at the output times of step k."""
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
