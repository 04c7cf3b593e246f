"""The drifts of the scenes, as objects that can be sent to other processes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Constant:
    """F(t, x) = velocity, shape (N, d) [length / time]."""

    velocity: NDArray[np.float64]

    def __call__(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """The velocity, whatever t and x."""
        return self.velocity


def towards_origin(t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """F(t, x) = -x: every particle is drawn to the origin, at rate 1."""
    return -x
