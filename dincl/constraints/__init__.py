"""The sets: one family per file, all made of the rows in ``rows.py``."""

from dincl.constraints.balls import InsideBall, OutsideBall
from dincl.constraints.base import Constraint
from dincl.constraints.differentiable import DifferentiableConstraint
from dincl.constraints.halfspace import HalfSpace
from dincl.constraints.links import MaxDistance
from dincl.constraints.moving import Moving
from dincl.constraints.nonoverlap import NonOverlap
from dincl.constraints.order import Ordered
from dincl.constraints.rows import AffineRows, DistanceRows, RowsOfOneKind, SmoothRows
from dincl.constraints.smooth import Smooth

__all__ = [
    "AffineRows",
    "Constraint",
    "DifferentiableConstraint",
    "DistanceRows",
    "HalfSpace",
    "InsideBall",
    "MaxDistance",
    "Moving",
    "NonOverlap",
    "Ordered",
    "OutsideBall",
    "RowsOfOneKind",
    "Smooth",
    "SmoothRows",
]
