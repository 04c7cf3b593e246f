"""Constrained particles coupled to a macroscopic component: DAE, reduced ODE, mean-field limit, moments, W1."""

from meanfield.errors import InvalidModel, NotClosed, SolveFailed
from meanfield.examples import LinearFibre, StraightFibre, TissueElement, WavyFibre
from meanfield.model import Model
from meanfield.moments import MomentMotion, Moments, sample_moments, solve_moments
from meanfield.motion import Motion, Work
from meanfield.ode import solve_ode
from meanfield.reduction import Positions, Reduction, reduce
from meanfield.state import State
from meanfield.status import Status

__all__ = [
    "InvalidModel",
    "LinearFibre",
    "Model",
    "MomentMotion",
    "Moments",
    "Motion",
    "NotClosed",
    "Positions",
    "Reduction",
    "SolveFailed",
    "State",
    "Status",
    "StraightFibre",
    "TissueElement",
    "WavyFibre",
    "Work",
    "reduce",
    "sample_moments",
    "solve_moments",
    "solve_ode",
]
