"""The first state of a tissue in space: points on a lattice, networks, and nuclei pushed apart until none overlap."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator

from dincl.errors import InvalidProblem
from tissue.kernels.numbers import numbers_pointer
from tissue.kernels.surface_workspace import SurfaceNumbers, SurfaceWorkspaces
from tissue.model.balls import part_balls
from tissue.model.cycle import set_phases
from tissue.model.lattice import Lattice
from tissue.network.start import triangulated
from tissue.rules.sheet import sheet_rules
from tissue.runs.cell_groups import crowd_of
from tissue.runs.start import MOST_SWEEPS, TOUCHING, Types, drawn_cells
from tissue.state.cells import Floats
from tissue.state.checkpoint import Separation
from tissue.state.mesh import Sheets, network_of
from tissue.state.network import Network
from tissue.state.numbers import StartNumbers
from tissue.state.space import SPATIAL, Exchange, Space
from tissue.state.store import Store, stored
from tissue.state.surface import Surface

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.checkpoint import Streams


def started_in_space(parameters: Parameters, random: Streams) -> tuple[Store, Separation]:
    """The first state of a run in space.

    Basal points stand on a lattice on the surface, apical points above them; ages are uniform on [0, own cycle]. Drawn
    nuclei overlap: sweeps of (C1) part them, so that the hard balls do not overlap by more than 1e-10.

    Raises
    ------
    InvalidProblem
        If the cells make no lattice, or the nuclei could not be parted: more cells than fit.
    """
    start, groups = parameters.start_numbers(), parameters.groups()
    lattice = parameters.lattice()
    crowd = crowd_of(groups, start.cells, random, lattice)
    types = Types(crowd, parameters.named_numbers(), [one.rest_length for one in groups])
    numbers = parameters.numbers()
    cells = drawn_cells(start, numbers, random.start, types, lambda draws: _points(start, lattice, draws))
    apical, basal = (
        np.stack([getattr(cells, name) for name in names], axis=1) for names in (("ax", "ay", "az"), ("bx", "by", "bz"))
    )
    capacity = 2 * start.cells
    networks = (
        triangulated(lattice.surface, apical, lambda d: np.full(len(d), start.junction), capacity),
        triangulated(lattice.surface, basal, np.zeros_like, capacity),
    )
    space = _space(lattice.surface, *networks, parameters.exchange())
    held = stored(cells, emt=types.crowd.emt(), capacity=capacity, space=space)
    set_phases(held, 0.0, numbers_pointer(numbers, types.numbers))
    return held, _part(held, start.cells)


def space_of(sheets: Sheets, exchange: Exchange, capacity: int) -> Space:
    """What a tissue in space goes on with from kept networks."""
    apical, basal = network_of(sheets.apical, capacity), network_of(sheets.basal, capacity)
    return _space(sheets.surface, apical, basal, exchange)


def _space(surface: Surface, apical: Network, basal: Network, exchange: Exchange) -> Space:
    return Space(SPATIAL, surface, apical, basal, exchange, sheet_rules(), np.zeros(1, np.int64))


def _points(start: StartNumbers, lattice: Lattice, draws: Generator) -> Mapping[str, Floats]:
    """The coordinates of all points by the names of their arrays."""
    low, high = start.nuclei_low, start.nuclei_high
    nuclei = lattice.nuclei(start.nuclei, draws.uniform(low, high, start.cells), draws)
    level = np.full(start.cells, start.height)
    apical, basal = lattice.above(level), lattice.above(0.0 * level)
    names = (("x", "y", "z"), ("ax", "ay", "az"), ("bx", "by", "bz"))
    return {
        name: line
        for three, points in zip(names, (nuclei, apical, basal), strict=True)
        for name, line in zip(three, points, strict=True)
    }


def _part(held: Store, n: int) -> Separation:
    """Sweep over the pairs until none overlap."""
    cells = held.cells
    work = SurfaceWorkspaces(n, 1, SurfaceNumbers(1, 0.0, 1.0), held.space.surface)
    parts, before = work.flat.value, np.stack((cells.x[:n], cells.y[:n], cells.z[:n]))
    parts.x[:n], parts.y[:n], parts.z[:n] = before
    parts.radius[:n] = cells.radius[:n]
    sweeps = part_balls(work.flat.address, work.wide.address, n, TOUCHING, MOST_SWEEPS)
    if sweeps < 0:
        raise InvalidProblem(
            f"tissue.cells = {n}: more than fit: their hard balls could not be parted in {MOST_SWEEPS} sweeps; must be "
            "fewer cells, a larger box or smaller hard balls"
        )
    cells.x[:n], cells.y[:n], cells.z[:n] = parts.x[:n], parts.y[:n], parts.z[:n]
    moved = np.stack((cells.x[:n], cells.y[:n], cells.z[:n])) - before
    return Separation(sweeps, float(np.linalg.norm(moved, axis=0).max()))
