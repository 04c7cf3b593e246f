"""Constrained particles coupled to a macroscopic component: DAE, reduced ODE, mean-field limit, moments, W1."""

from meanfield.characteristics import Flow, solve_characteristics
from meanfield.dae import solve_dae
from meanfield.density import Density
from meanfield.errors import InvalidModel, NotClosed, SolveFailed
from meanfield.examples import LinearFibre, StraightFibre, TissueElement, WavyFibre
from meanfield.grid_motion import GridMotion
from meanfield.model import Model
from meanfield.moments import MomentMotion, Moments, sample_moments, solve_moments
from meanfield.motion import Motion, Work
from meanfield.ode import solve_ode
from meanfield.panels import Panels
from meanfield.pde import solve_pde
from meanfield.rattle import solve_rattle
from meanfield.reduction import Positions, Reduction, reduce
from meanfield.state import State
from meanfield.status import Status
from meanfield.wasserstein import Weighted, w1

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
    "Positions",
    "Reduction",
    "SolveFailed",
    "State",
    "Status",
    "StraightFibre",
    "TissueElement",
    "WavyFibre",
    "Weighted",
    "Work",
    "reduce",
    "sample_moments",
    "solve_characteristics",
    "solve_dae",
    "solve_moments",
    "solve_ode",
    "solve_pde",
    "solve_rattle",
    "w1",
]
