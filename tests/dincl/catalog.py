"""The lists that contract tests run over."""

import numpy as np
import pytest

import dincl
from dincl import scenes
from tests.dincl.own_constraints import InBall, InEllipse, InEllipseByRows

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


def spring(dt):
    """The penalty method with the strength that its stability limit allows, so that it converges with dt."""
    return dincl.Penalty(dt, strength=0.4 / dt)


# Schemes for the first-order inclusion, as functions of dt.
FIRST_ORDER = [
    pytest.param(dincl.PBD, id="PBD"),
    pytest.param(lambda dt: dincl.PBD(dt, sweeps=4), id="PBD-4-sweeps"),
    pytest.param(lambda dt: dincl.XPBD(dt, sweeps=8), id="XPBD-8-sweeps"),
    pytest.param(lambda dt: dincl.CatchUp(dt, dincl.Daqp(1e-10)), id="CatchUp"),
    pytest.param(lambda dt: dincl.LinearisedCatchUp(dt, dincl.Daqp(1e-10)), id="LinearisedCatchUp"),
    pytest.param(lambda dt: dincl.MidpointCatchUp(dt, dincl.Daqp(1e-10)), id="MidpointCatchUp"),
    pytest.param(lambda dt: dincl.CatchUp(dt, dincl.ActiveSet(1e-10)), id="CatchUp-compiled"),
    pytest.param(lambda dt: dincl.LinearisedCatchUp(dt, dincl.ActiveSet(1e-10)), id="LinearisedCatchUp-compiled"),
    pytest.param(lambda dt: dincl.MidpointCatchUp(dt, dincl.ActiveSet(1e-10)), id="MidpointCatchUp-compiled"),
    pytest.param(spring, id="Penalty"),
]
SCHEMES = [*FIRST_ORDER, pytest.param(dincl.SecondOrderPBD, id="SecondOrderPBD")]

# Projections that serve every problem; each is made from its tolerance.
PROJECTIONS = [
    pytest.param(projection, id=projection.__name__)
    for projection in (
        dincl.ActiveSet,
        dincl.Clarabel,
        dincl.CvxpyQP,
        dincl.Daqp,
        dincl.GaussSeidel,
        dincl.Ipopt,
        dincl.Piqp,
        dincl.ProjectedCG,
        dincl.ProjectedNewton,
    )
]

RADII = np.array([0.3, 0.5, 0.4, 0.2, 0.35, 0.45])
LINKS = [(0, 1), (4, 2), (3, 5)]
DISCS = [5, 0, 3, 1]


def quadratic(x):
    return np.array([x[0] @ x[0] - 0.5, x[1] @ x[2] + 0.1])


def quadratic_jacobian(x):
    rows = np.zeros((2, *x.shape))
    rows[0, 0] = 2 * x[0]
    rows[1, 1], rows[1, 2] = x[2], x[1]
    return rows


def axes(d):
    return tuple(0.8 + 0.4 * np.arange(d))


def gap(x, i, j):
    return np.linalg.norm(x[i] - x[j])


# Every constraint for six particles in dimension d, and beside it g(x) typed from its definition, row by row.
CONSTRAINTS = {
    "NonOverlap": (
        lambda d: dincl.NonOverlap(RADII),
        lambda x: [gap(x, i, j) - RADII[i] - RADII[j] for i in range(6) for j in range(i)],
    ),
    "NonOverlap of some": (
        lambda d: dincl.NonOverlap(2 * RADII[:4], among=DISCS),
        lambda x: [gap(x, DISCS[k], DISCS[m]) - 2 * (RADII[k] + RADII[m]) for k in range(4) for m in range(k)],
    ),
    "HalfSpace": (
        lambda d: dincl.HalfSpace(np.arange(1, d + 1), offset=0.1, radius=RADII),
        lambda x: x @ np.arange(1, x.shape[1] + 1) / np.linalg.norm(np.arange(1, x.shape[1] + 1)) - 0.1 - RADII,
    ),
    "MaxDistance": (
        lambda d: dincl.MaxDistance(LINKS, [0.5, 1.0, 1.5]),
        lambda x: [length - gap(x, i, j) for (i, j), length in zip(LINKS, [0.5, 1.0, 1.5], strict=True)],
    ),
    "Ordered": (
        lambda d: dincl.Ordered([2, 0, 5, 1], axis=d - 1),
        lambda x: [x[0, -1] - x[2, -1], x[5, -1] - x[0, -1], x[1, -1] - x[5, -1]],
    ),
    "OutsideBall": (
        lambda d: dincl.OutsideBall(np.full(d, 0.1), 0.7 + RADII),
        lambda x: [np.linalg.norm(x[i] - 0.1) - 0.7 - RADII[i] for i in range(6)],
    ),
    "InsideBall": (
        lambda d: dincl.InsideBall(np.full(d, 0.1), 0.7),
        lambda x: [0.7 - np.linalg.norm(x[i] - 0.1) for i in range(6)],
    ),
    "Smooth": (lambda d: dincl.Smooth(quadratic, quadratic_jacobian), quadratic),
    "own": (lambda d: InEllipse(axes(d)), lambda x: [1 - sum((y / axes(len(y))) ** 2) for y in x]),
    "own rows": (lambda d: InEllipseByRows(axes(d)), lambda x: [1 - sum((y / axes(len(y))) ** 2) for y in x]),
    "own sweep": (lambda d: InBall(0.7), lambda x: [0.7 - np.linalg.norm(y) for y in x]),
}
