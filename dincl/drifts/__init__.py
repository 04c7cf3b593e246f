"""Drifts that compiled runs call without Python: the usual ones, those that numba compiles, their base class."""

from dincl.drifts.affine import AffineDrift, attraction, constant, swirl
from dincl.drifts.base import CompiledDrift

__all__ = ["AffineDrift", "CompiledDrift", "attraction", "constant", "swirl"]
