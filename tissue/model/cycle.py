"""The rules of the cell cycle, applied once per dt: phases, rest lengths with a cap on the length of a cell, divisions.

Source: sections 2.2.1 to 2.2.5 of chapter 3.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.layers import chained_behind
from tissue.kernels.rules import Rules, call_split, call_splits
from tissue.model.emt import last_events
from tissue.model.springs import apical_length, basal_length, cell_length
from tissue.state.cells import Cells
from tissue.state.numbers import Numbers, numbers_of
from tissue.state.running import APICAL, CELLS, TissueState
from tissue.state.space import EDGES, SPATIAL


@inner
def capped(wanted_ax: float, wanted_bx: float, events: int, rules: Rules, largest: float) -> tuple[float, float]:
    """Scale the desired rest lengths eta* of both springs so that their sum is ``largest`` at most; inf for no cap.

    Without a cap, rest lengths follow the springs wherever they go, (3.2), (3.3): in the long run a cell resists no
    length. A constraint |A - X| <= L would be another set S, which competes with (C1) in a crowd and may be empty. A
    cap of the rest lengths leaves S and the form of the energy as they are: beyond it a cell is an elastic spring. The
    public programs of the author relax both rest lengths towards shares of L where their sum is above L by more than
    R_soft: it ends between L and what the springs want, so that is no cap.

    A spring whose end an event has freed, such as [A] or [B], wants 0 in place of its eta*. With equal rates k a sum of
    rest lengths that is below the cap stays so; one that begins above it relaxes to it.
    """
    total = (0.0 if events & rules.frees_apical else wanted_ax) + (0.0 if events & rules.frees_basal else wanted_bx)
    if total > largest:
        return wanted_ax * (largest / total), wanted_bx * (largest / total)
    return wanted_ax, wanted_bx


@inner
def draw_cycle(numbers: Numbers, draws: Generator) -> float:
    """t_cycle ~ U(T_min, T_max)  (3.1)."""
    return numbers.min_cycle + (numbers.max_cycle - numbers.min_cycle) * draws.random()


@inner
def in_g2(cells: Cells, i: int, t: float, numbers: Numbers) -> bool:
    """Return whether t_age >= t_G2 = t_cycle - T_G2 - T_mitosis: the active part of G2, or mitosis."""
    late: bool = t - cells.birth[i] >= cells.cycle[i] - numbers.g2 - numbers.mitosis
    return late


@kernel
def set_phases(state: TissueState, t: float, numbers: Numbers) -> None:
    """Hard radius (3.4) and stiffness of the apical junctions at time t, from the phase and the type of each cell."""
    cells = state.cells
    for i in range(state.sizes[CELLS]):
        own = numbers_of(numbers, cells.kind[i])
        changes = cells.moves[i] or own.resting_cells_enlarge
        late = in_g2(cells, i, t, own)
        mitosis = t - cells.birth[i] >= cells.cycle[i] - own.mitosis
        enlarged = changes and (late if own.enlarge_in_g2 else mitosis)
        radius = own.enlarged_radius if enlarged else own.hard_radius
        cells.radius[i] = radius
        cells.stiff_aa[i] = own.alpha_aa * (own.g2_stiffening if changes and late else 1.0)


@inner
def adapt_rest_lengths(state: TissueState, t: float, numbers: Numbers, rules: Rules) -> None:
    """Relax each rest length towards what the phase wants, eta <- eta* + (eta - eta*) exp(-k dt)  (3.2), (3.3), (3.6).

    eta* is the present length d - R_soft of the spring, and from G2 on (section 2.2.3 of chapter 3) 0 for the apical
    and |A - B| - 2 R_soft for the basal spring, so that the springs rest with the nucleus at the apical side. Junctions
    shrink towards 0. The sum of both eta* may have a cap, see ``tissue.model.cycle``. What has begun of the EMT
    takes the place of these.
    """
    cells, n = state.cells, state.sizes[CELLS]
    if state.space.dimension == SPATIAL:
        shrink_edges(state, numbers)
    else:
        shrink_junctions(state, numbers)
    kind, own, keep_ax, keep_bx = -1, numbers, 0.0, 0.0
    for i in range(n):
        if cells.kind[i] != kind:  # of neighbours it is mostly the same: two exponentials for many cells
            kind = cells.kind[i]
            own = numbers_of(numbers, kind)
            keep_ax, keep_bx = math.exp(-own.rate_ax * own.dt), math.exp(-own.rate_bx * own.dt)
        rest_ax, rest_bx = cells.rest_ax[i], cells.rest_bx[i]
        if cells.moves[i] and in_g2(cells, i, t, own):
            wanted_ax = 0.0
            wanted_bx = cell_length(cells, i) - 2.0 * own.soft_radius
        else:
            wanted_ax = apical_length(cells, i) - own.soft_radius
            wanted_bx = basal_length(cells, i) - own.soft_radius
        if own.floor_rest_length:
            wanted_ax, wanted_bx = max(0.0, wanted_ax), max(0.0, wanted_bx)
        wanted_ax, wanted_bx = capped(wanted_ax, wanted_bx, cells.events[i], rules, own.max_cytoskeleton)
        cells.rest_ax[i] = wanted_ax + (rest_ax - wanted_ax) * keep_ax
        cells.rest_bx[i] = wanted_bx + (rest_bx - wanted_bx) * keep_bx
        if cells.events[i]:
            last_events(state, i, rest_ax, rest_bx, own, rules)


@inner
def shrink_junctions(state: TissueState, numbers: Numbers) -> None:
    """Relax each rest length towards 0 over one dt, eta <- eta exp(-k dt)  (3.6); k is the mean of both cells."""
    cells, rate, kept, place = state.cells, 0.0, 1.0, 0
    for i in range(state.sizes[CELLS]):
        j, place = _joined_behind(state, i, place)
        k = 0.5 * (numbers_of(numbers, cells.kind[i]).rate_aa + numbers_of(numbers, cells.kind[j]).rate_aa)
        if k != rate:  # mostly the same: few exponentials for many junctions
            rate, kept = k, math.exp(-k * numbers.dt)
        cells.rest_aa[i] *= kept


@inner
def _joined_behind(state: TissueState, i: int, place: int) -> tuple[int, int]:
    """Return the cell behind cell i that a junction joins to it, cell i itself if there is none, and the next place.

    ``place``: the first one of the apical layer that is not before cell i.
    """
    layer, size = state.layers.apical, state.sizes[APICAL]
    if place < size and layer[place] == i:
        if place + 1 < size:
            return layer[place + 1], place + 1
        return layer[0] if state.curve.ring > 0.0 else i, place + 1
    return max(i, chained_behind(state.cells, state.sizes[CELLS], i)), place


@inner
def shrink_edges(state: TissueState, numbers: Numbers) -> None:
    """Relax each rest length towards 0 over one dt, eta <- eta exp(-k dt)  (3.6); k is the mean of both cells."""
    network, kind = state.space.apical, state.cells.kind
    rate, kept = 0.0, 1.0
    for i in range(state.sizes[CELLS]):  # those of cells are not used, but are in tables
        state.cells.rest_aa[i] *= math.exp(-numbers_of(numbers, kind[i]).rate_aa * numbers.dt)
    for edge in range(network.sizes[EDGES]):
        i, j = network.edges[edge, 0], network.edges[edge, 1]
        own = 0.5 * (numbers_of(numbers, kind[i]).rate_aa + numbers_of(numbers, kind[j]).rate_aa)
        if own != rate:  # mostly the same: few exponentials for many junctions
            rate, kept = own, math.exp(-own * numbers.dt)
        network.rest[edge] *= kept


# Division (section 2.2.5 of chapter 3)


@inner
def count_due(state: TissueState, t: float) -> int:
    """Return how many cells end their cycle by time t: as many may be added."""
    cells = state.cells
    count = 0
    for i in range(state.sizes[CELLS]):
        count += is_due(cells, i, t)
    return count


@inner
def is_due(cells: Cells, i: int, t: float) -> bool:
    """Return whether cell i ends its cycle by time t."""
    due: bool = t - cells.birth[i] >= cells.cycle[i]
    return due


@inner
def divide(state: TissueState, t: float, numbers: Numbers, rules: Rules, draws: Generator) -> None:
    """End the cycle of each cell that is old enough: it begins a new one, alone or with a second daughter beside it.

    What is drawn for daughters is kept in ``TissueState.daughters``, from which the rule ``split`` makes all of them at
    once.
    """
    cells, splits = state.cells, 0
    for i in range(state.sizes[CELLS]):
        if is_due(cells, i, t):
            own = numbers_of(numbers, cells.kind[i])
            two = cells.divides[i] and call_splits(rules.splits, state, i, draws.random(), own) != 0
            cells.birth[i] = t
            cells.cycle[i] = draw_cycle(own, draws)
            for row in range(len(state.daughters.part) if cells.divides[i] else 0):
                cells.own[row, i] = state.daughters.part[row] * cells.own[row, i] + state.daughters.fresh[row]
            if two:
                if state.space.dimension == SPATIAL:  # in a slice there is one direction
                    state.daughters.turn[i] = draws.random()
                state.daughters.cycle[i] = draw_cycle(own, draws)
                splits += 1
    if splits > 0:
        call_split(state.space.rules.split, state, splits, numbers, rules)
