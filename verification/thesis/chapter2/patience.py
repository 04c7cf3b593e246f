"""A scene that does not wait for ever."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dincl.problem import Drift
from dincl.scenes import Scene

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class _UpTo:
    """The drift until the clock shows ``deadline``; then TimeoutError, which no scheme takes for its failure."""

    drift: Drift
    deadline: float

    def __call__(self, t: float, x: Floats) -> Floats:
        if time.perf_counter() > self.deadline:
            raise TimeoutError
        found: Floats = self.drift(t, x)
        return found


def impatient(scene: Scene, seconds: float) -> Scene:
    """The scene whose drift raises TimeoutError once so many seconds have passed from now on."""
    return Scene(
        scene.x0,
        _UpTo(scene.drift, time.perf_counter() + seconds),
        scene.constraints,
        name=scene.name,
        title=scene.title,
        times=scene.times,
        radius=scene.radius,
        exact=scene.exact,
    )
