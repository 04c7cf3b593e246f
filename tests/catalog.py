"""The lists that contract tests run over."""

from dincl import scenes

SCENES = [
    scenes.sliding_disc(),
    scenes.two_disks(),
    scenes.stack(),
    scenes.step_inclusion(),
    scenes.sweeping_interval(),
    scenes.four_disks(),
    scenes.ten_disks_corner(),
    scenes.pile(30),
    scenes.ball_pile(30),
]
