"""Minimisers that do not arrive: limits, blow-ups and drifts that fail are reported; wrong input is refused."""

import numpy as np
import pytest

import dincl
from dincl.minimise import (
    ArrowHurwicz,
    MinimisationFailed,
    RelativeMove,
    Stationary,
    Uzawa,
    minimise,
)
from tests.dincl.minimise.problems import STOP, TOL, WALL, damped, pressed, towards_origin, weight


@pytest.mark.parametrize("method", [ArrowHurwicz(0.1, 0.1, STOP, 3), damped(limit=3), Uzawa(0.5, STOP, 1)])
def test_limit_is_reported(method):
    with pytest.raises(MinimisationFailed, match=r"NOT_CONVERGED: .* After \d of at most \d steps") as failure:
        minimise(pressed(), method)
    found = failure.value.minimum
    assert found.iterations == method.limit
    assert found.status is dincl.Status.NOT_CONVERGED
    assert found.residual > TOL
    assert "NOT_CONVERGED" in repr(found)


@pytest.mark.parametrize("method", [ArrowHurwicz(30.0, 30.0, STOP), damped(30.0, 30.0), damped(30.0, squared=True)])
def test_blow_up_is_reported_with_finite_numbers(method):
    found = minimise(towards_origin(), method, throw=False)
    assert found.status is dincl.Status.NON_FINITE
    assert np.isfinite(found.x).all()
    assert np.isfinite(found.multipliers).all()
    assert found.iterations < method.limit


def test_coincident_centres_are_reported():
    """W alone puts both discs on one point, where Uzawa's first step leaves them."""
    problem = dincl.Problem([[-1.0], [1.0]], lambda t, x: -x, [dincl.NonOverlap(0.5)])
    found = minimise(problem, Uzawa(0.5, STOP, 50), throw=False)
    assert found.status is dincl.Status.COINCIDENT_CENTRES
    assert found.residual == np.inf


def test_drift_that_fails_is_reported():
    def drift(t, x):
        if x[0, 0] > 1:
            raise ValueError("too far")
        return np.ones_like(x)

    found = minimise(dincl.Problem([[0.0]], drift, []), ArrowHurwicz(0.3, 0.1, STOP), throw=False)
    assert found.status is dincl.Status.DRIFT_FAILED
    assert found.residual == np.inf


def test_uzawa_reports_a_lagrangian_without_minimum():
    found = minimise(weight(1.0), Uzawa(0.5, STOP, 50), throw=False)
    assert found.status is dincl.Status.NOT_CONVERGED
    assert "Lagrangian" in found.detail


def test_uzawa_does_not_find_a_minimum_where_the_lagrangian_has_none():
    """W = x - x^2/4 on x >= 0 has a strict local minimum at 0, but W - lambda x is concave."""
    problem = dincl.Problem([[0.05]], lambda t, x: x / 2 - 1, [WALL])
    found = minimise(problem, Uzawa(0.5, STOP, 50), throw=False)
    assert found.status is dincl.Status.NOT_CONVERGED
    assert "no minimum" in found.detail


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ArrowHurwicz(0.0, 0.1, STOP), r"alpha = 0\.0: must be a finite number > 0"),
        (lambda: ArrowHurwicz(0.1, -1.0, STOP), r"beta = -1\.0: must"),
        (lambda: ArrowHurwicz(0.1, 0.1, 1e-6), r"stop = 1e-06: must be Stationary"),
        (lambda: ArrowHurwicz(0.1, 0.1, STOP, 0), r"limit = 0: must be an integer >= 1"),
        (lambda: ArrowHurwicz(0.1, 0.1, STOP, 10, 1), r"squared = 1: must be True or False"),
        (lambda: damped(gamma=-1.0), r"gamma = -1\.0: must be a finite number >= 0"),
        (lambda: damped(damping=0.0), r"damping = 0\.0"),
        (lambda: damped(dtau=np.nan), r"dtau = nan"),
        (lambda: Uzawa(0.1, RelativeMove(1e-3)), r"stop = .*: must be Stationary"),
        (lambda: Uzawa(0.0, STOP), r"step = 0\.0"),
        (lambda: Stationary(0.0), r"tol = 0\.0"),
        (lambda: RelativeMove(-1.0), r"eps = -1\.0"),
        (lambda: minimise(None, damped()), r"problem = None: must be a dincl\.Problem"),
        (lambda: minimise(pressed(), dincl.PBD(0.1)), r"minimiser = .*: must be a minimiser"),
    ],
)
def test_bad_input_is_refused(make, words):
    with pytest.raises(dincl.InvalidProblem, match=words):
        make()
