"""Four discs that are drawn to one point and slide along each other into a rhombus."""

from __future__ import annotations

from dincl.constraints import NonOverlap
from dincl.drifts import attraction
from dincl.scenes.scene import Scene

RADIUS = 0.5
START = ((2.0, 0.2), (1.0, 1.0), (-1.5, 1.1), (1.9, -0.8))


def four_disks() -> Scene:
    """X_i' in -X_i - N_i, four discs of radius 1/2 in the plane that may not overlap; times 1 and 2.

    The five contacts are made one after another, at about t = 0.01, 0.2, 0.7, 1.3 and 1.8, and from the first on discs
    slide along each other. At t = 2 they have closed to a rhombus, which then only moves as a whole towards its
    balance. The start has no symmetry.

    Source: the first example of section 4.2 of chapter 2 (Figure 4).
    """
    return Scene(
        START,
        attraction(0),
        [NonOverlap(RADIUS)],
        name="four_disks",
        title="Four discs drawn to one point",
        times=(1.0, 2.0),
        radius=RADIUS,
    )
