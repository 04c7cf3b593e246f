"""The sets: one family per file, all made of rows of the kinds in ``dincl.rows``."""

from dincl.constraints.balls import InsideBall, OutsideBall
from dincl.constraints.base import Constraint
from dincl.constraints.differentiable import DifferentiableConstraint
from dincl.constraints.halfspace import HalfSpace
from dincl.constraints.links import MaxDistance
from dincl.constraints.moving import Moving
from dincl.constraints.nonoverlap import NonOverlap
from dincl.constraints.order import Ordered
from dincl.constraints.smooth import Smooth

__all__ = [
    "Constraint",
    "DifferentiableConstraint",
    "HalfSpace",
    "InsideBall",
    "MaxDistance",
    "Moving",
    "NonOverlap",
    "Ordered",
    "OutsideBall",
    "Smooth",
]
