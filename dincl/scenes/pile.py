"""Many discs that settle on a floor between two walls."""

from __future__ import annotations

import numpy as np

from dincl.checks import integer
from dincl.checks import seed as checked_seed
from dincl.constraints import HalfSpace, NonOverlap
from dincl.drifts import constant
from dincl.scenes.layers import MOST_DISCS, layers
from dincl.scenes.scene import Scene


def pile(n: int, seed: int = 0) -> Scene:
    """X_i' in (0, -1) - N_i, n discs of radius 0.45 ... 0.55 in a box that is open above, about sqrt(n) wide.

    They start in loose rows, numbered row by row from below, each disc almost touching one that carries it. From the
    floor upwards the rows give way sideways and mix, while those above still fall as one. The start depends on n and
    ``seed`` alone.
    """
    count = integer("n", n, least=1, most=MOST_DISCS)
    start = layers(count, 2, np.random.default_rng(checked_seed("seed", seed)))
    walls = [
        HalfSpace(normal=(0, 1), radius=start.radius),
        HalfSpace(normal=(1, 0), radius=start.radius),
        HalfSpace(normal=(-1, 0), offset=-start.width, radius=start.radius),
    ]
    return Scene(
        start.x,
        constant(np.tile([0.0, -1.0], (count, 1))),
        [NonOverlap(start.radius), *walls],
        name="pile",
        title=f"A pile of {count} discs",
        times=(1.0, 2.0),
        radius=start.radius,
    )
