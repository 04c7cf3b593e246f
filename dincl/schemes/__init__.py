"""The schemes: one time step per file."""

from dincl.schemes.base import Scheme
from dincl.schemes.catch_up import CatchUp, LinearisedCatchUp
from dincl.schemes.pbd import PBD
from dincl.schemes.penalty import Penalty
from dincl.schemes.second_order_pbd import SecondOrderPBD

__all__ = ["PBD", "CatchUp", "LinearisedCatchUp", "Penalty", "Scheme", "SecondOrderPBD"]
