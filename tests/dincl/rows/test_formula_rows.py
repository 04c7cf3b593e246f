"""A compiled kind of row of a user: one formula and a class, in every scheme, without a call of Python."""

import numpy as np
import pytest

import dincl
from dincl.rows import FormulaRows
from dincl.rows.formulas import row_formula
from tests.dincl.catalog import PROJECTIONS
from tests.dincl.own_constraints import AngleLimit, AngleLimitByHand

SCHEMES = [
    pytest.param(dincl.PBD(0.02, sweeps=2), id="PBD"),
    pytest.param(dincl.XPBD(0.02, sweeps=2), id="XPBD"),
    pytest.param(dincl.SecondOrderPBD(0.02), id="SecondOrderPBD"),
    pytest.param(dincl.Penalty(0.002, strength=20.0), id="Penalty"),
    pytest.param(dincl.CatchUp(0.02, dincl.ActiveSet(1e-10)), id="CatchUp"),
    pytest.param(dincl.LinearisedCatchUp(0.02, dincl.ActiveSet(1e-10)), id="LinearisedCatchUp"),
    pytest.param(dincl.MidpointCatchUp(0.02, dincl.ActiveSet(1e-10)), id="MidpointCatchUp"),
    pytest.param(dincl.EventDriven(1e-9), id="EventDriven"),
]
LIMIT = AngleLimit((0, 1, 2, 3, 4), cosine=-0.75)


def bent(d, constraint, moving):
    """A chain of five particles that is pressed together from both ends, so that its angles become smaller."""
    x0 = np.zeros((5, d))
    x0[:, 0], x0[1::2, 1] = np.arange(5), 0.3
    if d == 3:
        x0[:, 2] = 0.1 * np.arange(5) ** 2
    if moving:
        constraint = dincl.Moving(constraint, lambda t: np.full(d, 0.2 * np.sin(t)))
    threads = dincl.MaxDistance([(k, k + 1) for k in range(4)], 1.5)
    press = np.zeros((5, d))
    press[:, 0] = 0.15 * (2 - np.arange(5))
    return dincl.Problem(x0, dincl.drifts.constant(press), [threads, constraint, dincl.NonOverlap(0.2)])


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_it_is_what_the_same_set_in_numpy_is(scheme, d, moving):
    sets = (LIMIT, AngleLimitByHand(LIMIT))
    found, expected = (dincl.solve(bent(d, one, moving), scheme, t=[0.5, 1.5]) for one in sets)
    assert found.x == pytest.approx(expected.x, abs=1e-8)
    close = AngleLimitByHand(LIMIT).values(expected.final - (0.2 * np.sin(1.5) if moving else 0.0))
    assert close.min() < 0.05
    assert (found.stats.callbacks == 0) is not moving
    assert found.stats.callbacks <= expected.stats.callbacks


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_every_projection_takes_it(projection, rng):
    problem = bent(3, LIMIT, moving=False)
    y = problem.x0 + 0.2 * rng.normal(size=problem.x0.shape)
    found, expected = (
        dincl.project(bent(3, one, moving=False), y, projection(1e-9)) for one in (LIMIT, AngleLimitByHand(LIMIT))
    )
    assert found.residual <= 1e-9
    assert found.point == pytest.approx(expected.point, abs=1e-7)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_rows_that_are_taken_and_shifted(d, rng):
    x, shift = rng.normal(size=(5, d)), rng.normal(size=d)
    rows, other = LIMIT.select(x, 0.1), AngleLimitByHand(LIMIT)
    assert rows.values(x) == pytest.approx(other.values(x))
    assert rows.jacobian(x).toarray() == pytest.approx(other.jacobian(x), abs=1e-12)
    assert rows.shifted(shift).values(x + shift) == pytest.approx(rows.values(x))
    one = rows.take(np.array([False, True, False]))
    assert one.values(x).tolist() == rows.values(x)[1:2].tolist()
    assert one.keys().tolist() == rows.keys()[1:2].tolist()
    assert len(np.unique(rows.keys(), axis=0)) == 3
    assert one.label(0, d) == "particles 1, 2, 3"


@row_formula
def outside(t, x, out, entries, d, parameter):
    """g = |X|^2 - c."""
    square = 0.0
    for k in range(d):
        square += x[k] * x[k]
        out[k] = 2.0 * x[k]
    out[entries] = square - parameter[0]
    return 0


def test_rows_that_depend_on_the_place_are_carried_with_it(rng):
    """Angles do not."""
    x, shift = rng.normal(size=(3, 2)), rng.normal(size=2)
    rows = FormulaRows(outside, np.array([[0], [2]]), np.array([[0.5], [2.0]]))
    carried = rows.shifted(shift)
    assert rows.values(x) == pytest.approx((x[[0, 2]] ** 2).sum(axis=1) - [0.5, 2.0])
    assert carried.values(x + shift) == pytest.approx(rows.values(x))
    assert carried.jacobian(x + shift).toarray() == pytest.approx(rows.jacobian(x).toarray())


@pytest.mark.parametrize(
    "scheme", [dincl.PBD(1.0), dincl.CatchUp(1.0, dincl.ActiveSet(1e-9)), dincl.Penalty(1.0, 1e-9)]
)
def test_a_state_without_derivative_ends_the_run(scheme):
    """The first two particles lie on one point after a step."""
    x0 = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    drift = lambda t, x: np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]])  # noqa: E731
    problem = dincl.Problem(x0, drift, [AngleLimit((0, 1, 2), cosine=-0.5)])
    path = dincl.solve(problem, scheme, t=[2.0], throw=False)
    assert path.status is dincl.Status.CONSTRAINT_FAILED
    assert "g has no derivative at particles 0, 1, 2" in path.detail
