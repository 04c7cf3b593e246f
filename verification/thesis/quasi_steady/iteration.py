"""The damped Arrow-Hurwicz iteration for a tissue whose rules stand still (Method 3.4)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import StructPointer, inner, struct_type
from tissue.kernels import kernel
from tissue.kernels.lanes import WIDTH
from tissue.kernels.workspace import LOST, Workspace, Workspaces
from tissue.model.junctions import pull_junctions
from tissue.model.motion import move
from tissue.model.repulsion import push_in_rows
from tissue.state.cells import COORDINATES, Floats, Integers
from tissue.state.numbers import Daha, Numbers
from tissue.state.running import BASAL, STRAIGHT, state_at
from tissue.step.advance import DONE
from tissue.step.copies import copy_in, copy_out
from verification.thesis.quasi_steady.multipliers import (
    Multipliers,
    hold_basal,
    hold_discs,
    is_stale,
    list_pairs,
    multipliers_for,
)

# How a call ended, beside DONE: too many pairs are near each other; coordinates beyond all bounds; all iterations made,
# and the rule does not hold yet.
CROWDED, NON_FINITE, UNFINISHED = range(DONE + 1, DONE + 4)
# Bound of |z_n|^2 + |z_{n+1} - z_n|^2: below it |z_{n+1}| is below LOST.
TOO_FAR = LOST**2 / 2


class Memory(NamedTuple):
    """What the iteration remembers beside the positions, by coordinate (COORDINATES, capacity)."""

    multipliers: Multipliers
    points: Floats  # the coordinates of the workspace
    before: Floats  # z_{n-1}, or z_n while it moves on
    change: Floats  # z_{n+1} - z_n without the part of the forces


def workspaces_for(capacity: int, numbers: Numbers, daha: Daha) -> Workspaces:
    """Workspaces for so many cells, whose displacements are those of one iteration."""
    return Workspaces(capacity, 1, [[numbers]], scale_of(daha), STRAIGHT)


def scale_of(daha: Daha) -> Floats:
    """Return what a displacement of one iteration is over the force, in place of h / mu, (1,)."""
    return np.array([daha.dtau**2 / (1 + daha.c * daha.dtau / 2) * daha.alpha])


def memory_for(workspaces: Workspaces) -> Any:
    """Make room for what is on a workspace: for kernels it is ``Memory``. All multipliers are zero.

    The coordinates of the workspace become the rows of one array, on which the iteration works.
    """
    points = np.zeros((len(COORDINATES), len(workspaces.flat.value.x)))
    rows = dict(zip(COORDINATES, points, strict=True))
    rows["along"] = rows["bx"]
    workspaces.flat.replace(rows)
    workspaces.wide.replace({name: row.reshape(-1, WIDTH) for name, row in rows.items()})
    parts = Memory(multipliers_for(points.shape[1]), points, np.zeros(points.shape), np.zeros(points.shape))
    return StructPointer(parts, struct_type(parts))


@kernel
def iterate(
    states: Integers,
    ended: Integers,
    flat: Workspace,
    wide: Workspace,
    numbers: Integers,
    scale: Floats,
    daha: Daha,
    memory: Memory,
) -> tuple[int, int]:
    """Move the cells until |z_{n+1} - z_n| <= dtau eps |z_n| (3.24): the number of iterations, and how the call ended.

    z_{n+1} = z_n + ((1 - a) (z_n - z_{n-1}) - dtau^2 p_n) / (1 + a) with a = c dtau / 2 is (3.25), solved. It begins
    with the multipliers in ``memory``; the workspaces are those of ``workspaces_for``.
    """
    state, half = state_at(states[0]), daha.c * daha.dtau / 2
    weight, inertia = daha.dtau**2 / (1 + half), (1 - half) / (1 + half)
    n = copy_in(states, ended, flat, numbers, scale)
    rows, layer, basal = (n + WIDTH - 1) // WIDTH, state.layers.basal, state.sizes[BASAL]
    made, end = 0, UNFINISHED if list_pairs(flat, n, memory.multipliers) else CROWDED
    _begin(memory, n)
    while made < daha.most_iterations and end == UNFINISHED:
        made += 1
        _remember(memory, n, inertia)
        hold_discs(flat, daha, weight, memory.multipliers, memory.change)
        hold_basal(flat, layer, basal, daha, weight, memory.multipliers, memory.change)
        push_in_rows(flat, n, wide, rows)
        pull_junctions(flat, n, wide, rows)
        move(wide, rows)
        moved, size = _move(memory, n)
        if not moved + size < TOO_FAR:  # nor if it is NaN
            end = NON_FINITE
        elif moved <= (daha.dtau * daha.eps) ** 2 * size:
            end = DONE
        elif is_stale(flat, n) and not list_pairs(flat, n, memory.multipliers):
            end = CROWDED
    copy_out(flat, states)
    return made, end


@inner
def _begin(memory: Memory, n: int) -> None:
    """z_1 = z_0."""
    points, before = memory.points, memory.before
    for k in range(before.shape[0]):
        for i in range(n):
            before[k, i] = points[k, i]


@inner
def _remember(memory: Memory, n: int, inertia: float) -> None:
    """Begin the changes with the inertia, and keep where the points were."""
    points, before, change = memory.points, memory.before, memory.change
    for k in range(before.shape[0]):
        for i in range(n):
            change[k, i] = inertia * (points[k, i] - before[k, i])
            before[k, i] = points[k, i]


@inner
def _move(memory: Memory, n: int) -> tuple[float, float]:
    """Add the changes to the coordinates: |z_{n+1} - z_n|^2 and |z_n|^2."""
    points, before, change = memory.points, memory.before, memory.change
    moved, size = 0.0, 0.0
    for i in range(n):
        way, whole = 0.0, 0.0
        for k in range(before.shape[0]):
            points[k, i] += change[k, i]
            way += (points[k, i] - before[k, i]) ** 2
            whole += before[k, i] ** 2
        moved += way
        size += whole
    return moved, size
