"""Drifts that compiled runs call without Python: the usual ones, those that numba compiles, their base class."""

from dincl.drifts.affine import AffineDrift, attraction, constant, swirl
from dincl.drifts.base import CompiledDrift
from dincl.drifts.dispatched import DispatchedDrift, compiled

__all__ = ["AffineDrift", "CompiledDrift", "DispatchedDrift", "attraction", "compiled", "constant", "swirl"]
