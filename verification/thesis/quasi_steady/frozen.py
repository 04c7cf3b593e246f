"""A tissue whose rules and neighbours stand still, as a differential inclusion that dincl takes."""

from __future__ import annotations

from typing import Any

import numpy as np

from dincl.constraints import Constraint, MaxDistance, NonOverlap, Ordered
from dincl.errors import InvalidProblem
from dincl.problem import Problem
from dincl.projection import Projection
from dincl.projection.feasible import project
from tissue.model.energy import forces
from tissue.state.cells import CellLayers, Cells, Floats, Forces, first
from tissue.state.numbers import Numbers

# The letters of nuclei, apical and basal points in the names of their coordinates.
POINTS = ("", "a", "b")


def frozen_problem(cells: Cells, layers: CellLayers, numbers: Numbers) -> Problem:
    """mu dZ/dt in -grad W(Z) - N(S, Z): the tissue between two updates of its rules, without noise.

    Source: section 3.2 of chapter 3.

    The 3n particles are the nuclei, then the apical points, then the basal points, each in the order of the cells; the
    way back is ``cells_at``. A basal point of the basal layer has y = 0 and no velocity in y: (C3) by construction.

    ``cells`` are the start, with rest lengths, stiffnesses and radii that stay [R_soft], ``layers`` the junctions and
    the basal layer. Raises InvalidProblem for a start outside of S, or a basal point of the layer off the line.

    Right after a division the daughters overlap: from such a state there is no solution, and it is refused. Schemes
    agree on the motion after a division only if they start from one state of S, as by ``made_feasible``.
    """
    frozen, network = first(cells, len(cells.x)), CellLayers(layers.apical.copy(), layers.basal.copy())
    sets = constraints(frozen, network, numbers)
    held = 2 * len(frozen.x) + network.basal

    def drift(t: float, x: Floats) -> Floats:
        velocity = particles(forces(cells_at(x, frozen, network), network, numbers)) / numbers.mu
        velocity[held, 1] = 0.0
        return velocity

    return Problem(particles(frozen), drift, sets)


def constraints(cells: Cells, layers: CellLayers, numbers: Numbers) -> tuple[Constraint, ...]:
    """(C1), (C4) and (C2) on the particles of ``frozen_problem``, in the order in which a substep projects.

    The state need not be in S.
    """
    n = len(cells.x)
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


def made_feasible(cells: Cells, layers: CellLayers, numbers: Numbers, projection: Projection) -> Cells:
    """P_S(Z): a state near the given one, locally the nearest, in which (C1) to (C4) hold; all but positions stays.

    ``projection`` computes nearest points of S itself, such as ``dincl.Ipopt(tol=1e-9)``. Raises
    ``dincl.ProjectionFailed`` if it finds none.
    """
    state, sets = particles(cells), constraints(cells, layers, numbers)
    # A problem needs a start in its set, so it has one with all nuclei apart.
    n, apart = len(cells.x), np.zeros_like(state)
    apart[:n, 0] = 2 * cells.radius.max() * np.arange(n)
    found = project(Problem(apart, lambda t, x: np.zeros_like(x), sets), state, projection)
    return cells_at(found.point, cells, layers)


def particles(points: Cells | Forces) -> Floats:
    """Collect the coordinates of cells, or the forces on them, as (3n, 2): nuclei, apical points, basal points."""
    return np.concatenate([np.column_stack([getattr(points, letter + axis) for axis in "xy"]) for letter in POINTS])


def cells_at(x: Floats, cells: Cells, layers: CellLayers) -> Cells:
    """Give the cells the coordinates of the particles x (3n, 2); those of the basal layer stay at the height 0."""
    n = len(cells.x)
    lines: Any = {}
    for k, letter in enumerate(POINTS):
        lines |= {letter + axis: x[k * n : (k + 1) * n, c].copy() for c, axis in enumerate("xy")}
    lines["by"][layers.basal] = 0.0
    return cells._replace(**lines)
