"""A run that goes on from a saved state: as if it had not stopped, or with other parameters from there on."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe
from dincl.checks import seed as checked_seed
from dincl.errors import InvalidProblem
from tissue.events.known import bit, events, row
from tissue.files.cell_types import UNNAMED
from tissue.files.combinations import ROUNDING
from tissue.files.timing import Timing
from tissue.files.type_rules import broken_groups
from tissue.frames.frame import A_START, Frame
from tissue.frames.frame_files import checked
from tissue.kernels.workspace import LOST
from tissue.model.lattice import Lattice
from tissue.plugins import EmtEvent, registered
from tissue.rules.slice import in_plane
from tissue.runs.cell_groups import Crowd, Draws, control_cells, crowd_of, drawn_for, give
from tissue.runs.start import of_kinds, space_of
from tissue.state.basal_curve import curve_numbers
from tissue.state.cells import CONTROL, EMT, Cells, Emt, Flags, Integers, emt_cells
from tissue.state.checkpoint import TissueCheckpoint, resumed_streams, streams
from tissue.state.running import TissueState, new_state
from tissue.step.advance import find_lost

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.frames.frame import Frame
    from tissue.state.checkpoint import Streams, TissueCheckpoint


def resumed(parameters: Parameters, start: Frame, seed: int) -> tuple[TissueState, Streams]:
    """Return the tissue and the random numbers with which a run goes on from ``start``.

    With the seed of the run that ``start`` is of, the streams go on where they stood; with another one they begin.

    Raises
    ------
    InvalidProblem
        If the state is not of a run or was lost, or does not go with the parameters; the message names what must
        change.
    """
    past = checkpoint_of(start)
    goes_on = checked_seed("seed", seed) == past.seed
    random = resumed_streams(seed, past.generators) if goes_on else streams(seed)
    _refuse_unit(parameters, past)
    _refuse_layer(parameters, start)
    cells = Cells._make(array.copy() for array in start.cells)
    emt = typed(parameters, start, cells, random)
    _stiffen(parameters, cells)
    changed = start.cells.events & sum(bit(event.name) for event in registered(EmtEvent)) > 0
    for name in ("stiff_ax", "stiff_bx", "stiff_axb", "moves", "divides"):  # as events of users have left them
        getattr(cells, name)[changed] = getattr(start.cells, name)[changed]
    curve = curve_numbers(parameters.curve())
    capacity = 2 * len(cells.x)
    space = in_plane() if start.sheets is None else space_of(start.sheets, parameters.exchange(), capacity)
    state = new_state(cells, start.layers, past.next_id, emt, capacity=capacity, curve=curve, space=space)
    state.counts[:] = past.counts
    lost = find_lost(state)
    if lost >= 0:
        raise InvalidProblem(
            f"start at t = {start.t:g} h: cell {cells.id[lost]} has a coordinate that is not finite, or beyond "
            f"{LOST:g} R_soft: must be a state before the run failed"
        )
    return state, random


def _refuse_unit(parameters: Parameters, past: TissueCheckpoint) -> None:
    """Refuse another unit of length: all coordinates, rest lengths and radii of a state are over R_soft."""
    unit = parameters.cell.soft_radius
    if abs(unit.value - past.soft_radius) > ROUNDING * past.soft_radius:
        raise InvalidProblem(
            f'cell.soft_radius = "{unit}": must be that of the start, {past.soft_radius:g} um, the unit of its lengths'
        )


def _refuse_layer(parameters: Parameters, start: Frame) -> None:
    """Refuse a basal layer on which the basal points of the start do not lie."""
    if parameters.in_space != (start.sheets is not None):
        raise InvalidProblem(f"tissue.dimension = {parameters.tissue.dimension}: must be that of the start")
    if start.sheets is not None and start.sheets.surface != parameters.lattice().surface:
        raise InvalidProblem("the basal surface of [layer], [space] and [tissue]: must be that of the start")
    mine, theirs = parameters.curve(), start.curve
    if not (mine.ring == theirs.ring and np.array_equal(mine.table, theirs.table)):
        raise InvalidProblem(f'layer.shape = "{parameters.layer.shape}": [layer] must be that of the start')


def checkpoint_of(start: Frame) -> TissueCheckpoint:
    """Return the checkpoint of a frame; raises InvalidProblem if there is none."""
    if not isinstance(start, Frame):
        raise InvalidProblem(f"start = {describe(start)}: must be {A_START}")
    checked("start", (*start[:4], start.past, start.sheets))
    return start.past


def steps_made(parameters: Parameters, start: Frame) -> int:
    """Count the steps dt to ``start``; raises InvalidProblem if it is no whole number, or too many."""
    checkpoint_of(start)
    dt, end = parameters.numerics.dt, parameters.numerics.t_end
    made, last = start.t / dt.value, round(end.value / dt.value)
    if abs(made - round(made)) > ROUNDING * made:
        raise InvalidProblem(f'numerics.dt = "{dt}": must divide the time of the start, t = {start.t:g} h')
    if round(made) > last:
        raise InvalidProblem(f'numerics.t_end = "{end}": must be at least the time of the start, t = {start.t:g} h')
    return round(made)


def _stiffen(parameters: Parameters, cells: Cells) -> None:
    """Give the springs the stiffness of the parameters, as rules and events would have; see ``tissue.events``."""
    numbers = parameters.numbers()
    own = partial(of_kinds, cells.kind, (numbers, numbers, *parameters.named_numbers()))
    freed_a, freed_b = cells.events & bit("a") > 0, cells.events & bit("b") > 0
    cells.stiff_ax[:] = np.where(freed_a, own("alpha_ax") * numbers.freed_stiffness, own("alpha_ax"))
    free = np.where(freed_b, own("alpha_bx") * numbers.freed_stiffness, own("alpha_bx"))
    cells.stiff_bx[:] = np.where(cells.events & bit("p") > 0, cells.stiff_bx, free)  # [P] gives its own in each dt
    cells.stiff_axb[:] = np.where(cells.events & bit("s") > 0, numbers.bent_stiffness, own("alpha_axb"))


def typed(parameters: Parameters, start: Frame, cells: Cells, random: Streams) -> Emt:
    """Give the cells of a start the types of the parameters: the EMT cells, with their past.

    Their future is as the seed draws it from the parameters; an event that has begun stays. A tissue of control cells
    gets its groups now, where the parameters have them.
    """
    past, was = start.past, cells.emt.copy()
    cells.kind[:] = _kinds(parameters, cells, past)
    if (cells.kind == CONTROL).all() and (was < 0).all():
        crowd = _placed(parameters, start, cells, random)
    else:
        crowd = _kept(parameters, cells, random)
    cells.kind[:], cells.moves[:], cells.divides[:] = crowd.kind, crowd.moves, crowd.divides
    order = _by_number(crowd.may_leave, was)
    cells.emt[:] = -1
    cells.emt[order] = np.arange(len(order))
    emt = _with_past(emt_cells(crowd.times[:, order]), past.emt, was[order], cells.events[order])
    if start.t > 0:
        _refuse_past(parameters, start.t, emt, cells)
    return emt


def _by_number(among: Flags, was: Integers) -> Integers:
    """Return the EMT cells in the order of the numbers that they had, then those that had none, from left to right."""
    found = np.flatnonzero(among)
    return found[np.lexsort((found, was[found], was[found] < 0))]


def _kinds(parameters: Parameters, cells: Cells, past: TissueCheckpoint) -> Integers:
    """Return the types of the cells by their numbers in the parameters."""
    names, mine = (*UNNAMED, *past.types), parameters.type_names
    for kind in np.unique(cells.kind):
        if names[kind] not in mine:
            count = int((cells.kind == kind).sum())
            raise InvalidProblem(f"types.{names[kind]} is missing: must be there, {count} cells of the start are of it")
    return np.array([mine.index(name) if name in mine else CONTROL for name in names])[cells.kind]


def _placed(parameters: Parameters, start: Frame, cells: Cells, random: Streams) -> Crowd:
    """Return the groups at the places that the parameters give them."""
    groups, n = parameters.groups(), len(cells.x)
    if 0 < groups[0].scenario.cells > n - 2:
        raise InvalidProblem(
            f"emt.cells = {groups[0].scenario.cells}: must be at most {n - 2}, with control cells aside"
        )
    if lines := broken_groups(parameters.types.named(), n, parameters.emt.cells):
        raise InvalidProblem("; ".join(lines))
    lattice = None
    if start.sheets is not None:
        lattice = Lattice(start.sheets.surface, np.stack((cells.bx, cells.by, cells.bz)), spacing=0.0)
    crowd = crowd_of(groups, n, random, lattice)
    others = crowd.kind == CONTROL
    crowd.moves[others], crowd.divides[others] = cells.moves[others], cells.divides[others]
    return crowd


def _kept(parameters: Parameters, cells: Cells, random: Streams) -> Crowd:
    """Return the cells with the types that they have."""
    crowd = control_cells(len(cells.x))._replace(
        kind=cells.kind.copy(), moves=cells.moves.copy(), divides=cells.divides.copy(), may_leave=cells.emt >= 0
    )
    groups = parameters.groups()
    for kind, (group, draw) in enumerate(zip(groups, drawn_for(groups, random), strict=True), EMT):
        mine, wanted = _by_number(cells.kind == kind, cells.emt), group.scenario.cells
        first = _first_ones(cells, mine, wanted) if group.divides else mine
        if wanted != len(first) and (group.may_leave or len(mine) == 0):
            raise InvalidProblem(
                f"{_section(group.name)}.cells = {wanted}: must be {len(first)}, as many as there are at the start"
            )
        if group.may_leave:
            of = _descent(cells, mine, first)
            give(crowd, mine, kind, group, Draws(draw.times[:, of], draw.moves[of], draw.places))
        else:
            crowd.divides[mine] = group.divides & ~crowd.may_leave[mine]
    return crowd


def _first_ones(cells: Cells, mine: Integers, count: int) -> Integers:
    """Return those of a type that divides which are not daughters of others: EMT cells have the first ``count``
    numbers.
    """
    if len(mine) and cells.emt[mine].min() >= 0:
        return mine[:count]
    return mine[~np.isin(cells.mother[mine], cells.id[mine])]


def _descent(cells: Cells, mine: Integers, first: Integers) -> list[int]:
    """Find for each cell of a type the one among the ``first`` from which it descends."""
    place = {name: k for k, name in enumerate(cells.id[first])}
    mother = dict(zip(cells.id, cells.mother, strict=True))

    def descends(name: int) -> int:
        seen = {name}
        while name not in place:
            name = mother.get(name, name)
            if name in seen:
                raise InvalidProblem(f"cells.mother = {mother.get(name)}: must lead to a first cell of its type")
            seen.add(name)
        return place[name]

    return [descends(name) for name in cells.id[mine]]


def _section(name: str) -> str:
    """Return the table of a type in files."""
    return name if name in UNNAMED else f"types.{name}"


def _with_past(emt: Emt, before: Emt, old: Integers, begun: Integers) -> Emt:
    """Return the EMT cells with these times for what has not begun, and all else as before.

    Parameters
    ----------
    old
        The number that each had, -1 for none.
    begun
        Their events, as in ``Cells.events``.
    """
    had = old >= 0
    for name in ("new", "onset_ab", "side", "since", "since_x"):
        getattr(emt, name)[had] = getattr(before, name)[old[had]]
    for k, event in enumerate(events()):
        if event.after is not None:
            emt.at[k] = np.maximum(emt.at[k], emt.at[row(event.after)])
        mine = had & ((begun >> k & 1) > 0)
        emt.at[k, mine] = before.at[k, old[mine]]
    return emt


def _refuse_past(parameters: Parameters, t: float, emt: Emt, cells: Cells) -> None:
    """Refuse an event that has not begun but should have; at t = 0 none has."""
    for i in np.flatnonzero(cells.emt >= 0):
        name = parameters.type_names[cells.kind[i]]
        section = parameters.emt if name in UNNAMED else parameters.types.named()[name]
        for event, times in zip(events(), emt.at, strict=True):
            time, key = times[cells.emt[i]], f"{_section(name)}.{event.name}"
            if time <= t and not cells.events[i] & bit(event.name):
                raise InvalidProblem(
                    f'{key} = "{getattr(section, event.name, Timing())}": must be after the time of the start, '
                    f"t = {t:g} h, for cell {cells.id[i]}, in which it has not begun; this seed draws {time:g} h"
                )
