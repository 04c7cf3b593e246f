"""The damped Arrow-Hurwicz iteration for a tissue whose rules stand still (Method 3.4).

Its constraints, with multipliers lambda >= 0, are functions g >= 0 ("the square of (C1) to (C4)"): |X_i - X_j|^2 -
(R_i + R_j)^2 for hard discs, max_basal_distance^2 - (b_j - b_i)^2 for neighbours in the basal layer; their order
b_j - b_i stays as it is, as a square would lose its sign.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import StructPointer, inner, struct_type
from tissue.kernels import kernel
from tissue.kernels.lanes import WIDTH
from tissue.kernels.near import BLOCK, find_boxes, list_before
from tissue.kernels.workspace import LOST, Workspace, Workspaces
from tissue.model.junctions import pull_junctions
from tissue.model.motion import move
from tissue.model.repulsion import push_in_rows
from tissue.state.cells import COORDINATES, Floats, Integers
from tissue.state.numbers import Numbers
from tissue.state.running import BASAL, STRAIGHT, state_at
from tissue.step.advance import DONE
from tissue.step.copies import copy_in, copy_out

# How a call ended, beside DONE: too many pairs are near each other; coordinates beyond all bounds; all iterations made,
# and the rule does not hold yet.
CROWDED, NON_FINITE, UNFINISHED = range(DONE + 1, DONE + 4)
# Bound of |z_n|^2 + |z_{n+1} - z_n|^2: below it |z_{n+1}| is below LOST.
TOO_FAR = LOST**2 / 2


# Pairs of hard discs per cell that may overlap soon, or did and still push: more mean that the tissue has collapsed.
MOST = 32
# Gap up to which pairs are listed [R_soft]: nuclei may move by half of this before they are listed again.
LISTED_GAP = 0.1


class Daha(NamedTuple):
    """Numbers of the method, lengths in units of R_soft."""

    alpha: float  # weight of the descent
    beta: float  # of the ascent in the multipliers
    gamma: float  # of the term that damps the constraints
    c: float  # damping
    dtau: float  # step
    eps: float  # of the stopping rule (3.24)
    most_iterations: int  # after these it has not terminated


# Of chapter 3.
TABLE_4 = Daha(alpha=1e-4, beta=0.25, gamma=1e-3, c=2.0, dtau=1.0, eps=1e-6, most_iterations=100_000)


class Multipliers(NamedTuple):
    """lambda of the listed pairs of discs, zero for all others, and of neighbours k, k + 1 on the basal line."""

    pairs: Integers  # (1,) how many
    i: Integers
    j: Integers  # < i
    square: Floats  # (R_i + R_j)^2
    discs: Floats  # (C1)
    order: Floats  # (C4)
    distance: Floats  # (C2)
    # To find a pair: the last pair of each cell i, -1 if there is none, and for each pair the one before it
    last: Integers
    previous: Integers


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


def multipliers_for(capacity: int) -> Multipliers:
    """Room for so many cells; no pair is listed, and all multipliers are zero."""
    lengths = {"pairs": 1, "order": capacity, "distance": capacity, "last": capacity}
    floats = {"square", "discs", "order", "distance"}
    arrays: dict[str, NDArray[Any]] = {
        name: np.zeros(lengths.get(name, MOST * capacity), np.float64 if name in floats else np.int64)
        for name in Multipliers._fields
    }
    return Multipliers(**arrays)


@inner
def hold_discs(work: Workspace, daha: Daha, weight: float, multipliers: Multipliers, change: Floats) -> None:
    """(C1): change += weight lambda (alpha - gamma g) grad g, then lambda <- max(0, lambda - dtau beta g)."""
    x, y, discs = work.x, work.y, multipliers.discs
    for k in range(multipliers.pairs[0]):
        i, j, multiplier = multipliers.i[k], multipliers.j[k], discs[k]
        dx, dy = x[i] - x[j], y[i] - y[j]
        g = dx * dx + dy * dy - multipliers.square[k]
        if multiplier > 0.0 or g < 0.0:
            push = 2.0 * weight * multiplier * (daha.alpha - daha.gamma * g)
            change[0, i] += push * dx
            change[1, i] += push * dy
            change[0, j] -= push * dx
            change[1, j] -= push * dy
            discs[k] = max(0.0, multiplier - daha.dtau * daha.beta * g)


@inner
def hold_basal(
    work: Workspace, layer: Integers, basal: int, daha: Daha, weight: float, multipliers: Multipliers, change: Floats
) -> None:
    """(C4) and (C2): the same for the basal points."""
    order, distance, bx, largest = multipliers.order, multipliers.distance, work.bx, work.limit[0]
    before = 0.0
    for k in range(basal - 1):
        i = layer[k]
        d = bx[layer[k + 1]] - bx[i]
        g = largest * largest - d * d
        push = order[k] * (daha.alpha - daha.gamma * d) - 2.0 * distance[k] * (daha.alpha - daha.gamma * g) * d
        change[4, i] += weight * (before - push)
        before = push
        order[k] = max(0.0, order[k] - daha.dtau * daha.beta * d)
        distance[k] = max(0.0, distance[k] - daha.dtau * daha.beta * g)
    if basal > 0:
        change[4, layer[basal - 1]] += weight * before


@inner
def list_pairs(work: Workspace, n: int, multipliers: Multipliers) -> bool:
    """Hold the pairs that have a multiplier or a gap of at most LISTED_GAP; False if they have no room.

    Until a nucleus moves by LISTED_GAP / 2 no other pair can overlap, so that its multiplier stays zero.
    """
    x, y, radius = work.x, work.y, work.radius
    find_boxes(work, n, BLOCK, 1.0, 0.5 * LISTED_GAP)
    for i in range(n):
        work.before_x[i], work.before_y[i] = x[i], y[i]
        multipliers.last[i] = -1
    old, multipliers.pairs[0] = multipliers.pairs[0], 0
    for k in range(old):
        if multipliers.discs[k] > 0.0:
            _add(multipliers, multipliers.i[k], multipliers.j[k], multipliers.square[k], multipliers.discs[k])
    for i in range(n):
        for k in range(list_before(work, i)):
            for j in range(work.begin[k], min(work.end[k], i)):
                contact = radius[i] + radius[j]
                near = math.hypot(x[i] - x[j], y[i] - y[j]) <= contact + LISTED_GAP
                if near and not _is_held(multipliers, i, j):
                    if multipliers.pairs[0] == len(multipliers.i):
                        return False
                    _add(multipliers, i, j, contact * contact, 0.0)
    return True


@inner
def is_stale(work: Workspace, n: int) -> bool:
    """Return whether a nucleus moved by more than LISTED_GAP / 2 since it was listed."""
    for i in range(n):
        dx, dy = work.x[i] - work.before_x[i], work.y[i] - work.before_y[i]
        if dx * dx + dy * dy > 0.25 * LISTED_GAP * LISTED_GAP:
            return True
    return False


@inner
def _add(multipliers: Multipliers, i: int, j: int, square: float, multiplier: float) -> None:
    """Put a pair at the end of the list; its place may not be behind it."""
    k = multipliers.pairs[0]
    multipliers.i[k], multipliers.j[k], multipliers.square[k], multipliers.discs[k] = i, j, square, multiplier
    multipliers.previous[k], multipliers.last[i] = multipliers.last[i], k
    multipliers.pairs[0] = k + 1


@inner
def _is_held(multipliers: Multipliers, i: int, j: int) -> bool:
    """Return whether the pair is listed."""
    k: int = multipliers.last[i]
    while k >= 0 and multipliers.j[k] != j:
        k = multipliers.previous[k]
    return k >= 0
