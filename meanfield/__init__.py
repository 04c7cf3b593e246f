"""Constrained particles coupled to a macroscopic component: DAE, reduced ODE, mean-field limit, moments, W1.

``InvalidModel`` is dincl's class ``InvalidProblem``, ``Status`` is dincl's class of that name.
"""

from dincl.errors import InvalidProblem as InvalidModel
from dincl.status import Status
from meanfield.density import Density, Panels
from meanfield.model.examples import LinearFibre, StraightFibre, TissueElement, WavyFibre
from meanfield.model.model import Model
from meanfield.model.state import State
from meanfield.solvers.characteristics import Flow, push_forward, solve_characteristics
from meanfield.solvers.dae import solve_dae
from meanfield.solvers.moments import MomentMotion, Moments, NotClosed, solve_moments
from meanfield.solvers.ode import solve_ode
from meanfield.solvers.pde import GridMotion, solve_pde
from meanfield.solvers.result import Motion, SolveFailed, SolverWork
from meanfield.transport import Weighted, w1

__all__ = [
    "Density",
    "Flow",
    "GridMotion",
    "InvalidModel",
    "LinearFibre",
    "Model",
    "MomentMotion",
    "Moments",
    "Motion",
    "NotClosed",
    "Panels",
    "SolveFailed",
    "SolverWork",
    "State",
    "Status",
    "StraightFibre",
    "TissueElement",
    "WavyFibre",
    "Weighted",
    "push_forward",
    "solve_characteristics",
    "solve_dae",
    "solve_moments",
    "solve_ode",
    "solve_pde",
    "w1",
]
