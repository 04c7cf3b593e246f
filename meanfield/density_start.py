"""The arguments that start the mean-field equations, checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from meanfield import checks
from meanfield.errors import InvalidModel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from meanfield.density import Density
    from meanfield.model import Model


def checked_start(
    model: Model, density: Density, y0: ArrayLike, v0: ArrayLike, t: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """y0, v0 (ny,) and the times to keep (K,), for a density over the space of the model's particles.

    Raises
    ------
    InvalidModel
        if one of them cannot be right.
    """
    if density.nx != model.nx:
        raise InvalidModel(f"density has nx = {density.nx}: must be {model.nx}, that of the model")
    y, v = checks.array("y0", y0, (model.ny,)), checks.array("v0", v0, (model.ny,))
    return y, v, checks.times(t)
