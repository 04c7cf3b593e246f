"""The groups of cells of a run that are not control cells: how many, which cells, and when their events begin."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.random import Generator, default_rng

from tissue.events.known import OF_THESIS, events, settled
from tissue.files.quantities import Timing
from tissue.files.sections import APART, SCATTERED
from tissue.state.cells import CONTROL, EMT, Emt, Flags, Floats, Integers, emt_cells

if TYPE_CHECKING:
    from tissue.network.lattice import Lattice
    from tissue.state.checkpoint import Streams

# Parts of a cell by which a place is off that is computed.
OFF = 1e-9


class CellGroup(NamedTuple):
    """The EMT cells or those of a named type; made from the parameters of a file by ``Parameters.groups``."""

    name: str
    cells: int  # N^EMT
    inm: float  # probability of interkinetic nuclear movement
    times: Mapping[str, Timing]  # of the events by name; the others never begin
    place: float | str  # of the middle of the group, as a part of the tissue from left to right; or APART, SCATTERED
    divides: bool
    may_leave: bool  # whether its cells have events, and so are EMT cells
    initial_rest_length: float  # eta of both cytoskeleton springs at the start, without the radius R_soft

    @property
    def section(self) -> str:
        """Its section in a parameter file."""
        return self.name if self.name == "emt" else f"types.{self.name}"


def first_of(cells: int, group: int, place: float) -> int:
    """Find the first cell of a group whose middle is nearest to this part of the tissue, with all cells inside.

    So groups at the places p and 1 - p mirror each other. Of two cells as near it is the outer one; for a group that
    cannot be in the very middle, the one on the left.
    """
    exact, middle = place * cells - group / 2, (cells - group) / 2
    nearest = math.floor(exact + 0.5 + OFF) if exact > middle + OFF else math.ceil(exact - 0.5 - OFF)
    return min(max(0, nearest), cells - group)


def drawn(group: CellGroup, draws: Generator) -> tuple[Floats, Flags]:
    """Draw when the events of the cells of a group begin [h], (events, m), and whether each cell has INM, (m,).

    The random numbers of [A], [B], [S] and [P] are drawn whether they are needed or not, and those of any other event
    are a function of the seed and of its name: runs of one seed and other chances have the same.
    """
    inm, *pairs = draws.random((1 + 2 * len(OF_THESIS), group.cells))
    chances = dict(zip(OF_THESIS, zip(pairs[::2], pairs[1::2], strict=True), strict=True))
    if others := group.times.keys() - chances.keys():
        key = int(draws.integers(1 << 63))
        for name in others:
            chances[name] = tuple(default_rng([key, *name.encode()]).random((2, group.cells)))
    times = {name: group.times.get(name, Timing()).times(*pair) for name, pair in chances.items()}
    return settled(times), inm < group.inm


class Crowd(NamedTuple):
    """Properties of each cell of a tissue by its type; (n,), or (events, n)."""

    kind: Integers
    moves: Flags
    divides: Flags
    may_leave: Flags  # whether it is an EMT cell
    times: Floats  # when its events begin [h]

    def emt(self) -> Emt:
        """Return the EMT cells, from left to right."""
        return emt_cells(self.times[:, self.may_leave])

    def numbers(self) -> Integers:
        """Number the EMT cells: of each cell its number among them, -1 for none."""
        return np.where(self.may_leave, np.cumsum(self.may_leave) - 1, -1)


def control_cells(n: int) -> Crowd:
    """Compute n of them: they have INM, and divide."""
    yes, no = np.ones(n, np.bool_), np.zeros(n, np.bool_)
    return Crowd(np.full(n, CONTROL), yes, yes.copy(), no, np.full((len(events()), n), np.inf))


def crowd_of(groups: Sequence[CellGroup], n: int, random: Streams, lattice: Lattice | None = None) -> Crowd:
    """Return the types of n cells: each group at its place, then those that are apart or scattered, in their order.

    In space the lattice knows where the cells are, and a group has those nearest to its place that are free. What a
    named type is drawn is a function of the seed, its name and its chances, whatever other types there are.
    """
    crowd, key = control_cells(n), int(random.types.integers(1 << 63))
    # Of each group the generators of its events, and of the places of scattered cells.
    own = [(random.emt, random.emt), *(default_rng([key, *one.name.encode()]).spawn(2) for one in groups[1:])]
    draws = [drawn(group, chances) for group, (chances, _) in zip(groups, own, strict=True)]
    for anywhere in (False, True):
        for kind, (group, (times, moves), (_, places)) in enumerate(zip(groups, draws, own, strict=True), EMT):
            if anywhere == isinstance(group.place, str):
                cells = _chosen(crowd, group, places, lattice)
                crowd.kind[cells], crowd.moves[cells], crowd.divides[cells] = kind, moves, group.divides
                crowd.may_leave[cells], crowd.times[:, cells] = group.may_leave, times
    return crowd


def _chosen(crowd: Crowd, group: CellGroup, places: Generator, lattice: Lattice | None) -> Integers:
    """Return the cells of a group, from left to right."""
    m, free = group.cells, np.flatnonzero(crowd.kind == CONTROL)
    if group.place == SCATTERED:
        return np.sort(places.permutation(free)[:m])
    if group.place == APART and lattice is None:
        # In the middle of m equal parts of the row; of two such cells the outer one.
        odd = 2 * np.arange(m) + 1
        return free[(len(free) * odd - (odd < m)) // max(1, 2 * m)]
    if lattice is None:
        return first_of(len(crowd.kind), m, float(group.place)) + np.arange(m)
    if group.place == APART:
        return lattice.apart(free, m)
    listed = lattice.by_distance(float(group.place))
    return np.sort(listed[crowd.kind[listed] == CONTROL][:m])


def never_begun(groups: Iterable[CellGroup], end: float) -> list[str]:
    """Return a sentence for each event that no run begins: it ends before [h], or [emt] has no cells.

    Named types may have none at the start: events make cells of them.
    """
    found: dict[str, None] = {}
    for group in groups:
        for event in events():
            time, why = group.times.get(event.name, Timing()), ""
            if group.cells and end < time.low:
                why = f'numerics.t_end = "{end:g} h"'
            elif not group.cells and group.section == "emt":
                why = "emt.cells = 0"
            if time.ever and why:
                found[f'[{event.mark}] never begins: {group.section}.{event.name} = "{time}", and {why}'] = None
    return list(found)
