"""The lists that contract tests run over."""

import pytest

import dincl
from dincl import scenes

SCENES = [
    scenes.sliding_disc(),
    scenes.two_disks(),
    scenes.stack(),
    scenes.step_inclusion(),
    scenes.sweeping_interval(),
    scenes.drum(2),
    scenes.closing_walls(),
    scenes.growing_discs(),
    scenes.four_disks(),
    scenes.ten_disks_corner(),
    scenes.pile(30),
    scenes.ball_pile(30),
]


# Projections that serve every problem; each is made from its tolerance.
PROJECTIONS = [
    pytest.param(projection, id=projection.__name__)
    for projection in (
        dincl.ActiveSet,
        dincl.Clarabel,
        dincl.CvxpyQP,
        dincl.Daqp,
        dincl.Ipopt,
        dincl.Piqp,
        dincl.ProjectedCG,
    )
]
