"""Sets, all made of rows of the kinds in ``dincl.rows``."""

from dincl.constraints.affine import HalfSpace, Ordered
from dincl.constraints.base import Constraint
from dincl.constraints.distances import Distance, InsideBall, MaxDistance, NonOverlap, OutsideBall
from dincl.constraints.moving import Moving, RigidMotion
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
