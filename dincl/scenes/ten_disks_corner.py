"""Ten discs that fall into a corner."""

from __future__ import annotations

import numpy as np

from dincl.constraints import HalfSpace, NonOverlap
from dincl.drifts import constant
from dincl.scenes.scene import Scene

RADIUS = 0.5
START = (
    (0.01, 1.26),
    (-0.82, 1.89),
    (0.36, 2.33),
    (-1.68, 2.9),
    (1.78, 3.26),
    (-0.32, 3.44),
    (1.22, 4.19),
    (-1.73, 4.52),
    (-0.36, 4.72),
    (2.4, 4.81),
)


def ten_disks_corner() -> Scene:
    """X_i' in (0, -1) - N_i, ten discs of radius 1/2 above two walls at right angles, y >= |x|; times 1, 2 and 3.

    At t = 1 four discs still fall freely and others slide along walls and neighbours, at t = 2 four are on their way
    to a place in the corner, at t = 3 all rest. The start has no symmetry.

    Source: the second example of section 4.2 of chapter 2 (Figure 5).
    """
    return Scene(
        START,
        constant(np.tile([0.0, -1.0], (len(START), 1))),
        [NonOverlap(RADIUS), HalfSpace(normal=(1, 1), radius=RADIUS), HalfSpace(normal=(-1, 1), radius=RADIUS)],
        name="ten_disks_corner",
        title="Ten discs falling into a corner",
        times=(1.0, 2.0, 3.0),
        radius=RADIUS,
    )
