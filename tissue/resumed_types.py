"""The types of the cells of a run that goes on, and what its EMT cells keep of their past."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import InvalidProblem
from tissue.events.known import bit, events, row
from tissue.files.cell_types import UNNAMED
from tissue.files.timing import Timing
from tissue.files.type_rules import broken_groups
from tissue.groups import Crowd, Draws, control_cells, crowd_of, drawn_for, give
from tissue.space.lattice import Lattice
from tissue.state.cells import CONTROL, EMT, Cells, Emt, Flags, Integers, emt_cells

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.checkpoint import TissueCheckpoint
    from tissue.state.frame import Frame
    from tissue.state.streams import Streams


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
    """The EMT cells in the order of the numbers that they had, then those that had none, from left to right."""
    found = np.flatnonzero(among)
    return found[np.lexsort((found, was[found], was[found] < 0))]


def _kinds(parameters: Parameters, cells: Cells, past: TissueCheckpoint) -> Integers:
    """The types of the cells by their numbers in the parameters."""
    names, mine = (*UNNAMED, *past.types), parameters.type_names
    for kind in np.unique(cells.kind):
        if names[kind] not in mine:
            count = int((cells.kind == kind).sum())
            raise InvalidProblem(f"types.{names[kind]} is missing: must be there, {count} cells of the start are of it")
    return np.array([mine.index(name) if name in mine else CONTROL for name in names])[cells.kind]


def _placed(parameters: Parameters, start: Frame, cells: Cells, random: Streams) -> Crowd:
    """The groups where the parameters have them."""
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
    """The cells with the types that they have."""
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
    """Those of a type that divides which are not daughters of others: EMT cells have the first ``count`` numbers."""
    if len(mine) and cells.emt[mine].min() >= 0:
        return mine[:count]
    return mine[~np.isin(cells.mother[mine], cells.id[mine])]


def _descent(cells: Cells, mine: Integers, first: Integers) -> list[int]:
    """Of each cell of a type the place of the one among the ``first`` that it descends from."""
    place = {name: k for k, name in enumerate(cells.id[first])}
    mother = dict(zip(cells.id, cells.mother, strict=True))

    def descends(name: int) -> int:
        return place[name] if name in place else descends(mother[name])

    return [descends(name) for name in cells.id[mine]]


def _section(name: str) -> str:
    """The table of a type in files."""
    return name if name in UNNAMED else f"types.{name}"


def _with_past(emt: Emt, before: Emt, old: Integers, begun: Integers) -> Emt:
    """The EMT cells with these times for what has not begun, and all else as before.

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
