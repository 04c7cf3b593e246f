"""Differential inclusions x' in F(t, x) - N(S, x): problems, schemes, projections."""

from dincl import scenes
from dincl.constraints import (
    Constraint,
    HalfSpace,
    InsideBall,
    MaxDistance,
    Moving,
    NonOverlap,
    Ordered,
    OutsideBall,
    Smooth,
)
from dincl.errors import InvalidProblem, StepFailed
from dincl.problem import Problem
from dincl.projection import Projected, Projection
from dincl.schemes import PBD, CatchUp, LinearisedCatchUp, Penalty, Scheme, SecondOrderPBD
from dincl.solve import solve
from dincl.status import Status
from dincl.trajectory import Trajectory
from dincl.work import Work

__all__ = [
    "PBD",
    "CatchUp",
    "Constraint",
    "HalfSpace",
    "InsideBall",
    "InvalidProblem",
    "LinearisedCatchUp",
    "MaxDistance",
    "Moving",
    "NonOverlap",
    "Ordered",
    "OutsideBall",
    "Penalty",
    "Problem",
    "Projected",
    "Projection",
    "Scheme",
    "SecondOrderPBD",
    "Smooth",
    "Status",
    "StepFailed",
    "Trajectory",
    "Work",
    "scenes",
    "solve",
]
