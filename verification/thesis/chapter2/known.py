"""Positions that are known up to a stated error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
# Two times are the same if they differ by less than this [time]; kept times are multiples of 0.05 or more.
SAME = 5e-8


@dataclass(frozen=True)
class Known:
    """The solution of a scene.

    Attributes
    ----------
    t, x
        Times (K,) and positions (K, N, d).
    error
        Stated error max_i |X_i - exact| at each time, (K,) [length].
    """

    t: Floats
    x: Floats
    error: Floats

    def at(self, times: Floats | Sequence[float]) -> tuple[Floats, Floats]:
        """Positions (len(times), N, d), stated errors (len(times),) at some of the times t; ValueError for others."""
        wanted = np.asarray(times, dtype=np.float64)
        index = np.abs(self.t - wanted[:, None]).argmin(axis=1)
        if (np.abs(self.t[index] - wanted) > SAME).any():
            raise ValueError(f"times = {wanted}: must be among the times of the reference, {self.t}")
        return self.x[index], self.error[index]
