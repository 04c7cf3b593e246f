"""Differential inclusions x' in F(t, x) - N(S, x): problems, schemes, projections."""

from dincl import geometry, scenes
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
from dincl.errors import InvalidProblem, ProjectionFailed
from dincl.minimise import (
    ArrowHurwicz,
    DampedArrowHurwicz,
    MinimisationFailed,
    Minimiser,
    Minimum,
    RelativeMove,
    Stationary,
    Stop,
    Uzawa,
    minimise,
)
from dincl.problem import Problem
from dincl.projection import (
    Clarabel,
    ClosedForm,
    CvxpyQP,
    Daqp,
    GaussSeidel,
    Ipopt,
    Piqp,
    Projected,
    ProjectedCG,
    Projection,
)
from dincl.projection.project import project
from dincl.schemes import PBD, CatchUp, EventDriven, LinearisedCatchUp, MidpointCatchUp, Penalty, Scheme, SecondOrderPBD
from dincl.solve import solve
from dincl.status import Status
from dincl.trajectory import StepFailed, Trajectory
from dincl.work import Work

__all__ = [
    "PBD",
    "ArrowHurwicz",
    "CatchUp",
    "Clarabel",
    "ClosedForm",
    "Constraint",
    "CvxpyQP",
    "DampedArrowHurwicz",
    "Daqp",
    "EventDriven",
    "GaussSeidel",
    "HalfSpace",
    "InsideBall",
    "InvalidProblem",
    "Ipopt",
    "LinearisedCatchUp",
    "MaxDistance",
    "MidpointCatchUp",
    "MinimisationFailed",
    "Minimiser",
    "Minimum",
    "Moving",
    "NonOverlap",
    "Ordered",
    "OutsideBall",
    "Penalty",
    "Piqp",
    "Problem",
    "Projected",
    "ProjectedCG",
    "Projection",
    "ProjectionFailed",
    "RelativeMove",
    "Scheme",
    "SecondOrderPBD",
    "Smooth",
    "Stationary",
    "Status",
    "StepFailed",
    "Stop",
    "Trajectory",
    "Uzawa",
    "Work",
    "geometry",
    "minimise",
    "project",
    "scenes",
    "solve",
]
