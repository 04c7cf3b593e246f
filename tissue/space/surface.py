"""The basal surface of a tissue in three dimensions: a plane, a cylinder, a sphere."""

from __future__ import annotations

import math
from typing import NamedTuple

PLANE, CYLINDER, SPHERE = range(3)


class Surface(NamedTuple):
    """What kernels know of the basal surface; lengths in units of R_soft.

    The plane is y = 0, the cylinder x^2 + y^2 = radius^2, the sphere |X| = radius.
    """

    bends: int  # PLANE, CYLINDER or SPHERE
    radius: float
    side: float  # 1: the tissue is outside, -1: inside; 1 for the plane
    period_x: float  # inf for none; of the plane alone
    period_z: float  # inf for none; of the plane and the cylinder


FLAT_SURFACE = Surface(PLANE, math.inf, 1.0, math.inf, math.inf)
