"""Time steps of any scheme in compiled code: the loop over a grid, and the states at output times.

A scheme is an inlined function ``step(run, t, h, x, v, after, axes)`` that reads the state at t and writes the one at
t + h; ``axes`` is a tuple of length d, or empty for a scheme that need not know d when it is compiled. Each scheme has
a kernel that runs its own loop, made by ``loop_of``, so that compiled code calls a step by its name.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import inner, reader
from dincl.compiled.arrays import Floats, Offsets, Table, empty
from dincl.constants import LARGEST
from dincl.steps.grid import TimeGrid
from dincl.system.arrays import NOT_A_NUMBER, OK, bounded

# Forms of families: discs, whose near pairs are listed; a wall for all particles, for d <= 3; rows of the table.
DISCS, WALL, ROWS = range(3)


class Families(NamedTuple):
    """Rows of each constraint of the problem, in one of three forms."""

    form: Offsets
    first: Offsets  # the rows of a family are first ... last - 1 of the table; those of a wall begin in ``bound``
    last: Offsets
    pairs: Offsets  # the address of the PairList of discs
    normal: Table  # (families, d): of walls
    bound: Floats  # least allowed heights of all particles over walls [length]
    multiplier: Floats  # of all particles at walls, or (0,) for schemes that have none
    corrections: Offsets  # (1,): by rows of walls and of the table
    offending: Offsets  # (3,): after a failure the family, and its row or two discs
    visit_rows: int  # the address of ``project_rows`` or ``correct_rows``, 0 without rows of the table


class OutputArrays(NamedTuple):
    """K output times, increasing, and the states at these times."""

    step: Offsets  # (K,): the step k in which the time lies, t_k < t <= t_{k+1}
    weight: Floats  # (K,): its place there, 1 at the end of the step
    x: Table  # (K, n): the state at the time, on the straight line of the step  (1.48)
    before: Table  # (K, n): the state at t_k
    velocity: Table  # (K, n): the velocity at t_k, for second-order schemes
    filled: Offsets  # (1,): how many output times were reached


class Settings(NamedTuple):
    """Parameters of the schemes; each reads its own."""

    sweeps: int = 1
    compliance: float = 0.0  # [time]
    strength: float = 0.0
    exponent: int = 2
    tol: float = 0.0  # of projections [length]
    midpoint: int = 0


class Stepping(NamedTuple):
    """A scheme that is bound to a problem."""

    system: int  # the address of its SystemArrays
    families: Families
    x: Floats  # (n,): the state
    v: Floats  # (n,): the velocity, (0,) for first-order schemes
    after: Floats  # (n,): the state after a step
    rate: Floats  # (n,): workspace for velocities or forces
    repeats: Offsets  # (1,): 1 if a step of sweeps is made again with more room: F(t, x) is in ``rate``
    settings: Settings


# Of a scheme that makes no sweeps.
NO_FAMILIES: Families = empty(Families)
NO_OUTPUT: OutputArrays = empty(OutputArrays)._replace(filled=np.zeros(1, np.int64))
stepping_at = reader(empty(Stepping))
output_at = reader(NO_OUTPUT)


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


def loop_of(step: Callable[..., int]) -> Callable[..., tuple[int, int]]:
    """Make the loop over the steps of a scheme, for its kernel."""

    @inner
    def run_steps(place: int, grid: TimeGrid, output: int, axes: Any) -> tuple[int, int]:
        """Make the steps of a grid; return the code of the last one, and the step reached.

        A step that fails leaves the state as it was. ``place`` and ``output`` are addresses of Stepping and
        OutputArrays.
        """
        run, found = stepping_at(place), output_at(output)
        # The arrays of the states before and after a step change places.
        x, v, after, code, reached = run.x, run.v, run.after, OK, grid.last
        h = grid.t_end / grid.steps
        for k in range(grid.first, grid.last):
            t = grid.origin + k * grid.t_end / grid.steps
            code = step(run, t, h, x, v, after, axes)
            if code == OK and not bounded(after, LARGEST):
                code = NOT_A_NUMBER
            if code != OK:
                reached = k
                break
            write_output(found, k, x, v, after)
            for i in range(v.size):
                v[i] = (after[i] - x[i]) / h
            x, after = after, x
        if (reached - grid.first) % 2 == 1:
            for i in range(x.size):
                run.x[i] = x[i]
        return code, reached

    return run_steps
