"""Arrays and codes that all compiled steps share: the drift, the sets, programs, and how a step ends."""

from typing import NamedTuple

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats, Offsets, Table, empty
from dincl.compiled.structs import reader
from dincl.drifts.functions import velocity
from dincl.rows.candidates import CandidateRows
from dincl.rows.table import GRADIENTS, RowTable, Sets, call_python, gap
from dincl.solvers.active_set import LeastDistance
from dincl.solvers.envelope_factor import EnvelopeFactor

# How steps end; the first ones are those of ``active_set.nearest``.
OK, UNMET, CYCLES, DRIFT, SETS, COINCIDENT, TOO_FAR, MISSED, NOT_A_NUMBER, SINGULAR = range(10)
FLAT, UNSETTLED, PYTHON, WEDGE, STALE, NEED_ROOM, REPEAT = range(10, 17)


class Drift(NamedTuple):
    """The drift at ``address``, see ``dincl.drifts.functions.velocity``; after a failure ``failed`` has t, x and F.

    ``unit`` has the units of time, length and velocity of the run, powers of two, in the units of the function.
    """

    address: int
    data: Floats
    calls: Offsets  # (2,): their number, and the code of the last failure
    failed: Floats  # (1 + 2 n,)
    unit: Floats  # (3,)
    point: Floats  # (n,): x in the units of the function


class Curvature(NamedTuple):
    """Workspace of projections onto curved sets, see ``dincl.steps.programs.bend``; n coordinates, m rows."""

    y: Floats  # (n,): the point that is projected, while a program has another one
    last: Floats  # (n,): where the rows were linearised last
    step: Floats  # (n,): from there to the point reached
    root: Floats  # (n,): roots of the diagonal Hessian; a program has coordinates times these
    slope: Floats  # (m,): how far the step goes along the last gradient of each row
    largest: Floats  # (1,): the largest entry of the Hessian in this search


def curvature(n: int, m: int) -> Curvature:
    """Allocate the workspace."""
    return Curvature(np.zeros(n), np.zeros(n), np.zeros(n), np.ones(n), np.zeros(m), np.ones(1))


class SystemArrays(NamedTuple):
    """A problem and workspace; ``velocity`` is the last value of the drift, ``offending`` the row of a failure."""

    rows: RowTable
    sets: Sets
    near: CandidateRows
    program: LeastDistance
    factor: EnvelopeFactor
    drift: Drift
    velocity: Floats  # (n,)
    middle: Floats  # (n,)
    move: Table  # (families, d)
    offending: Offsets  # (1,)
    curvature: Curvature


# An example, for its types.
SYSTEM: SystemArrays = empty(SystemArrays)
system_at = reader(SYSTEM)


@inner
def evaluate(system: SystemArrays, t: float, x: Floats, out: Floats) -> int:
    """Write F(t, x), finite, into ``out``: OK or DRIFT."""
    drift, d = system.drift, system.sets.shift.shape[1]
    drift.calls[0] += 1
    time, length, speed, point = drift.unit[0] * t, drift.unit[1], drift.unit[2], x
    if length != 1.0:
        point = drift.point
        for k in range(x.size):
            point[k] = length * x[k]
    code = velocity(drift.address, time, point, out, x.size // d, d, drift.data)
    if code != OK:
        drift.failed[0], drift.calls[1] = time, code
        for k in range(x.size):
            drift.failed[1 + k], drift.failed[1 + x.size + k] = point[k], out[k]
        return DRIFT
    if speed != 1.0:
        for k in range(x.size):
            out[k] /= speed
    return OK


@inner
def bounded(x: Floats, most: float) -> bool:
    """Return whether all numbers are finite and none is larger than ``most``."""
    wrong = 0
    for k in range(x.size):
        wrong += not abs(x[k]) <= most
    return wrong == 0


@inner
def farthest(x: Floats, y: Floats, d: int) -> float:
    """Compute max_i |X_i - Y_i|."""
    largest = 0.0
    for i in range(0, x.size, d):
        square = 0.0
        for k in range(d):
            square += (x[i + k] - y[i + k]) * (x[i + k] - y[i + k])
        largest = max(largest, square)
    return float(np.sqrt(largest))


@inner
def longest(x: Floats, d: int) -> float:
    """Compute max_i |X_i|."""
    largest = 0.0
    for i in range(0, x.size, d):
        square = 0.0
        for k in range(d):
            square += x[i + k] * x[i + k]
        largest = max(largest, square)
    return float(np.sqrt(largest))


@kernel
def overlaps_at(place: int, t: Floats, x: Floats, overlap: Floats) -> None:
    """Write how far the states x (K, n) at times t are outside of the set of a system, for rows in its table, (K,)."""
    system = system_at(place)
    for q in range(t.size):
        overlap[q] = 0.0
        call_python(system.sets, t[q], x[q], GRADIENTS)
        for r in range(system.rows.row.size):
            overlap[q] = max(overlap[q], -gap(system.rows, system.sets, r, x[q]))
