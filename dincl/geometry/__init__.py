"""Normal cones, tangent velocities, support functions, prox-regularity  (chapter 1, sections 4.1 to 4.4)."""

from dincl.geometry.cones import NormalCone, TangentVelocity, normal_cone, support, tangent_velocity
from dincl.geometry.constants import chain_constant, printed_constant, proved_constant
from dincl.geometry.prox import Hypomonotonicity, ProxRegularity, hypomonotonicity, prox_regularity

__all__ = [
    "Hypomonotonicity",
    "NormalCone",
    "ProxRegularity",
    "TangentVelocity",
    "chain_constant",
    "hypomonotonicity",
    "normal_cone",
    "printed_constant",
    "proved_constant",
    "prox_regularity",
    "support",
    "tangent_velocity",
]
