"""A disc that slides over a fixed disc."""

from __future__ import annotations

from typing import Any

import numpy as np

from dincl.constraints import OutsideBall
from dincl.drifts import constant
from dincl.scenes.exact import Exact
from dincl.scenes.scene import Scene
from dincl.scenes.slide import Slide

RADIUS = 0.5
SLIDE = Slide(start=(0.3, 1.6), drift=(0.0, -1.0), length=2 * RADIUS)


class _SlidingDisc(Exact):
    @property
    def _shape(self) -> tuple[int, int]:
        return (1, 2)

    def _at(self, t: Any) -> list[Any]:
        return [SLIDE.at(t)]


def sliding_disc() -> Scene:
    """X' in (0, -1) - N(X), one disc of radius 1/2 above another one, fixed at the origin: |X| >= 1.

    It falls, touches the fixed disc at t = 0.65 beside its top, slides around it and leaves it at t = 2.52 with a
    vertical tangent. The exact solution, with its derivation, is that of ``dincl.scenes.slide.Slide``, for r = X.
    """
    return Scene(
        [SLIDE.start],
        constant(np.array([SLIDE.drift])),
        [OutsideBall(centre=(0, 0), distance=SLIDE.length)],
        name="sliding_disc",
        title="A disc slides over a fixed disc",
        times=(1.5, 3.0),
        radius=RADIUS,
        exact=_SlidingDisc(),
    )
