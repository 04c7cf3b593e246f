"""Which cells are of which type, and what these are drawn: [emt] in the middle, named types at their places."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.random import Generator, default_rng

from tissue.events.known import events
from tissue.files.cell_types import APART, SCATTERED, first_of
from tissue.files.scenario import CellGroup, drawn
from tissue.state.cells import CONTROL, EMT, Emt, Flags, Floats, Integers, emt_cells

if TYPE_CHECKING:
    from tissue.model.lattice import Lattice
    from tissue.state.checkpoint import Streams


class Draws(NamedTuple):
    """Draws of the cells of a group."""

    times: Floats  # (events, m): when events begin [h]
    moves: Flags  # (m,): whether they have INM
    places: Generator  # of those that are scattered


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


def drawn_for(groups: Sequence[CellGroup], random: Streams) -> list[Draws]:
    """Draw the events of each group; those of a named type are a function of the seed, its name and its scenario.

    So runs of one seed have the same whatever other types there are.
    """
    first, *named = groups
    emt, moves = drawn(first.scenario, random.emt)
    found = [Draws(emt.at, moves, random.emt)]
    key = int(random.types.integers(1 << 63))
    for group in named:
        chances, places = default_rng([key, *group.name.encode()]).spawn(2)
        emt, moves = drawn(group.scenario, chances)
        found.append(Draws(emt.at, moves, places))
    return found


def control_cells(n: int) -> Crowd:
    """Compute n of them: they have INM, and divide."""
    yes, no = np.ones(n, np.bool_), np.zeros(n, np.bool_)
    return Crowd(np.full(n, CONTROL), yes, yes.copy(), no, np.full((len(events()), n), np.inf))


def crowd_of(groups: Sequence[CellGroup], n: int, random: Streams, lattice: Lattice | None = None) -> Crowd:
    """Return the types of n cells: each group at its place, then those that are apart or scattered, in their order.

    In space the lattice knows where the cells are, and a group has those nearest to its place that are free.
    """
    crowd, draws = control_cells(n), drawn_for(groups, random)
    for anywhere in (False, True):
        for kind, (group, draw) in enumerate(zip(groups, draws, strict=True), EMT):
            if anywhere == isinstance(group.place, str):
                give(crowd, _chosen(crowd, group, draw, lattice), kind, group, draw)
    return crowd


def give(crowd: Crowd, cells: Integers, kind: int, group: CellGroup, draw: Draws) -> None:
    """Make these cells those of a group."""
    crowd.kind[cells], crowd.moves[cells], crowd.divides[cells] = kind, draw.moves, group.divides
    crowd.may_leave[cells], crowd.times[:, cells] = group.may_leave, draw.times


def _chosen(crowd: Crowd, group: CellGroup, draw: Draws, lattice: Lattice | None) -> Integers:
    """Return the cells of a group, from left to right."""
    m, free = group.scenario.cells, np.flatnonzero(crowd.kind == CONTROL)
    if group.place == SCATTERED:
        return np.sort(draw.places.permutation(free)[:m])
    if group.place == APART:
        return _middles(free, m) if lattice is None else lattice.apart(free, m)
    if lattice is not None:
        listed = lattice.by_distance(float(group.place))
        return np.sort(listed[crowd.kind[listed] == CONTROL][:m])
    return first_of(len(crowd.kind), m, float(group.place)) + np.arange(m)


def _middles(row: Integers, m: int) -> Integers:
    """Return the cells in the middle of m equal parts of a row; of two such cells the outer one."""
    odd = 2 * np.arange(m) + 1
    return row[(len(row) * odd - (odd < m)) // max(1, 2 * m)]
