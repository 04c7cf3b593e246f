"""The first state of a tissue: points as the parameters say, networks, and nuclei pushed apart until none overlap."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.random import Generator

from dincl.errors import InvalidProblem
from tissue.files.groups import Crowd, control_cells, crowd_of
from tissue.kernels.surface_workspace import SurfaceWorkspaces
from tissue.kernels.workspace import Workspaces
from tissue.model.balls import separate_all_balls
from tissue.model.cycle import set_phases
from tissue.model.discs import separate_all
from tissue.network.lattice import Lattice
from tissue.network.neighbours import connected
from tissue.rules.sheet import sheet_rules
from tissue.rules.slice import in_plane
from tissue.state.basal_curve import LINE, BasalCurve, CurveNumbers, curve_numbers
from tissue.state.cells import Cells, Floats, Integers, empty
from tissue.state.numbers import Numbers, StartNumbers, numbers_pointer
from tissue.state.running import STRAIGHT, TissueState, new_state
from tissue.state.space import FLAT, SPATIAL, Sheets, Space, network_of

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.checkpoint import Streams

# Overlap that counts as none [R_soft], and the sweeps that are spent on reaching it.
TOUCHING = 1e-10
MOST_SWEEPS = 10_000


def started(parameters: Parameters, random: Streams) -> TissueState:
    """Make the first state of a run, with the cells of its types where the parameters have them.

    Raises
    ------
    InvalidProblem
        If the cells make no lattice, or the nuclei could not be separated: more cells than fit.
    """
    start, groups = parameters.start_numbers(), parameters.groups()
    lattice = parameters.lattice() if parameters.in_space else None
    crowd = crowd_of(groups, start.cells, random, lattice)
    types = CellTypes(crowd, parameters.named_numbers(), [one.initial_rest_length for one in groups])
    if lattice is None:
        return first_state(start, parameters.numbers(), random.start, types, parameters.curve())
    return first_sheet(start, parameters.numbers(), random.start, types, lattice, parameters.longest_edge())


class CellTypes(NamedTuple):
    """Which cells are of which type, and what they have of their own."""

    crowd: Crowd
    numbers: Sequence[Numbers] = ()  # of the named types
    rest_lengths: Sequence[float] = ()  # of EMT cells and of the named types


def first_state(
    start: StartNumbers,
    numbers: Numbers,
    draws: Generator,
    types: CellTypes | None = None,
    curve: BasalCurve = LINE,
) -> TissueState:
    """Draw a tissue and make it feasible; ``types``: of its cells, all control cells if it is None.

    Apical and basal points stand on straight lines, evenly spaced and centred; ages are uniform on [0, own cycle]. What
    is drawn at (x, y) above a line is put at the height y above arclength x of the basal layer, where that bends.
    Drawn nuclei overlap: sweeps of (C1) part them, so that the hard discs do not overlap by more than 1e-10. Neighbours
    in the basal layer are as far apart as the parameters say, which these ensure to be feasible.

    Raises
    ------
    InvalidProblem
        If the nuclei could not be parted: more cells than fit.
    """
    types = types or CellTypes(control_cells(start.cells))
    cells = _bent(drawn_cells(start, numbers, draws, types, partial(_points, start)), curve)
    return _separated(cells, start, numbers, types, curve_numbers(curve), in_plane())


def first_sheet(
    start: StartNumbers,
    numbers: Numbers,
    draws: Generator,
    types: CellTypes,
    lattice: Lattice,
    longest: float,
) -> TissueState:
    """Draw a tissue on a surface and make it feasible.

    Basal points stand on a lattice on the surface, apical points above them; all else is as of ``first_state``.
    ``longest``: edge at a free boundary, see ``Parameters.longest_edge``.
    """
    cells = drawn_cells(start, numbers, draws, types, partial(_points_above, start, lattice))
    apical, basal = np.stack((cells.ax, cells.ay, cells.az), axis=1), np.stack((cells.bx, cells.by, cells.bz), axis=1)
    surface, capacity = lattice.surface, 2 * start.cells
    networks = (
        connected(surface, apical, start.new_junction, longest, capacity),
        connected(surface, basal, 0.0, longest, capacity),
    )
    space = Space(SPATIAL, surface, *networks, sheet_rules(), longest)
    return _separated(cells, start, numbers, types, STRAIGHT, space)


def space_of(sheets: Sheets, longest: float, capacity: int) -> Space:
    """Make what a tissue in space goes on with from kept networks; ``longest`` edge of the parameters."""
    apical, basal = network_of(sheets.apical, capacity), network_of(sheets.basal, capacity)
    return Space(SPATIAL, sheets.surface, apical, basal, sheet_rules(), longest)


def drawn_cells(
    start: StartNumbers,
    numbers: Numbers,
    draws: Generator,
    types: CellTypes,
    points: Callable[[Generator], Mapping[str, Floats]],
) -> Cells:
    """Return cells with drawn ages, cycles and ``points``, coordinates by name: one number gives all types theirs."""
    n, crowd = start.cells, types.crowd
    own = partial(of_kinds, crowd.kind, (numbers, numbers, *types.numbers))
    rest = np.array([start.initial_rest_length, *types.rest_lengths])[crowd.kind]
    cycle = draws.uniform(own("min_cycle"), own("max_cycle"))
    age = draws.uniform(0.0, 1.0, n) * cycle
    coordinates: Any = points(draws)
    return empty(n)._replace(
        rest_ax=rest.copy(),
        rest_bx=rest.copy(),
        rest_aa=np.full(n, start.new_junction),
        stiff_ax=own("alpha_ax"),
        stiff_bx=own("alpha_bx"),
        stiff_axb=own("alpha_axb"),
        stiff_aa=own("alpha_aa"),
        radius=own("hard_radius"),
        birth=-age,
        cycle=cycle,
        moves=crowd.moves,
        divides=crowd.divides,
        id=np.arange(n),
        mother=np.full(n, -1),
        emt=crowd.numbers(),
        kind=crowd.kind,
        **coordinates,
    )


def _points(start: StartNumbers, draws: Generator) -> Mapping[str, Floats]:
    """Return the coordinates of all points above a line, by the names of their arrays."""
    n = start.cells
    places: Floats = np.arange(n, dtype=np.float64) - (n - 1) / 2
    apical, basal = start.apical_spacing * places, start.basal_spacing * places
    x, y = _columns(start, basal, draws), draws.uniform(start.nuclei_low, start.nuclei_high, n)
    return {"x": x, "y": y, "ax": apical, "ay": np.full(n, start.height), "bx": basal}


def _points_above(start: StartNumbers, lattice: Lattice, draws: Generator) -> Mapping[str, Floats]:
    """Compute the coordinates of all points above a lattice, by the names of their arrays."""
    nuclei = lattice.nuclei(start.nuclei, draws.uniform(start.nuclei_low, start.nuclei_high, start.cells), draws)
    level = np.full(start.cells, start.height)
    apical, basal = lattice.above(level), lattice.above(0.0 * level)
    points = (("", nuclei), ("a", apical), ("b", basal))
    return {letter + axis: line for letter, at in points for axis, line in zip("xyz", at, strict=True)}


def of_kinds(kind: Integers, kinds: Sequence[Numbers], name: str) -> Floats:
    """Return a number of each cell, that of its kind."""
    return np.array([getattr(one, name) for one in kinds])[kind]


def _bent(cells: Cells, curve: BasalCurve) -> Cells:
    """Return the cells above the basal layer as they were above a line."""
    if curve.pieces == 0:
        return cells
    (x, y), (ax, ay), (bx, by) = (
        curve.above(*at) for at in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by))
    )
    return cells._replace(x=x, y=y, ax=ax, ay=ay, bx=bx, by=by, along=cells.bx)


def _columns(start: StartNumbers, basal: Floats, draws: Generator) -> Floats:
    """Compute x of the nuclei: in the box at random, in the order of the cells; near even places; or above the basal
    points.
    """
    n, width = start.cells, start.width
    if start.nuclei == "own_basal":
        return basal.copy()
    if start.nuclei == "even":
        step = width / (n + 1)
        return step * (np.arange(n) + 1) - width / 2 + draws.uniform(-step, step, n)
    return np.sort(draws.uniform(-width / 2, width / 2, n))


def _separated(
    cells: Cells, start: StartNumbers, numbers: Numbers, types: CellTypes, curve: CurveNumbers, space: Space
) -> TissueState:
    """Store the cells and sweep over their pairs until no nuclei overlap."""
    state = new_state(cells, emt=types.crowd.emt(), capacity=2 * start.cells, curve=curve, space=space)
    set_phases(state, 0.0, numbers_pointer(numbers, types.numbers))
    n, in_plane = start.cells, space.dimension == FLAT
    sweep, axes = (separate_all, "xy") if in_plane else (separate_all_balls, "xyz")
    workspaces: Any = Workspaces(n, 1, [[numbers]], np.zeros(1), curve)
    if not in_plane:
        workspaces = SurfaceWorkspaces(n, 1, space.surface)
    work = workspaces.flat.value
    for axis in axes:
        getattr(work, axis)[:n] = getattr(state.cells, axis)[:n]
    work.radius[:n] = state.cells.radius[:n]
    if sweep(workspaces.flat.address, workspaces.wide.address, n, TOUCHING, MOST_SWEEPS) < 0:
        raise InvalidProblem(
            f"tissue.cells = {n}: more than fit: their hard discs could not be separated in {MOST_SWEEPS} sweeps; must "
            "be fewer cells, a larger box or smaller hard discs"
        )
    for axis in axes:
        getattr(state.cells, axis)[:n] = getattr(work, axis)[:n]
    return state
