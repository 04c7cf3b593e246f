"""The cells of a tissue as a structure of arrays, one entry per cell, in the order of the cells along the tissue."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tissue.plugins import Parameter, Variable

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

# What users registered, by name: numbers of each cell, of which the k-th is row k of ``Cells.own``, and numbers of all.
VARIABLES: dict[str, Variable] = {}
PARAMETERS: dict[str, Parameter] = {}


class Cells(NamedTuple):
    """State of each cell; lengths in units of R_soft, times in hours.

    All arrays have the same length: the number of cells, or in a running kernel a capacity of which the first n
    entries are in use. Neighbours in the tissue are neighbours in the arrays.
    """

    x: Floats  # nucleus X = (x, y)
    y: Floats
    ax: Floats  # apical point A
    ay: Floats
    bx: Floats  # basal point B; by stays 0 while the point is on the basal line: one unknown, not two
    by: Floats
    rest_ax: Floats  # eta_ax (3.2): rest length of the apical spring, without the radius R_soft
    rest_bx: Floats  # eta_bx (3.3)
    rest_aa: Floats  # eta_aa (3.6): of the junction to the next cell of the apical layer, or of its chain
    stiff_ax: Floats  # alpha_ax, alpha_bx, alpha_axb
    stiff_bx: Floats
    stiff_axb: Floats
    stiff_aa: Floats  # alpha_aa: a junction has the mean of its two cells
    radius: Floats  # R_hard
    birth: Floats  # t_birth
    cycle: Floats  # t_cycle (3.1)
    moves: Flags  # whether the nucleus migrates before mitosis (INM)
    divides: Flags  # whether the end of the cycle may bring a second daughter
    id: Integers  # never used again for another cell
    mother: Integers  # id of the cell it split from, -1 for a cell of the start
    emt: Integers  # number among the EMT cells, its place in Emt; -1 for a control cell
    events: Integers  # the EMT events that have begun, a sum of bits, see ``tissue.events.known.bit``
    chain: Integers  # 0, or the number of a chain of apical points apart from the layer: id + 1 of its first cell
    along: Floats  # arclength of the basal point, where the layer bends and holds it; on a line bx says it
    kind: Integers  # CONTROL, EMT, or the number of a named type from NAMED on
    z: Floats  # in three dimensions the third coordinates of X, A and B; in the plane all are 0
    az: Floats
    bz: Floats
    own: Floats  # (variables, n): the variables that users registered, each also a field of its name

    @staticmethod
    def entries() -> dict[str, tuple[str, int]]:
        """Return the names of variables, which kernels read as fields."""
        return {name: ("own", k) for k, name in enumerate(VARIABLES)}

    def __getattr__(self, name: str) -> Any:
        """Return a variable of users, (n,)."""
        if name in VARIABLES:
            return self.own[list(VARIABLES).index(name)]
        raise AttributeError(f"a cell has no field {name!r}")


# The types of cells, see ``Cells.kind``: the first named one has the number NAMED.
CONTROL, EMT, NAMED = range(3)
# The fields of Cells that are coordinates in the plane, and the third ones.
COORDINATES = Cells._fields[:6]
DEPTHS = ("z", "az", "bz")


class CellLayers(NamedTuple):
    """Which cells hold on to which neighbour: indices into Cells, increasing, so from left to right."""

    apical: Integers  # (na,): junctions join consecutive entries (3.5)
    basal: Integers  # (nb,): consecutive entries are ordered and at most max_basal_distance apart (3.15)


class Emt(NamedTuple):
    """The EMT cells, one entry for each: the times of their events and what came of them.

    First those of the start, from left to right, then daughters as they come. Of two daughters the left one keeps the
    entry of the mother, and the other one has a copy of it.
    """

    at: Floats  # (events, m): when the events begin [h], in the order of their bits; inf for never
    new: Integers  # the bits of those that begin in this dt
    onset_ab: Floats  # y_AB when the first event began (4.8), inf before
    side: Integers  # where the nucleus is: -1 below the basal layer, 1 above the apical layer, else 0  (4.3)
    since: Floats  # since when it has been there [h]; of side 0 not kept


# The kinds of the fields that are not numbers.
DTYPES = {
    **dict.fromkeys(("moves", "divides"), np.bool_),
    **dict.fromkeys(("id", "mother", "emt", "events", "chain", "kind"), np.int64),
}


def empty(capacity: int) -> Cells:
    """Control cells of length ``capacity``, all else zero."""
    cells = Cells(
        **{name: np.zeros(capacity, DTYPES.get(name, np.float64)) for name in Cells._fields[:-1]},
        own=np.array([np.full(capacity, one.start) for one in VARIABLES.values()]).reshape(-1, capacity),
    )
    cells.emt[:] = -1
    return cells


def emt_cells(at: Floats) -> Emt:
    """EMT cells with events at these times [h], (events, m), see ``tissue.events.known.settled``."""
    m = at.shape[1]
    side, new = np.zeros((2, m), np.int64)
    return Emt(np.ascontiguousarray(at), new, np.full(m, np.inf), side, np.zeros(m))


def no_emt() -> Emt:
    """Return a tissue of control cells alone."""
    return emt_cells(np.zeros((0, 0)))


def first(cells: Cells, n: int) -> Cells:
    """Return a copy of the first n cells."""
    return Cells._make(array[..., :n].copy() for array in cells)


class Forces(NamedTuple):
    """-grad W for each cell, shape (n,): on the nucleus, the apical point and the basal point [1 / R_soft].

    ``by`` is given for all cells; the caller leaves it out for those that the basal line holds  (C3).
    """

    x: Floats
    y: Floats
    ax: Floats
    ay: Floats
    bx: Floats
    by: Floats


class PointForces(NamedTuple):
    """What forces of users add up to, (capacity,), as in ``Forces``; the last three count in space alone."""

    x: Floats
    y: Floats
    ax: Floats
    ay: Floats
    bx: Floats
    by: Floats
    z: Floats
    az: Floats
    bz: Floats
