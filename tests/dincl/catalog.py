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
    scenes.four_disks(),
    scenes.ten_disks_corner(),
    scenes.pile(30),
    scenes.ball_pile(30),
]


def spring(dt):
    """The penalty method with the strength that its stability limit allows, so that it converges with dt."""
    return dincl.Penalty(dt, strength=0.4 / dt)


# Schemes for the first-order inclusion, as functions of dt.
FIRST_ORDER = [
    pytest.param(dincl.PBD, id="PBD"),
    pytest.param(lambda dt: dincl.PBD(dt, sweeps=4), id="PBD-4-sweeps"),
    pytest.param(lambda dt: dincl.CatchUp(dt, dincl.Daqp(1e-10)), id="CatchUp"),
    pytest.param(lambda dt: dincl.LinearisedCatchUp(dt, dincl.Daqp(1e-10)), id="LinearisedCatchUp"),
    pytest.param(lambda dt: dincl.MidpointCatchUp(dt, dincl.Daqp(1e-10)), id="MidpointCatchUp"),
    pytest.param(spring, id="Penalty"),
]
SCHEMES = [*FIRST_ORDER, pytest.param(dincl.SecondOrderPBD, id="SecondOrderPBD")]

# Projections that serve every problem; each is made from its tolerance.
PROJECTIONS = [
    pytest.param(projection, id=projection.__name__)
    for projection in (
        dincl.Clarabel,
        dincl.CvxpyQP,
        dincl.Daqp,
        dincl.GaussSeidel,
        dincl.Ipopt,
        dincl.Piqp,
        dincl.ProjectedCG,
    )
]
