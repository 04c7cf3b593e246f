"""Ready-made problems, one per file."""

from dincl.scenes.ball_pile import ball_pile
from dincl.scenes.exact import Exact
from dincl.scenes.four_disks import four_disks
from dincl.scenes.pile import pile
from dincl.scenes.scene import Scene
from dincl.scenes.sliding_disc import sliding_disc
from dincl.scenes.stack import stack
from dincl.scenes.step_inclusion import step_inclusion
from dincl.scenes.sweeping_interval import sweeping_interval
from dincl.scenes.ten_disks_corner import ten_disks_corner
from dincl.scenes.two_disks import two_disks

__all__ = [
    "Exact",
    "Scene",
    "ball_pile",
    "four_disks",
    "pile",
    "sliding_disc",
    "stack",
    "step_inclusion",
    "sweeping_interval",
    "ten_disks_corner",
    "two_disks",
]
