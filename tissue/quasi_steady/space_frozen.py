"""A tissue in space whose rules and neighbours stand still, as a differential inclusion that dincl takes."""

from __future__ import annotations

import math

import numpy as np

from dincl.checks import instance, number
from dincl.constraints import Constraint, MaxDistance, NonOverlap
from dincl.errors import InvalidProblem
from dincl.problem import Problem
from dincl.projection import Projection
from dincl.projection.project import project
from tissue.frames.frame import Frame
from tissue.quasi_steady.flow import Rates, flow
from tissue.state.cells import Cells, Floats
from tissue.state.mesh import Sheets
from tissue.state.numbers import Numbers
from tissue.state.surface import PLANE


def frozen_problem_in_space(frame: Frame, numbers: Numbers) -> Problem:
    """mu dZ/dt in -grad W(Z) - N(S, Z) in three dimensions: the tissue between two updates, without noise.

    Source: section 3.2 of chapter 3, in vector form.

    The 3n particles are the nuclei, then the apical points, then the basal points, each in the order of the cells; the
    way back is ``cells_in_space_at``. A basal point of the basal layer has y = 0 and no velocity in y: (C3) by
    construction. Neighbours stand still, so nothing takes the place of (C4): between two updates networks do not flip.

    Parameters
    ----------
    frame
        The start, on an open plane, with the rest lengths and networks that stay [R_soft]; copied.
    numbers
        ``mu`` [h], ``max_basal``, and the constants of the energy.

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

    return Problem(particles_in_space(frame.cells), drift, sets)


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
    return NonOverlap(cells.radius, among=np.arange(n)), MaxDistance(2 * n + sheets.basal.edges, numbers.max_basal)


def rates_of(frame: Frame, numbers: Numbers) -> Rates:
    """Return the coefficients of the drift -grad W / mu; arguments and errors are those of ``constraints_in_space``."""
    sheets, cells = _on_open_plane(frame, numbers), frame.cells
    mu = number("mu", numbers.mu, positive=True)
    l_ax, l_bx = 1 + cells.rest_ax, 1 + cells.rest_bx
    joined, rest = sheets.apical.edges, sheets.apical.edge_rests
    k_aa = numbers.junction_factor * (cells.stiff_aa[joined[:, 0]] + cells.stiff_aa[joined[:, 1]]) / 2
    return Rates(
        k_ax=2 * cells.stiff_ax / l_ax**numbers.power / mu,
        k_bx=2 * cells.stiff_bx / l_bx**numbers.power / mu,
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
    n, state = len(cells.x), particles_in_space(cells)
    apart = np.zeros_like(state)
    apart[:n, 0] = 2 * cells.radius.max() * np.arange(n)
    problem = Problem(apart, lambda t, x: np.zeros_like(x), sets)
    return frame._replace(cells=cells_in_space_at(project(problem, state, projection).point, frame))


def particles_in_space(cells: Cells) -> Floats:
    """Return the coordinates of cells as (3n, 3): nuclei, apical points, basal points."""
    c = cells
    return np.concatenate([np.column_stack(p) for p in ((c.x, c.y, c.z), (c.ax, c.ay, c.az), (c.bx, c.by, c.bz))])


def cells_in_space_at(x: Floats, frame: Frame) -> Cells:
    """Return the cells with the coordinates of the particles x (3n, 3); those of the basal layer stay on their
    plane.
    """
    n = len(frame.cells.x)
    if x.shape != (3 * n, 3):
        raise InvalidProblem(f"x of shape {x.shape}: must have the shape (3n, 3) of {n} cells")
    nuclei, apical, basal = (x[k * n : (k + 1) * n].T.copy() for k in range(3))
    basal[1, frame.layers.basal] = 0.0
    names = (("x", "y", "z"), ("ax", "ay", "az"), ("bx", "by", "bz"))
    points = zip(names, (nuclei, apical, basal), strict=True)
    return frame.cells._replace(
        **{name: line for kind, lines in points for name, line in zip(kind, lines, strict=True)}
    )


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
