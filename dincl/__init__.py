"""Differential inclusions x' in F(t, x) - N(S, x): problems, schemes, projections."""

from dincl import callables, checks, constraints, drifts, geometry, projection, rows, scenes, shapes
from dincl.constraints import (
    Constraint,
    DifferentiableConstraint,
    Distance,
    HalfSpace,
    InsideBall,
    MaxDistance,
    Moving,
    NonOverlap,
    Ordered,
    OutsideBall,
    RigidMotion,
    Smooth,
)
from dincl.errors import FunctionFailed, InvalidProblem, ProjectionFailed, StepFailure
from dincl.forces import Forces
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
    ActiveSet,
    Certified,
    Clarabel,
    CvxpyQP,
    Daqp,
    Ipopt,
    Lcp,
    NearestPoint,
    Piqp,
    Projected,
    ProjectedCG,
    Projection,
)
from dincl.projection.feasible import project
from dincl.schemes import (
    PBD,
    XPBD,
    AdaptiveCatchUp,
    Auto,
    CatchUp,
    EventDriven,
    FixedStep,
    LinearisedCatchUp,
    MidpointCatchUp,
    Penalty,
    Scheme,
    SecondOrderPBD,
)
from dincl.solve import solve
from dincl.status import Status
from dincl.steps.grid import Stepper, StepState
from dincl.trajectory import Between, Event, RunOutcome, StepFailed, Trajectory
from dincl.work import Work

__all__ = [
    "PBD",
    "XPBD",
    "ActiveSet",
    "AdaptiveCatchUp",
    "ArrowHurwicz",
    "Auto",
    "Between",
    "CatchUp",
    "Certified",
    "Clarabel",
    "Constraint",
    "CvxpyQP",
    "DampedArrowHurwicz",
    "Daqp",
    "DifferentiableConstraint",
    "Distance",
    "Event",
    "EventDriven",
    "FixedStep",
    "Forces",
    "FunctionFailed",
    "HalfSpace",
    "InsideBall",
    "InvalidProblem",
    "Ipopt",
    "Lcp",
    "LinearisedCatchUp",
    "MaxDistance",
    "MidpointCatchUp",
    "MinimisationFailed",
    "Minimiser",
    "Minimum",
    "Moving",
    "NearestPoint",
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
    "RigidMotion",
    "RunOutcome",
    "Scheme",
    "SecondOrderPBD",
    "Smooth",
    "Stationary",
    "Status",
    "StepFailed",
    "StepFailure",
    "StepState",
    "Stepper",
    "Stop",
    "Trajectory",
    "Uzawa",
    "Work",
    "callables",
    "checks",
    "constraints",
    "drifts",
    "geometry",
    "minimise",
    "project",
    "projection",
    "rows",
    "scenes",
    "shapes",
    "solve",
]


def __getattr__(name: str) -> str:
    """``dincl.__version__`` of the installed package, looked up on use."""
    if name == "__version__":
        from importlib.metadata import version

        return version("dincl-testbed")
    raise AttributeError(f"module 'dincl' has no attribute {name!r}")
