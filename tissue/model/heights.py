"""The height of a point above the basal layer, in the plane and in space."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.curve import height_of
from tissue.kernels.store import Store
from tissue.space.state import SPATIAL
from tissue.space.surface import height


@inner
def height_above(store: Store, x: float, y: float, z: float) -> float:
    """The distance of a point from the basal layer, along its normal; below 0 on the side without tissue."""
    if store.space.dimension == SPATIAL:
        return height(store.space.surface, x, y, z)
    return height_of(store.curve, x, y)
