"""Sets, all made of rows of the kinds in ``dincl.rows``."""

from dincl.constraints.base import Constraint
from dincl.constraints.moving import Moving, RigidMotion
from dincl.constraints.sets import Distance, HalfSpace, InsideBall, MaxDistance, NonOverlap, Ordered, OutsideBall
from dincl.constraints.smooth import DifferentiableConstraint, Smooth

__all__ = [
    "Constraint",
    "DifferentiableConstraint",
    "Distance",
    "HalfSpace",
    "InsideBall",
    "MaxDistance",
    "Moving",
    "NonOverlap",
    "Ordered",
    "OutsideBall",
    "RigidMotion",
    "Smooth",
]
