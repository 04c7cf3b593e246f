"""The rules of the cell cycle, applied once per dt: division, phases, rest lengths.

Source: sections 2.2.1 to 2.2.5 of chapter 3.
"""

from __future__ import annotations

import math

from numpy.random import Generator

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.handed import numbers_of
from tissue.kernels.rules import Rules
from tissue.kernels.store import CELLS, Store
from tissue.model.cytoskeleton import capped
from tissue.model.emt import last_events
from tissue.model.junctions import shrink_junctions
from tissue.model.springs import apical_length, basal_length, cell_length
from tissue.state.cells import Cells
from tissue.state.numbers import Numbers


@inner
def draw_cycle(numbers: Numbers, draws: Generator) -> float:
    """t_cycle ~ U(T_min, T_max)  (3.1)."""
    return numbers.min_cycle + (numbers.max_cycle - numbers.min_cycle) * draws.random()


@inner
def in_g2(cells: Cells, i: int, t: float, numbers: Numbers) -> bool:
    """Whether t_age >= t_G2 = t_cycle - T_G2 - T_mitosis: the active part of G2, or mitosis."""
    late: bool = t - cells.birth[i] >= cells.cycle[i] - numbers.g2 - numbers.mitosis
    return late


@kernel
def set_phases(store: Store, t: float, numbers: Numbers) -> None:
    """Hard radius (3.4) and stiffness of the apical junctions at time t, from the phase and the type of each cell."""
    cells = store.cells
    for i in range(store.sizes[CELLS]):
        own = numbers_of(numbers, cells.kind[i])
        changes = cells.moves[i] or own.resting_enlarge
        late = in_g2(cells, i, t, own)
        mitosis = t - cells.birth[i] >= cells.cycle[i] - own.mitosis
        enlarged = changes and (late if own.enlarge_in_g2 else mitosis)
        radius = own.enlarged_radius if enlarged else own.hard_radius
        cells.radius[i] = radius
        cells.stiff_aa[i] = own.alpha_aa * (own.g2_stiffening if changes and late else 1.0)


@kernel
def adapt_rest_lengths(store: Store, t: float, numbers: Numbers, rules: Rules) -> None:
    """Relax each rest length towards what the phase wants, eta <- eta* + (eta - eta*) exp(-k dt)  (3.2), (3.3), (3.6).

    eta* is the present length d - R_soft of the spring, and from G2 on (section 2.2.3 of chapter 3) 0 for the apical
    and |A - B| - 2 R_soft for the basal spring, so that the springs rest with the nucleus at the apical side. Junctions
    shrink towards 0. The sum of both eta* may have a cap, see ``tissue.model.cytoskeleton``. What has begun of the EMT
    takes the place of these.
    """
    cells, n = store.cells, store.sizes[CELLS]
    shrink_junctions(store, numbers)
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
        if own.floor_rest:
            wanted_ax, wanted_bx = max(0.0, wanted_ax), max(0.0, wanted_bx)
        wanted_ax, wanted_bx = capped(wanted_ax, wanted_bx, cells.events[i], own.max_cytoskeleton)
        cells.rest_ax[i] = wanted_ax + (rest_ax - wanted_ax) * keep_ax
        cells.rest_bx[i] = wanted_bx + (rest_bx - wanted_bx) * keep_bx
        if cells.events[i]:
            last_events(store, i, rest_ax, rest_bx, own, rules)
