"""Drifts that compiled runs call without Python: the usual ones, functions of numba, and their base class."""

from dincl.drifts.affine import AffineDrift, attraction, constant, swirl
from dincl.drifts.base import CompiledDrift, DispatchedDrift, compiled

__all__ = ["AffineDrift", "CompiledDrift", "DispatchedDrift", "attraction", "compiled", "constant", "swirl"]
