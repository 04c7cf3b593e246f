"""A tissue whose rules and neighbours stand still, as a differential inclusion that dincl takes; of any dimension."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dincl.checks import instance, number, within
from dincl.constraints import Constraint, MaxDistance, NonOverlap, Ordered
from dincl.errors import InvalidProblem
from dincl.problem import Problem
from dincl.projection import Projection
from dincl.projection.feasible import project
from tissue.frames.frame import Frame
from tissue.model.energy import forces
from tissue.state.cells import CellLayers, Cells, Floats, Forces, first
from tissue.state.mesh import Sheets
from tissue.state.numbers import Numbers
from tissue.state.surface import PLANE
from verification.thesis.quasi_steady.flow import Rates, flow

# The letters of nuclei, apical and basal points in the names of their coordinates.
POINTS = ("", "a", "b")


def frozen_problem(cells: Cells, layers: CellLayers, numbers: Numbers) -> Problem:
    """mu dZ/dt in -grad W(Z) - N(S, Z): the tissue between two updates of its rules, without noise.

    Source: section 3.2 of chapter 3.

    The 3n particles are the nuclei, then the apical points, then the basal points, each in the order of the cells; the
    way back is ``cells_at``. A basal point of the basal layer has y = 0 and no velocity in y: (C3) by construction.

    Parameters
    ----------
    cells
        The start, with the rest lengths, stiffnesses and radii that stay [R_soft]; copied.
    layers
        The junctions and the basal layer; they stay, too.
    numbers
        ``mu`` [h], ``max_basal_distance``, and the constants of the energy.

    Raises
    ------
    InvalidProblem
        For a start outside of S, a basal point of the layer off the line, a state that has no forces.

    Notes
    -----
    Right after a division the daughters overlap; from such a state there is no solution, and it is refused. Made all
    the same, a step of a scheme parts them at once, however short it is. In 60 settled cells, after the division of one
    into two that are 0.02 apart, R_hard = 1/3, six seeds, h = 1e-6:

    - ``PBD``: the daughters jump by half the overlap, 0.323, along the line between them, and push what they meet in
      the order of the sweep: about 30 pairs are left overlapping, the worst by 0.06 to 0.30, for later sweeps to part.
    - ``CatchUp``: no overlap; a nearest state of S, as by ``made_feasible``, of which there are several. The daughters
      part where there is room, 36 to 88 degrees off their line; the longest move is 0.33 to 0.43.
    - ``LinearisedCatchUp``, ``MidpointCatchUp``: no overlap; the daughters part along their line, up to 30
      degrees off it, and neighbours give way; the longest move is 0.32 to 0.40.

    From one of these kinds of state to another it is 0.1 to 0.7. So schemes agree on the motion after a division only
    if they start from one state of S.
    """
    of_a_frame(cells, layers, numbers)
    frozen, network = first(cells, len(cells.x)), CellLayers(layers.apical.copy(), layers.basal.copy())
    mu = number("mu", numbers.mu, positive=True)
    sets = constraints(frozen, network, numbers)
    held = 2 * len(frozen.x) + network.basal

    def drift(t: float, x: Floats) -> Floats:
        velocity = particles(forces(cells_at(x, frozen, network), network, numbers)) / mu
        velocity[held, 1] = 0.0
        return velocity

    return Problem(particles(frozen), drift, sets)


def constraints(cells: Cells, layers: CellLayers, numbers: Numbers) -> tuple[Constraint, ...]:
    """(C1), (C4) and (C2) on the particles of ``frozen_problem``, in the order in which a substep projects.

    Arguments and errors are those of ``frozen_problem``, but the state need not be in S.
    """
    of_a_frame(cells, layers, numbers)
    n = len(cells.x)
    within("layers.apical", layers.apical, n)
    within("layers.basal", layers.basal, n)
    off = layers.basal[cells.by[layers.basal] != 0]
    if off.size:
        raise InvalidProblem(f"cells.by[{off[0]}] = {cells.by[off[0]]}: must be 0 in the basal layer  (C3)")
    apart = np.flatnonzero(cells.chain)
    if apart.size:
        raise InvalidProblem(
            f"cells.chain[{apart[0]}] = {cells.chain[apart[0]]}: must be 0, the energy has the junctions of the layer"
        )
    chain = 2 * n + layers.basal
    return (
        NonOverlap(cells.radius, among=np.arange(n)),
        Ordered(chain, axis=0),
        MaxDistance(np.column_stack((chain[1:], chain[:-1])), numbers.max_basal_distance),
    )


def of_a_frame(cells: Cells, layers: CellLayers, numbers: Numbers) -> None:
    """Refuse what are no cells and layers of a frame, or no numbers of parameters."""
    instance("cells", cells, Cells, "the cells of a tissue.Frame")
    instance("layers", layers, CellLayers, "the layers of a tissue.Frame")
    instance("numbers", numbers, Numbers, "those of Parameters.numbers()")


def made_feasible(cells: Cells, layers: CellLayers, numbers: Numbers, projection: Projection) -> Cells:
    """P_S(Z): a state near the given one, locally the nearest, in which (C1) to (C4) hold; all but positions stays.

    Arguments and errors are those of ``frozen_problem``, but the state need not be in S; and ``projection`` computes
    nearest points of S itself, such as ``dincl.Ipopt(tol=1e-9)``. Raises ``dincl.ProjectionFailed`` if it finds none.
    """
    of_a_frame(cells, layers, numbers)
    point = _projected(particles(cells), constraints(cells, layers, numbers), cells, projection)
    return cells_at(point, cells, layers)


def _projected(state: Floats, sets: tuple[Constraint, ...], cells: Cells, projection: Projection) -> Floats:
    """Project a state onto the sets; a problem needs a start in them, so it has one with all nuclei apart."""
    n, apart = len(cells.x), np.zeros_like(state)
    apart[:n, 0] = 2 * cells.radius.max() * np.arange(n)
    return project(Problem(apart, lambda t, x: np.zeros_like(x), sets), state, projection).point


def particles(points: Cells | Forces, axes: str = "xy") -> Floats:
    """Collect the coordinates of cells, or the forces on them, as (3n, d): nuclei, apical points, basal points."""
    return np.concatenate([np.column_stack([getattr(points, letter + axis) for axis in axes]) for letter in POINTS])


def cells_at(x: Floats, cells: Cells, layers: CellLayers, axes: str = "xy") -> Cells:
    """Give the cells the coordinates of the particles x (3n, d); those of the basal layer stay at the height 0."""
    n, d = len(cells.x), len(axes)
    if x.shape != (3 * n, d):
        raise InvalidProblem(f"x of shape {x.shape}: must have the shape (3n, {d}) of {n} cells")
    lines: Any = {}
    for k, letter in enumerate(POINTS):
        lines |= {letter + axis: x[k * n : (k + 1) * n, c].copy() for c, axis in enumerate(axes)}
    lines["by"][layers.basal] = 0.0
    return cells._replace(**lines)


def frozen_problem_in_space(frame: Frame, numbers: Numbers) -> Problem:
    """mu dZ/dt in -grad W(Z) - N(S, Z) in three dimensions: the tissue between two updates, without noise.

    Source: section 3.2 of chapter 3, in vector form.

    The 3n particles are the nuclei, then the apical points, then the basal points, each in the order of the cells; the
    way back is ``cells_at``. A basal point of the basal layer has y = 0 and no velocity in y: (C3) by
    construction. Neighbours stand still, so nothing takes the place of (C4): between two updates networks do not flip.

    Parameters
    ----------
    frame
        The start, on an open plane, with the rest lengths and networks that stay [R_soft]; copied.
    numbers
        ``mu`` [h], ``max_basal_distance``, and the constants of the energy.

    Raises
    ------
    InvalidProblem
        For a start outside of S, a surface that bends or has periods, a basal point of the layer off the plane.
    """
    sets, rates = constraints_in_space(frame, numbers), rates_of(frame, numbers)

    def drift(t: float, x: Floats) -> Floats:
        velocity = np.empty_like(x)
        flow(np.ascontiguousarray(x), rates, velocity)
        return velocity

    return Problem(particles(frame.cells, "xyz"), drift, sets)


def constraints_in_space(frame: Frame, numbers: Numbers) -> tuple[Constraint, ...]:
    """(C1) and (C2) on the particles of ``frozen_problem_in_space``, in the order in which a substep projects.

    Arguments and errors are those of ``frozen_problem_in_space``, but the state need not be in S.
    """
    sheets = _on_open_plane(frame, numbers)
    cells, layer = frame.cells, frame.layers.basal
    off = layer[cells.by[layer] != 0]
    if off.size:
        raise InvalidProblem(f"cells.by[{off[0]}] = {cells.by[off[0]]}: must be 0 in the basal layer  (C3)")
    n = len(cells.x)
    return NonOverlap(cells.radius, among=np.arange(n)), MaxDistance(
        2 * n + sheets.basal.edges, numbers.max_basal_distance
    )


def rates_of(frame: Frame, numbers: Numbers) -> Rates:
    """Return the coefficients of the drift -grad W / mu; arguments and errors are those of ``constraints_in_space``."""
    sheets, cells = _on_open_plane(frame, numbers), frame.cells
    mu = number("mu", numbers.mu, positive=True)
    l_ax, l_bx = 1 + cells.rest_ax, 1 + cells.rest_bx
    joined, rest = sheets.apical.edges, sheets.apical.rest
    k_aa = numbers.junction_factor * (cells.stiff_aa[joined[:, 0]] + cells.stiff_aa[joined[:, 1]]) / 2
    return Rates(
        k_ax=2 * cells.stiff_ax / l_ax**numbers.spring_power / mu,
        k_bx=2 * cells.stiff_bx / l_bx**numbers.spring_power / mu,
        k_axb=cells.stiff_axb / mu,
        l_ax=l_ax,
        l_bx=l_bx,
        held=frame.layers.basal.copy(),
        junctions=joined,
        rest=rest,
        k_aa=k_aa / mu,
        repulsion=numbers.repulsion / mu,
    )


def made_feasible_in_space(frame: Frame, numbers: Numbers, projection: Projection) -> Frame:
    """P_S(Z): a state near the given one, locally the nearest, in which (C1) to (C3) hold; all but positions stays.

    Arguments and errors are those of ``frozen_problem_in_space``, but the state need not be in S; and ``projection``
    computes nearest points of S itself, such as ``dincl.Ipopt(tol=1e-9)``. Raises ``dincl.ProjectionFailed`` if it
    finds none.
    """
    sets, cells = constraints_in_space(frame, numbers), frame.cells
    point = _projected(particles(cells, "xyz"), sets, cells, projection)
    return frame._replace(cells=cells_at(point, cells, frame.layers, "xyz"))


def _on_open_plane(frame: Frame, numbers: Numbers) -> Sheets:
    """Return the surface and networks of a frame; refuse those for which dincl has no constraints."""
    instance("frame", frame, Frame, "that of a run in three dimensions")
    instance("numbers", numbers, Numbers, "those of Parameters.numbers()")
    if frame.sheets is None:
        raise InvalidProblem("frame.sheets = None: must be those of a run in three dimensions; see frozen_problem")
    surface = frame.sheets.surface
    if surface.bends != PLANE or math.isfinite(surface.period_x) or math.isfinite(surface.period_z):
        raise InvalidProblem(
            f"frame.sheets.surface = {surface}: must be an open plane, space.boundary = 'open'; "
            "the constraints of dincl know neither periods nor surfaces that bend"
        )
    return frame.sheets
