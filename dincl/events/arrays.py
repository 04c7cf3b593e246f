"""The arrays of a run of the event-driven method."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled.arrays import Floats, Offsets
from dincl.compiled.structs import reader
from dincl.solvers.factor import Chosen, room
from dincl.system.arrays import SYSTEM, SystemArrays

# What a row is during a phase.
OPEN, CLOSED, HELD = 0, 1, 2

STATE = np.dtype(
    [
        ("now", np.float64),
        ("end", np.float64),
        ("stop", np.float64),  # when something jumps next, and from when on it has; both are the end if nothing does
        ("resume", np.float64),
        ("kink", np.int64),  # the kinks of sets that were passed
        ("jumps", np.int64),  # those of the drift
        ("tol", np.float64),  # the local one of the integrator
        ("size", np.float64),  # of the problem [length]
        ("most", np.float64),  # the largest coordinate allowed
        ("speed", np.float64),  # the largest so far
        ("slow", np.float64),  # pushes and speeds up to this are zero
        ("h", np.float64),  # the step that the tolerance allows
        ("usual", np.float64),  # the last one that was taken
        ("error", np.float64),  # the estimate of the step that is looked at, over what the tolerance allows
        ("doubt", np.float64),  # how far pushes that were taken for zero can have moved a particle, in all
        ("longest", np.float64),  # the longest step of this phase
        ("made", np.float64),  # the length of the step that is looked at
        ("theta", np.float64),  # the part of that step at which the motion was computed last
        ("level", np.float64),  # what a gap must not fall below, 0 or less
        ("code", np.int64),  # how the last computation of a motion ended
        ("parts", np.int64),
        ("cuts", np.int64),  # whether a step may end at an event by its dense output
        ("steps", np.int64),
        ("marked", np.int64),  # steps, and the time, when progress was looked at last
        ("mark", np.float64),
        ("phase", np.int64),  # phases so far; a phase lies between two events
        ("choose", np.int64),  # whether contacts are to be decided
        ("events", np.int64),
        ("pieces", np.int64),
        ("listed", np.int64),  # rows that were not open after the last choice
        ("usual_phase", np.float64),  # the mean length of a phase, of which the last ten count most
        ("chosen_at", np.float64),  # when contacts were decided last, and how often at that time
        ("at_once", np.int64),
    ]
)


class RungeKutta(NamedTuple):
    """An explicit pair: ``stages`` rates make a step, and ``more`` of them its dense output with ``terms`` terms."""

    stages: int
    more: int
    terms: int
    order: float  # of the error estimate
    a: Floats
    c: Floats
    error: Floats  # (2, stages + 1): of the two estimates; the second is zero if there is but one
    dense: Floats  # (terms - 3, stages + 1 + more)


class Path(NamedTuple):
    """What a run leaves: its steps with their dense output and the rows that are held, and its events."""

    end: Floats  # (pieces,)
    start: Floats
    length: Floats
    x: Floats  # (pieces, n)
    dense: Floats  # (pieces, terms, n)
    held: Offsets  # (pieces, most): the rows that are held
    number: Offsets  # (pieces,): and how many they are
    event: Floats  # (events, 4): t, row, whether it closes, and the phase that it ends


class March(NamedTuple):
    """A run of the event-driven method to ``state.end``; ``place`` is the handle of a system, ``gram`` of a factor."""

    place: int
    gram: int
    held: Chosen
    kinks: Floats  # (2 K,): from when to when velocities of sets jump
    pair: RungeKutta
    state: NDArray[np.void]
    path: Path
    x: Floats  # (n,)
    after: Floats  # (n,): the state after a step
    rate: Floats  # (17, n): the stages of a step; the last one is room for others
    push: Floats  # (17, most): the pushes of the held rows in each of them
    dense: Floats  # (7, n)
    point: Floats  # (n,)
    closed: Offsets  # (m,): HELD, CLOSED without pushing, or OPEN
    change: Offsets  # (m,): what it becomes at an event
    touching: Offsets  # (m,): room for a list of rows
    listed: Offsets  # (m,): the rows that were not open after the last choice
    bend: Floats  # (N,): how far the dense output leaves a straight line


def room_for_path(pieces: int, terms: int, n: int, most: int, m: int) -> Path:
    """Room for so many pieces of a run with n coordinates and m rows, fewer than ``most`` of them held."""
    end, start, length, x, dense = (np.zeros((pieces, *shape)) for shape in ((), (), (), (n,), (terms, n)))
    held, number = np.zeros((pieces, most), dtype=np.int64), np.zeros(pieces, dtype=np.int64)
    return Path(end, start, length, x, dense, held, number, np.zeros((m + 1024, 4)))


def begin_march(
    place: int,
    gram: int,
    system: SystemArrays,
    pair: RungeKutta,
    state: NDArray[np.void],
    path: Path,
    x: Floats,
    kinks: Floats,
) -> March:
    """A run from x (n,)."""
    n, m, most = x.size, system.rows.row.size, system.chosen.row.size
    closed, change, touching, listed = (np.zeros(m, dtype=np.int64) for _ in range(4))
    after, rate, push, dense, point = (np.zeros(shape) for shape in ((n,), (17, n), (17, most), (7, n), (n,)))
    bend = np.zeros(n // system.move.shape[1] if system.move.shape[1] else 0)
    return March(
        place,
        gram,
        room(most, n),
        kinks,
        pair,
        state,
        path,
        x,
        after,
        rate,
        push,
        dense,
        point,
        closed,
        change,
        touching,
        listed,
        bend,
    )


EXAMPLE = begin_march(
    0,
    0,
    SYSTEM,
    RungeKutta(0, 0, 0, 0.0, np.zeros((0, 0)), np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0))),
    np.zeros(1, dtype=STATE),
    room_for_path(0, 0, 0, 0, 0),
    np.zeros(0),
    np.zeros(0),
)
march_at = reader(EXAMPLE)
