"""Arrays of a run of the event-driven method, which kernels get by pointer."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled.arrays import Floats, Offsets
from dincl.compiled.structs import struct_type
from dincl.events.runge_kutta import RungeKutta
from dincl.solvers.envelope_factor import EnvelopeFactor, envelope_factor
from dincl.solvers.sparse_factor import SPARSE_FROM, SparseFactor, sparse_factor
from dincl.system.arrays import SYSTEM, SystemArrays

# State of a row: its gap is open; closed, without force; closed, with a multiplier > 0.
OPEN, CLOSED, ACTIVE = 0, 1, 2
# How a kernel ends besides the codes of ``dincl.system.arrays``: the end is reached; the table of steps is full and has
# to be emptied; too many changes of the contacts at one time; no step is short enough; too many steps are needed; the
# drift jumps too often; sets jumped away from contacts, or onto particles. Or the step has to be repeated: with a
# shorter one, or one that ends at a jump.
DONE, FULL, STUCK, NO_STEP, SLOW, JUMPS, MOVED, AGAIN = range(20, 28)
# Gaps up to this are contacts, relative to the size of the problem; rounding leaves 1e-15.
TOUCHING = 1e-13
# Runs of fewer coordinates than this, 24 discs in the plane, never take the sparse factor.
FEWEST_COORDINATES = 48
# The rate in which velocities between the stages are written.
SPARE = 16

STATE = np.dtype(
    [
        ("t", np.float64),
        ("start", np.float64),
        ("end", np.float64),
        ("stop", np.float64),  # the next discontinuity in time, before it and behind it; both are the end without one
        ("resume", np.float64),
        ("passed", np.int64),  # how many of ``breaks``
        ("piece", np.int64),  # in which t is
        ("jumps", np.int64),
        ("tol", np.float64),  # local tolerance of the integrator
        ("size", np.float64),  # of the problem [length]
        ("largest", np.float64),  # the largest coordinate allowed
        ("speed", np.float64),  # the largest so far
        ("zero", np.float64),  # multipliers and speeds up to this are zero
        ("h", np.float64),  # the step that the tolerance allows
        ("last_h", np.float64),  # the last accepted step
        ("step", np.float64),  # the length of the current step, not yet accepted
        ("error", np.float64),  # its estimated error over the allowed one
        ("theta", np.float64),  # the part of it at which the velocity was computed last, or -1
        ("level", np.float64),  # lower limit of a gap, 0 or less
        ("neglected", np.float64),  # how far multipliers < 0 that count as zero can have moved a particle, in all
        ("longest", np.float64),  # the longest step of this phase
        ("code", np.int64),  # how the last computation of a velocity ended
        ("parts", np.int64),
        ("made", np.int64),  # steps; how many there were, and the time, when progress was checked last
        ("checked", np.int64),
        ("checked_t", np.float64),
        ("phase", np.int64),  # phases so far; a phase lies between two events
        ("undecided", np.int64),  # 1 if contacts are to be decided
        ("decided_at", np.float64),  # when contacts were decided last, and how often again at that time
        ("repeats", np.int64),
        ("mean_phase", np.float64),  # the mean length of a phase, of which the last ten count most
        ("closed", np.int64),  # the number of rows in ``closed``
        ("steps", np.int64),  # in the table of steps, and the events in it
        ("events", np.int64),
    ]
)


class StepTable(NamedTuple):
    """Accepted steps with their dense output and their active rows; events."""

    end: Floats  # (steps,): a step from start to start + h is used up to here
    start: Floats
    h: Floats
    x: Floats  # (steps, n)
    dense: Floats  # (steps, terms, n)
    active: Offsets  # (steps, most): active rows
    number: Offsets  # (steps,): how many they are
    event: Floats  # (events, 4): t, row, whether it closes, and the phase that it ends


class EventWorkspace(NamedTuple):
    """A run of the event-driven method from ``state.start`` to ``state.end`` for n coordinates and m rows."""

    system: int  # address of its SystemArrays
    gram: SparseFactor
    many: int  # the address of ``many_contacts``, 0 for runs that never have many
    active: EnvelopeFactor  # the active rows, and their factor if they are few
    breaks: Floats  # (K, 3), known ones: where a step ends, the last time before and the first time behind a break
    pieces: Floats  # (P, 2): until when, and by how long steps, all functions of time are resolved
    pair: RungeKutta
    state: NDArray[np.void]
    steps: StepTable
    x: Floats  # (n,)
    after: Floats  # (n,): the state after a step
    rate: Floats  # (17, n): the stages of a step, and SPARE
    multiplier: Floats  # (17, most): of the active rows in each of them
    dense: Floats  # (7, n)
    point: Floats  # (n,)
    bend: Floats  # (N,): how far the dense output leaves a straight line
    contact: Offsets  # (m,): OPEN, CLOSED or ACTIVE
    touching: Offsets  # (m,): a list of rows that touch, or touched at the last decision
    decided: Offsets  # (m,): what each of them becomes
    closed: Offsets  # (m,): the rows that were not open after the last decision


def step_table(steps: int, terms: int, n: int, most: int, m: int) -> StepTable:
    """Allocate a table of steps with n coordinates and m rows, fewer than ``most`` of them active."""
    end, start, h, x, dense = (np.zeros((steps, *shape)) for shape in ((), (), (), (n,), (terms, n)))
    active, number = np.zeros((steps, most), dtype=np.int64), np.zeros(steps, dtype=np.int64)
    return StepTable(end, start, h, x, dense, active, number, np.zeros((m + 1024, 4)))


def sparse_gram(system: SystemArrays) -> SparseFactor:
    """Allocate the sparse factor for as many rows as can touch: two for each coordinate, as in a packing of spheres."""
    rows, n, m = system.rows, system.velocity.size, len(system.rows.row)
    if not _may_have_many(system):
        return sparse_factor(0, 0, 0, 0)
    most = min(m, 2 * n)
    return sparse_factor(most, n, m, min(len(rows.column), most * int((rows.stop - rows.start).max())))


def event_workspace(
    system: SystemArrays,
    address: int,
    gram: SparseFactor,
    pair: RungeKutta,
    steps: StepTable,
    x: Floats,
    breaks: Floats,
    pieces: Floats,
    **state: float,
) -> EventWorkspace:
    """Allocate a run from x (n,) with these numbers of its state, others 0; ``address`` is that of the system."""
    n, m, most = x.size, system.rows.row.size, system.factor.row.size
    begin = np.zeros(1, dtype=STATE)
    for name, value in state.items():
        begin[name] = value
    d = system.move.shape[1]
    return EventWorkspace(
        system=address,
        gram=gram,
        many=_address_of_many() if _may_have_many(system) else 0,
        active=envelope_factor(most, n),
        breaks=breaks,
        pieces=pieces,
        pair=pair,
        state=begin,
        steps=steps,
        x=x,
        after=np.zeros(n),
        rate=np.zeros((SPARE + 1, n)),
        multiplier=np.zeros((SPARE + 1, most)),
        dense=np.zeros((7, n)),
        point=np.zeros(n),
        bend=np.zeros(n // d if d else 0),
        **{name: np.zeros(m, dtype=np.int64) for name in ("contact", "touching", "decided", "closed")},
    )


def _may_have_many(system: SystemArrays) -> bool:
    """Return whether a run may have so many contacts that a sparse factor serves."""
    return len(system.rows.row) >= SPARSE_FROM and system.velocity.size >= FEWEST_COORDINATES


def _address_of_many() -> int:
    from dincl.events.many_contacts import many_contacts

    return int(many_contacts.address)


# The type by which kernels are compiled.
KIND = struct_type(
    event_workspace(
        SYSTEM,
        0,
        sparse_gram(SYSTEM),
        RungeKutta(0, 0, 0, 0.0, np.zeros((0, 0)), np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0))),
        step_table(0, 0, 0, 0, 0),
        np.zeros(0),
        np.zeros((0, 3)),
        np.zeros((0, 2)),
    )
)
