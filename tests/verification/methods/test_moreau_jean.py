"""What the theta = 1/2 form of catch-up can do and what it cannot."""

import numpy as np
import pytest

import dincl
from verification.methods.moreau_jean import MoreauJean

DAQP = dincl.Daqp(tol=1e-11)


def circle(h):
    """Drawn around the inside of a circle, always pressed against it: no contact changes."""
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    problem = dincl.Problem([[1.0, 0.0]], lambda t, x: 2 * x + x @ turn.T, [dincl.InsideBall((0, 0), 1.0)])
    return dincl.solve(problem, MoreauJean(h, DAQP), t=[1.0]).final[0] - [np.cos(1.0), np.sin(1.0)]


def test_order_two_while_the_contact_stays():
    errors = [np.abs(circle(h)).max() for h in (0.08, 0.04, 0.02, 0.01)]
    assert np.log2(errors[0] / errors[-1]) / 3 == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 1e-4


def test_an_impact_overshoots_and_swings():
    """A point falls with speed 1 from 0.25 onto a floor, dt = 0.2: z = max(0, x - 0.1), x <- 2 z - x."""
    problem = dincl.Problem([[0.25]], lambda t, x: 0 * x - 1.0, [dincl.HalfSpace((1,))])
    path = dincl.solve(problem, MoreauJean(0.2, DAQP), t=[0.2, 0.4, 0.6, 0.8])
    assert path.x[:, 0, 0] == pytest.approx([0.05, -0.05, 0.05, -0.05], abs=1e-10)


def test_its_largest_error_is_far_above_that_of_midpoint_catch_up():
    scene, h = dincl.scenes.stack(), 1 / 64
    t = np.linspace(0, 1.5, 25)[1:]
    error = {
        scheme: np.abs(dincl.solve(scene, scheme(h, DAQP), t).x - scene.exact(t)).max()
        for scheme in (MoreauJean, dincl.MidpointCatchUp)
    }
    assert error[MoreauJean] > 20 * error[dincl.MidpointCatchUp]
