"""The first state of a tissue: points as the parameters say, and nuclei pushed apart until none overlap."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.random import Generator

from dincl.errors import InvalidProblem
from tissue.kernels.numbers import numbers_pointer
from tissue.kernels.workspace import Workspaces
from tissue.model.cycle import set_phases
from tissue.model.discs import part
from tissue.rules.slice import in_plane
from tissue.runs.cell_groups import Crowd, control_cells, crowd_of
from tissue.state.basal_curve import LINE, BasalCurve, curve_numbers
from tissue.state.cells import Cells, Floats, Integers, empty
from tissue.state.checkpoint import Separation
from tissue.state.numbers import Numbers, StartNumbers
from tissue.state.store import Store, stored

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.checkpoint import Streams

# Overlap that counts as none [R_soft], and the sweeps that are spent on reaching it.
TOUCHING = 1e-10
MOST_SWEEPS = 10_000


def started(parameters: Parameters, random: Streams) -> tuple[Store, Separation]:
    """The first state of a run: that of ``first_state``, with the cells of its types where the parameters have them."""
    start, groups = parameters.start_numbers(), parameters.groups()
    types = Types(
        crowd_of(groups, start.cells, random), parameters.named_numbers(), [one.rest_length for one in groups]
    )
    return first_state(start, parameters.numbers(), random.start, types, parameters.curve())


class Types(NamedTuple):
    """Which cells are of which type, and what they have of their own."""

    crowd: Crowd
    numbers: Sequence[Numbers] = ()  # of the named types
    rest_lengths: Sequence[float] = ()  # of EMT cells and of the named types


def first_state(
    start: StartNumbers,
    numbers: Numbers,
    draws: Generator,
    types: Types | None = None,
    curve: BasalCurve = LINE,
) -> tuple[Store, Separation]:
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
    types = types or Types(control_cells(start.cells))
    cells = _bent(drawn_cells(start, numbers, draws, types, partial(_points, start)), curve)
    held = stored(cells, emt=types.crowd.emt(), capacity=2 * start.cells, curve=curve_numbers(curve), space=in_plane())
    set_phases(held, 0.0, numbers_pointer(numbers, types.numbers))
    return held, _part(held, start.cells, numbers)


def drawn_cells(
    start: StartNumbers,
    numbers: Numbers,
    draws: Generator,
    types: Types,
    points: Callable[[Generator], Mapping[str, Floats]],
) -> Cells:
    """Cells with drawn ages, cycles and ``points``, coordinates by name: one number gives all types theirs."""
    n, crowd = start.cells, types.crowd
    own = partial(of_kinds, crowd.kind, (numbers, numbers, *types.numbers))
    rest = np.array([start.rest_length, *types.rest_lengths])[crowd.kind]
    cycle = draws.uniform(own("min_cycle"), own("max_cycle"))
    age = draws.uniform(0.0, 1.0, n) * cycle
    coordinates: Any = points(draws)
    return empty(n)._replace(
        rest_ax=rest.copy(),
        rest_bx=rest.copy(),
        rest_aa=np.full(n, start.junction),
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
    """The coordinates of all points above a line, by the names of their arrays."""
    n = start.cells
    places: Floats = np.arange(n, dtype=np.float64) - (n - 1) / 2
    apical, basal = start.apical_spacing * places, start.basal_spacing * places
    x, y = _columns(start, basal, draws), draws.uniform(start.nuclei_low, start.nuclei_high, n)
    return {"x": x, "y": y, "ax": apical, "ay": np.full(n, start.height), "bx": basal}


def of_kinds(kind: Integers, kinds: Sequence[Numbers], name: str) -> Floats:
    """A number of each cell, that of its kind."""
    return np.array([getattr(one, name) for one in kinds])[kind]


def _bent(cells: Cells, curve: BasalCurve) -> Cells:
    """The cells above the basal layer as they were above a line."""
    if curve.pieces == 0:
        return cells
    (x, y), (ax, ay), (bx, by) = (
        curve.above(*at) for at in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by))
    )
    return cells._replace(x=x, y=y, ax=ax, ay=ay, bx=bx, by=by, along=cells.bx)


def _columns(start: StartNumbers, basal: Floats, draws: Generator) -> Floats:
    """x of the nuclei: in the box at random, in the order of the cells; near even places; or above the basal points."""
    n, width = start.cells, start.width
    if start.nuclei == "own_basal":
        return basal.copy()
    if start.nuclei == "even":
        step = width / (n + 1)
        return step * (np.arange(n) + 1) - width / 2 + draws.uniform(-step, step, n)
    return np.sort(draws.uniform(-width / 2, width / 2, n))


def _part(held: Store, n: int, numbers: Numbers) -> Separation:
    """Sweep over the pairs until none overlap."""
    cells = held.cells
    x, y = cells.x[:n].copy(), cells.y[:n].copy()
    work = Workspaces(n, 1, numbers, 0.0, held.curve).flat
    work.value.x[:n], work.value.y[:n], work.value.radius[:n] = x, y, cells.radius[:n]
    sweeps = part(work, n, TOUCHING, MOST_SWEEPS)
    if sweeps < 0:
        raise InvalidProblem(
            f"tissue.cells = {n}: more than fit: their hard discs could not be parted in {MOST_SWEEPS} sweeps; must be "
            "fewer cells, a larger box or smaller hard discs"
        )
    cells.x[:n], cells.y[:n] = work.value.x[:n], work.value.y[:n]
    return Separation(sweeps, float(np.hypot(cells.x[:n] - x, cells.y[:n] - y).max()))
