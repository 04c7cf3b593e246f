"""A disc that is driven into another one and slides past it."""

from __future__ import annotations

from typing import Any

import numpy as np

from dincl.constraints import NonOverlap
from dincl.drifts import constant
from dincl.scenes.exact import Exact
from dincl.scenes.scene import Scene
from dincl.scenes.slide import Slide

RADII = (0.5, 0.75)
# Of disc 0 relative to disc 1, which starts at the origin and has no drift of its own.
SLIDE = Slide(start=(-2.1, 0.9), drift=(1.0, -0.25), length=sum(RADII))


class _TwoDisks(Exact):
    @property
    def _shape(self) -> tuple[int, int]:
        return (2, 2)

    def _at(self, t: Any) -> list[Any]:
        import mpmath

        start, drift = (np.array([mpmath.mpf(c) for c in vector], dtype=object) for vector in SLIDE[:2])
        middle, half = (start + t * drift) / 2, SLIDE.at(t) / 2
        return [middle + half, middle - half]


def two_disks() -> Scene:
    """X_0' in a - N_0, X_1' in -N_1, two discs of radii 1/2 and 3/4; a = (1, -1/4).

    Disc 0 meets disc 1 at t = 1.03 beside the middle, pushes it away while it slides around it, and is past it at
    t = 3.34. Exact solution: in contact X_0' = a + lambda n, X_1' = -lambda n with n = (X_0 - X_1)/L, L = 5/4. The sum
    gives (X_0 + X_1)/2 = (X_0 + X_1)(0)/2 + t a/2. The difference r = X_0 - X_1 has r' = a + 2 lambda n with
    r' . n = 0, hence r' = a - (a . n) n while a . n < 0: the motion of one point past a fixed disc of radius L, which
    ``dincl.scenes.slide.Slide`` gives.
    """
    return Scene(
        [SLIDE.start, (0.0, 0.0)],
        constant(np.array([SLIDE.drift, (0.0, 0.0)])),
        [NonOverlap(RADII)],
        name="two_disks",
        title="A disc pushes another one and slides past it",
        times=(2.0, 4.0),
        radius=RADII,
        exact=_TwoDisks(),
    )
