"""The state of a running tissue in one place of memory: cells and layers with room to grow, and what its rules know."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import StructPointer, reader, struct_type
from tissue.state.basal_curve import LINE, CurveNumbers, curve_numbers
from tissue.state.cells import (
    DTYPES,
    VARIABLES,
    CellLayers,
    Cells,
    Emt,
    Flags,
    Floats,
    Integers,
    PointForces,
    emt_cells,
    first,
    no_emt,
)
from tissue.state.space import FLAT, Space, no_space, with_room

# Places in TissueState.sizes
CELLS, APICAL, BASAL, NEXT_ID, EMT_CELLS, JUMPED = range(6)
# What is counted, and where in TissueState.counts
COUNTERS = ("substeps", "corrections", "basal_corrections", "divisions")
SUBSTEPS, CORRECTIONS, BASAL_CORRECTIONS, DIVISIONS = range(len(COUNTERS))
STRAIGHT = curve_numbers(LINE)


class BasalMotion(NamedTuple):
    """How the basal points move in a substep, (capacity,)."""

    moves: Floats  # whether forces move the basal point: 1, or 0 for one that moves by itself (4.1)
    held: Floats  # whether the basal layer holds it: 1 or 0
    runs: Floats  # how far a basal point that moves by itself goes in a substep


class Daughters(NamedTuple):
    """Draws for the second daughter of each cell that splits in this dt, (capacity,)."""

    cycle: Floats  # 0 for a cell that does not split
    turn: Floats  # the direction in which daughters on a surface part, as a part of a whole turn
    part: Floats  # (variables,): of the variables of users a daughter has part x + fresh
    fresh: Floats


class Blocks(NamedTuple):
    """The arrays of the cells again, one a row, by kind: where a cell is copied."""

    floats: Floats
    flags: Flags
    integers: Integers


class StateArrays(NamedTuple):
    """State as kernels see it; of each array of ``cells``, ``layers``, ``emt`` the first ``sizes`` are in use."""

    cells: Cells
    layers: CellLayers
    emt: Emt  # with room for as many as there may be cells, if there are EMT cells
    # Number of cells, of cells in the apical and in the basal layer, next id, number of EMT cells; 1 + id of a cell
    # that jumped, see ``tissue.step.copies.find_jump``, else 0
    sizes: Integers
    motion: BasalMotion
    blocks: Blocks
    daughters: Daughters
    noise_key: Integers  # (2,): of the noise in substeps, see ``tissue.model.noise``
    counts: Integers  # one for each of COUNTERS
    curve: CurveNumbers  # the basal layer
    on: PointForces  # what forces of users do in a substep
    space: Space  # what there is in three dimensions besides
    clock: Floats  # (1,): the end of the present step dt [h], for functions of users, which read it as ``t``

    @staticmethod
    def entries() -> dict[str, tuple[str, int]]:
        """Return the names that kernels read as fields."""
        return {"t": ("clock", 0)}


class TissueState(StructPointer):
    """A running tissue, with the attributes of ``StateArrays``. Kernels take it, or find it at its address.

    For Python ``emt`` has those EMT cells alone that there are.
    """

    def __init__(self, parts: StateArrays) -> None:
        super().__init__(parts, STATE)
        (
            self.cells,
            self.layers,
            self._emt,
            self.sizes,
            self.motion,
            self.blocks,
            self.daughters,
            self.noise_key,
            self.counts,
            self.curve,
            self.on,
            self.space,
            self.clock,
        ) = parts

    @property
    def emt(self) -> Emt:
        """The EMT cells, which can be written to."""
        return Emt._make(array[..., : self.sizes[EMT_CELLS]] for array in self._emt)


def new_state(
    cells: Cells,
    layers: CellLayers | None = None,
    next_id: int | None = None,
    emt: Emt | None = None,
    *,
    capacity: int,
    curve: CurveNumbers = STRAIGHT,
    space: Space,
) -> TissueState:
    """Return a state with room for ``capacity`` cells at least, all cells in both layers if none are given.

    Its counters are zero.
    """
    n, capacity = len(cells.x), max(2, capacity)
    layers = layers or CellLayers(np.arange(n), np.arange(n))
    parts = _room(capacity, _emt_with_room(emt or no_emt(), capacity), curve, with_room(space, capacity))
    for mine, array in zip(parts.cells, cells, strict=True):
        mine[..., :n] = array
    parts.layers.apical[: len(layers.apical)] = layers.apical
    parts.layers.basal[: len(layers.basal)] = layers.basal
    parts.sizes[:] = n, len(layers.apical), len(layers.basal), 0, 0 if emt is None else len(emt.side), 0
    parts.sizes[NEXT_ID] = int(cells.id.max(initial=-1)) + 1 if next_id is None else next_id
    parts.motion.moves[:n] = 1.0
    parts.motion.held[layers.basal] = 1.0
    return TissueState(parts)


def _emt_with_room(emt: Emt, capacity: int) -> Emt:
    """Return the EMT cells with room for daughters, whose events never begin; without any there is none."""
    m = len(emt.side)
    if m == 0:
        return emt
    larger = emt_cells(np.full((len(emt.at), capacity), np.inf))
    for mine, theirs in zip(larger, emt, strict=True):
        mine[..., :m] = theirs
    return larger


def _room(capacity: int, emt: Emt, curve: CurveNumbers, space: Space) -> StateArrays:
    """Make empty arrays."""
    kinds: list[Any] = [DTYPES.get(name, np.float64) for name in Cells._fields[:-1]]
    kinds += [np.float64] * len(VARIABLES)
    made = {kind: np.zeros((kinds.count(kind), capacity), kind) for kind in (np.float64, np.bool_, np.int64)}
    lines = {kind: iter(block) for kind, block in made.items()}
    own = made[np.float64][kinds.count(np.float64) - len(VARIABLES) :]
    cells = Cells._make([*(next(lines[kind]) for kind in kinds[: len(Cells._fields) - 1]), own])
    blocks: Any = Blocks._make(made.values())
    layers = CellLayers(*np.zeros((2, capacity), np.int64))
    motion = BasalMotion(*np.zeros((3, capacity)))
    sizes, key, counts = np.zeros(6, np.int64), np.zeros(2, np.int64), np.zeros(len(COUNTERS), np.int64)
    on = PointForces(*np.zeros((len(PointForces._fields), capacity)))
    heirs = np.array([one.heirs for one in VARIABLES.values()]).reshape(-1, 2).T.copy()
    daughters = Daughters(*np.zeros((2, capacity)), *heirs)
    return StateArrays(cells, layers, emt, sizes, motion, blocks, daughters, key, counts, curve, on, space, np.zeros(1))


_EXAMPLE = _room(2, no_emt(), STRAIGHT, no_space())
STATE = struct_type(_EXAMPLE)
# The state at an address, inside of kernels.
state_at = reader(_EXAMPLE)

# What kernels must be able to do: slices above a line, any slice, any tissue. As numba knows the length of a tuple, it
# compiles what this takes, and no more.
Kind = tuple[int, ...]
ON_LINE, ON_CURVE, IN_SPACE = range(3)
ANY = (0,) * IN_SPACE


def kind_of(*states: TissueState) -> Kind:
    """Return as many zeros as the kind of these tissues."""
    if any(state.space.dimension != FLAT for state in states):
        return ANY
    return (0,) * (ON_CURVE if any(state.curve.bent for state in states) else ON_LINE)


def copied(emt: Emt) -> Emt:
    """Return the EMT cells as they are now; without any the same empty arrays."""
    return Emt._make(array.copy() for array in emt) if len(emt.side) else emt


def grown(state: TissueState) -> TissueState:
    """Return the same cells and counters with twice the room."""
    larger = new_state(
        *contents(state),
        int(state.sizes[NEXT_ID]),
        state.emt,
        capacity=2 * len(state.cells.x),
        curve=state.curve,
        space=state.space,
    )
    larger.counts[:], larger.clock[:], larger.sizes[JUMPED] = state.counts, state.clock, state.sizes[JUMPED]
    return larger


def contents(state: TissueState) -> tuple[Cells, CellLayers]:
    """Copy the cells and layers in use."""
    n, apical, basal = state.sizes[CELLS], state.sizes[APICAL], state.sizes[BASAL]
    return first(state.cells, n), CellLayers(state.layers.apical[:apical].copy(), state.layers.basal[:basal].copy())
