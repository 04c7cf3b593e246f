"""Catch-up schemes, bound to a problem and a projection."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.kernels.catch_up import project_onto_linearised, project_onto_set
from dincl.kernels.steps import ProjectionArrays
from dincl.run.compiled import CompiledStepper
from dincl.run.small import SmallSystem

if TYPE_CHECKING:
    from dincl.problem import Problem
    from dincl.projection.base import Projection


def catching_up(problem: Problem, step: Any, projection: Projection, *, linearised: bool) -> CompiledStepper:
    """Bind a compiled step of a catch-up scheme to a problem and to the projection that it calls."""
    projection.check(problem)
    system = SmallSystem(problem, solver=projection.solver())
    project, program = project_onto_linearised if linearised else project_onto_set, system.arrays.program
    arrays = ProjectionArrays(project.address, program.y, np.zeros(problem.x0.size), program.z, np.zeros(3))
    return CompiledStepper(problem, step, [projection.tol], system=system, projection=arrays)
