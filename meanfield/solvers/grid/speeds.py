"""One component of the velocity of the transport, at many points."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from meanfield.model.symbolic import library, program
from meanfield.model.translate import vectorised

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.model import Model


def speed(
    model: Model, axis: int, X: NDArray[np.float64], y: NDArray[np.float64], v: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(Phi(X, y) v)_axis at points X (Q, nx), of shape (Q,); may be infinite or NaN where the model is singular.

    Source: (5.9).
    """
    with np.errstate(all="ignore"):
        (found,) = _component(model, axis)(X, y, v)
    return np.broadcast_to(found, len(X))


@lru_cache(maxsize=256)
def _component(model: Model, axis: int) -> Callable[..., list[NDArray[np.float64]]]:
    e = model.expressions
    flow = library().mtimes(e.phi, e.v)[axis]
    return vectorised(program([e.X, e.y, e.v], [flow]), ["X", "y", "v"], [True, False, False])
