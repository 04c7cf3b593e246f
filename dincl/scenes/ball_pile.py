"""Many balls that settle on a floor between four walls."""

from __future__ import annotations

import numpy as np

from dincl.checks import integer
from dincl.checks import seed as checked_seed
from dincl.constraints import HalfSpace, NonOverlap
from dincl.drifts import constant
from dincl.scenes.layers import MOST_DISCS, layers
from dincl.scenes.scene import Scene


def ball_pile(n: int, seed: int = 0) -> Scene:
    """X_i' in (0, 0, -1) - N_i, n balls of radius 0.45 ... 0.55 in a box that is open above, about n^(1/3) wide.

    They start in loose layers, numbered layer by layer from below, each ball almost touching one that carries it. From
    the floor upwards the layers give way sideways and mix, while those above still fall as one. The start depends on n
    and ``seed`` alone.
    """
    count = integer("n", n, least=1, most=MOST_DISCS)
    start = layers(count, 3, np.random.default_rng(checked_seed("seed", seed)))
    walls = [HalfSpace(normal=(0, 0, 1), radius=start.radius)]
    for axis in ((1, 0, 0), (0, 1, 0)):
        walls.append(HalfSpace(normal=axis, radius=start.radius))
        walls.append(HalfSpace(normal=tuple(-a for a in axis), offset=-start.width, radius=start.radius))
    return Scene(
        start.x,
        constant(np.tile([0.0, 0.0, -1.0], (count, 1))),
        [NonOverlap(start.radius), *walls],
        name="ball_pile",
        title=f"A pile of {count} balls",
        times=(1.0, 2.0),
        radius=start.radius,
    )
