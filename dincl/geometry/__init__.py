"""Normal cones, tangent velocities, support functions, prox-regularity  (chapter 1, sections 4.1 to 4.4)."""

from dincl.geometry.constants import chain_constant, printed_constant, proved_constant
from dincl.geometry.normal import NormalCone, normal_cone, support
from dincl.geometry.prox import Hypomonotonicity, ProxRegularity, hypomonotonicity, prox_regularity
from dincl.geometry.tangent import TangentVelocity, tangent_velocity

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
