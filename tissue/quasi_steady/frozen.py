"""A tissue whose rules stand still, as a differential inclusion that the schemes and minimisers of dincl take."""

from __future__ import annotations

import numpy as np

from dincl.checks import instance, number, within
from dincl.constraints import Constraint, MaxDistance, NonOverlap, Ordered
from dincl.errors import InvalidProblem
from dincl.problem import Problem
from dincl.projection import Projection
from dincl.projection.project import project
from tissue.model.energy import forces
from tissue.state.cells import CellLayers, Cells, Floats, Forces, first
from tissue.state.numbers import Numbers


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
        ``mu`` [h], ``max_basal``, and the constants of the energy.

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
        MaxDistance(np.column_stack((chain[1:], chain[:-1])), numbers.max_basal),
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
    n, state = len(cells.x), particles(cells)
    apart = np.zeros_like(state)
    apart[:n, 0] = 2 * cells.radius.max() * np.arange(n)
    problem = Problem(apart, lambda t, x: np.zeros_like(x), constraints(cells, layers, numbers))
    return cells_at(project(problem, state, projection).point, cells, layers)


def particles(points: Cells | Forces) -> Floats:
    """Return the coordinates of cells, or the forces on them, as (3n, 2): nuclei, apical points, basal points."""
    p = points
    return np.stack((np.concatenate((p.x, p.ax, p.bx)), np.concatenate((p.y, p.ay, p.by))), axis=1)


def cells_at(x: Floats, cells: Cells, layers: CellLayers) -> Cells:
    """Return the cells with the coordinates of the particles x (3n, 2); those of the basal layer stay on their line."""
    n = len(cells.x)
    if x.shape != (3 * n, 2):
        raise InvalidProblem(f"x of shape {x.shape}: must have the shape (3n, 2) of {n} cells")
    nuclei, apical, basal = x[:n].T.copy(), x[n : 2 * n].T.copy(), x[2 * n :].T.copy()
    basal[1, layers.basal] = 0.0
    return cells._replace(x=nuclei[0], y=nuclei[1], ax=apical[0], ay=apical[1], bx=basal[0], by=basal[1])
