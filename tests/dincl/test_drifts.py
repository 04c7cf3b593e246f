"""The usual drifts: formulas, the same bits compiled or not, content, refusals; and drifts called by their address."""

import pickle
import re
from functools import partial

import numpy as np
import pytest

import dincl
from dincl.compiled import kernel
from dincl.drifts import attraction, constant, swirl
from dincl.drifts.functions import OK, velocity

RNG = np.random.default_rng(5)
EACH = RNG.normal(size=(5, 2))
RATES = np.array([0.0, 1.0, -2.0, 1 / 3, 1e30])
DRIFTS = {
    "constant": constant((1.0, -0.3)),
    "constant of each": constant(EACH),
    "at rest": constant((0.0, 0.0)),
    "minus zero": constant((-0.0, 0.0)),
    "origin": attraction(0),
    "no rate": attraction(0, rate=0),
    "centre": attraction((1 / 3, 7.0), rate=1.7),
    "rates": attraction((0.1, 0.0), RATES),
    "rates to the origin": attraction(0, RATES),
    "swirl": swirl((0.3, -0.2), 2.2),
    "swirl about the origin": swirl(0, RATES),
    "all": constant(EACH) + attraction((1.0, 2.0), 0.1) + swirl((3.0, 4.0), RATES),
    "vanishing": attraction(0) + attraction(0, -1.0) + constant((0.0, -0.0)),
}
X = {
    "normal": RNG.normal(size=(5, 2)),
    "zeros": np.array([[0.0, -0.0], [-0.0, 0.0], [0.0, 0.0], [1.0, -0.0], [-0.0, -3.0]]),
    "wide": RNG.normal(size=(5, 2)) * 10.0 ** RNG.integers(-300, 60, size=(5, 2)),
}
drifts = pytest.mark.parametrize("drift", DRIFTS.values(), ids=DRIFTS)


@partial(kernel, references=False)
def asked(address, t, x, out, n, d, data):
    return velocity(address, t, x, out, n, d, data)


def compiled(drift, x):
    out = np.full(x.shape, 7.0)
    address, data = drift.pointer()
    assert asked(address, 0.4, x, out, *x.shape, data) == OK
    return out


def bits(values):
    return np.ascontiguousarray(values).tobytes()


@pytest.mark.parametrize("x", X.values(), ids=X)
@drifts
def test_compiled_pickled_or_not_the_bits_are_the_same(drift, x):
    assert bits(compiled(drift, x)) == bits(drift(0.4, x))
    copy = pickle.loads(pickle.dumps(drift))
    assert bits(compiled(copy, x)) == bits(copy(0.4, x)) == bits(drift(0.4, x))


@pytest.mark.parametrize(
    ("drift", "x", "expected"),
    [
        (attraction(0), X["wide"], -X["wide"]),
        (attraction((0.0, 0.0), 0.3), X["wide"], -0.3 * X["wide"]),
        (constant(EACH), X["wide"], EACH),
        (constant((-0.0, 2.0)), X["wide"], np.tile([-0.0, 2.0], (5, 1))),
        (attraction((1.0,), [1.0, 2.0]), np.array([[3.0], [3.0]]), [[-2.0], [-4.0]]),
        (swirl((1.0, 1.0), 2.0), np.array([[2.0, 1.0], [1.0, 2.0]]), [[0.0, 2.0], [-2.0, 0.0]]),
        (swirl(0, [1.0, 2.0]), np.array([[1.0, 0.0], [1.0, 0.0]]), [[-0.0, 1.0], [-0.0, 2.0]]),
        (attraction((1.0, 2.0, 4.0), 0.5) + constant((1.0, 0.0, 0.0)), np.zeros((1, 3)), [[1.5, 1.0, 2.0]]),
    ],
)
def test_formulas(drift, x, expected):
    assert bits(drift(0.0, x)) == bits(np.array(expected))


@drifts
def test_a_sum_is_the_sum(drift):
    x, other = X["normal"], attraction((0.5, 0.25), 3.0) + swirl((0.1, 0.2), 0.6)
    np.testing.assert_allclose((drift + other)(0.0, x), drift(0.0, x) + other(0.0, x), rtol=1e-14, atol=1e-14)
    with pytest.raises(TypeError):
        drift + 1.0


def test_numbers_of_a_drift_do_not_change():
    speed = np.ones((5, 2))
    drift = constant(speed)
    speed[:] = 2.0
    assert drift(0.0, X["normal"]).max() == 1.0
    with pytest.raises(ValueError, match="read-only"):
        drift(0.0, X["normal"])[0, 0] = 3.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: constant(1.0), "velocity = 1.0: must have shape (d,) or (N, d)"),
        (lambda: constant((np.nan, 0.0)), "velocity = nan at index (0,): must be finite"),
        (lambda: attraction(1.0), "centre = 1.0: must have shape (d,), or be 0 for the origin"),
        (lambda: attraction(0, [[1.0]]), "rate = [[1.0]]: must be one number, or one for each particle"),
        (lambda: attraction((1e60,), 1e60), "rate times centre"),
        (lambda: swirl((0.0, 0.0, 0.0), 1.0), "centre of shape (3,): must have shape (2,)"),
        (lambda: constant((1.0, 0.0)) + attraction((1.0, 0.0, 0.0)), "drifts of shapes (2,) and (3,) in a sum"),
        (
            lambda: attraction(0, [1.0]) + swirl(0, [1.0]) + attraction(0, [1.0, 2.0]),
            "drifts of shapes (1,) and (2,) in a sum",
        ),
        (lambda: constant((1e100,)) + constant((1e100,)), "a sum of drifts = 2e+100"),
        (
            lambda: dincl.Problem(np.zeros((4, 3)), constant((1.0, 0.0))),
            "drift: its velocity has shape (2,): must fit N = 4 particles in d = 3",
        ),
        (lambda: dincl.Problem(np.zeros((4, 2)), constant([[1.0, 0.0]])), "drift: its velocity has shape (1, 2)"),
        (lambda: dincl.Problem(np.zeros((4, 2)), attraction(0, [1.0])), "drift: its stretch has shape (1,)"),
        (lambda: dincl.Problem(np.zeros((4, 2)), swirl(0, [1.0, 2.0])), "drift: its turn has shape (2,)"),
        (lambda: dincl.Problem(np.zeros((4, 3)), swirl(0, 1.0)), "drift: a swirl needs particles in the plane, d = 2"),
    ],
)
def test_wrong_input_is_named(make, message):
    with pytest.raises(dincl.InvalidProblem, match=f"^{re.escape(message)}"):
        make()
