"""Ready-made problems."""

from dincl.scenes.base import Exact, Scene
from dincl.scenes.discs import four_disks, sliding_disc, ten_disks_corner, two_disks
from dincl.scenes.line import stack, step_inclusion, sweeping_interval
from dincl.scenes.moving import closing_walls, drum, growing_discs
from dincl.scenes.piles import ball_pile, pile

__all__ = [
    "Exact",
    "Scene",
    "ball_pile",
    "closing_walls",
    "drum",
    "four_disks",
    "growing_discs",
    "pile",
    "sliding_disc",
    "stack",
    "step_inclusion",
    "sweeping_interval",
    "ten_disks_corner",
    "two_disks",
]
