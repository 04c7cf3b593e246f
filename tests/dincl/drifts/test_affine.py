"""The usual drifts: their formulas, the same bits compiled or not, content, and what they refuse."""

import os
import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import dincl
from dincl.drifts import attraction, constant, swirl
from dincl.drifts.functions import OK
from tests.dincl.system.drift_runs import asked

ROOT = Path(__file__).parents[3]
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
    "rates to the origin of the plane": attraction((0.0, 0.0), RATES),
    "swirl": swirl((0.3, -0.2), 2.2),
    "swirl about the origin": swirl(0, RATES),
    "two": swirl(0, 1.0) + attraction(0),
    "all": constant(EACH) + attraction((1.0, 2.0), 0.1) + swirl((3.0, 4.0), RATES),
    "vanishing": attraction(0) + attraction(0, -1.0) + constant((0.0, -0.0)),
}
X = {
    "normal": RNG.normal(size=(5, 2)),
    "zeros": np.array([[0.0, -0.0], [-0.0, 0.0], [0.0, 0.0], [1.0, -0.0], [-0.0, -3.0]]),
    "wide": RNG.normal(size=(5, 2)) * 10.0 ** RNG.integers(-300, 60, size=(5, 2)),
}


def compiled(drift, x):
    out = np.full(x.shape, 7.0)
    address, data = drift.pointer()
    assert asked(address, 0.4, x, out, *x.shape, data) == OK
    return out


def bits(values):
    return np.ascontiguousarray(values).tobytes()


@pytest.mark.parametrize("x", X.values(), ids=X)
@pytest.mark.parametrize("drift", DRIFTS.values(), ids=DRIFTS)
def test_compiled_or_not_the_bits_are_the_same(drift, x):
    assert drift(0.4, x).shape == x.shape
    assert bits(compiled(drift, x)) == bits(drift(0.4, x))


@pytest.mark.parametrize("x", X.values(), ids=X)
def test_the_plain_ones_are_exact(x):
    assert bits(attraction(0)(0.0, x)) == bits(-x)
    assert bits(attraction((0.0, 0.0), 0.3)(0.0, x)) == bits(-0.3 * x)
    assert bits(constant(EACH)(0.0, x)) == bits(EACH)
    assert bits(constant((-0.0, 2.0))(0.0, x)) == bits(np.tile([-0.0, 2.0], (5, 1)))


@pytest.mark.parametrize("d", [1, 2, 3])
def test_attraction_and_constant_in_any_dimension(d):
    x, centre = RNG.normal(size=(4, d)), np.arange(1.0, d + 1)
    drift = attraction(centre, 0.7) + constant(centre)
    np.testing.assert_allclose(drift(0.0, x), -0.7 * (x - centre) + centre, rtol=0, atol=1e-14)
    assert bits(compiled(drift, x)) == bits(drift(0.0, x))


def test_swirl_turns_counter_clockwise_about_its_centre():
    drift = swirl((1.0, 1.0), 2.0)
    assert drift(0.0, np.array([[2.0, 1.0], [1.0, 2.0], [1.0, 1.0]])).tolist() == [[0.0, 2.0], [-2.0, 0.0], [0.0, 0.0]]


def test_rates_belong_to_particles():
    assert attraction((1.0,), [1.0, 2.0])(0.0, np.array([[3.0], [3.0]])).tolist() == [[-2.0], [-4.0]]
    assert swirl(0, [1.0, 2.0])(0.0, np.array([[1.0, 0.0], [1.0, 0.0]])).tolist() == [[0.0, 1.0], [0.0, 2.0]]


@pytest.mark.parametrize("drift", DRIFTS.values(), ids=DRIFTS)
def test_a_sum_is_the_sum(drift):
    x, other = X["normal"], attraction((0.5, 0.25), 3.0) + swirl((0.1, 0.2), 0.6)
    np.testing.assert_allclose((drift + other)(0.0, x), drift(0.0, x) + other(0.0, x), rtol=1e-14, atol=1e-14)


def test_drifts_are_what_their_numbers_are():
    assert constant([1, 2]) == constant((1.0, 2.0))
    assert hash(constant([1, 2])) == hash(constant((1.0, 2.0)))
    assert constant([1, 2]) != constant([[1, 2]])
    assert attraction(0) != attraction(0, 2.0)
    assert attraction(0) != swirl(0, -1.0)
    assert attraction(0) != "attraction"
    assert len({attraction(0), attraction(0, 1), attraction(0, 2)}) == 2


@pytest.mark.parametrize("drift", DRIFTS.values(), ids=DRIFTS)
def test_drifts_pickle(drift):
    drift(0.0, X["normal"]), drift.pointer()  # whatever it keeps by then
    copy = pickle.loads(pickle.dumps(drift))
    assert copy == drift
    assert bits(copy(0.0, X["normal"])) == bits(drift(0.0, X["normal"]))
    assert bits(compiled(copy, X["normal"])) == bits(drift(0.0, X["normal"]))


def test_a_drift_does_not_change_with_what_it_was_made_of():
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
        (lambda: constant([]), "velocity = []: must have shape (d,) or (N, d)"),
        (lambda: constant((np.nan, 0.0)), "velocity = nan at index (0,): must be finite"),
        (lambda: constant("up"), "velocity = 'up': must be finite real numbers"),
        (lambda: attraction(1.0), "centre = 1.0: must have shape (d,), or be 0 for the origin"),
        (lambda: attraction([[0.0, 0.0]]), "centre = [[0.0, 0.0]]: must have shape (d,)"),
        (lambda: attraction(0, np.inf), "rate = inf at index (): must be finite"),
        (lambda: attraction(0, [[1.0]]), "rate = [[1.0]]: must be one number, or one for each particle"),
        (lambda: attraction((1e60,), 1e60), "rate times centre"),
        (lambda: swirl((0.0, 0.0, 0.0), 1.0), "centre of shape (3,): must have shape (2,)"),
        (lambda: constant((1.0, 0.0)) + attraction((1.0, 0.0, 0.0)), "shapes (2,) and (3,) in a sum"),
        (lambda: attraction(0, [1.0]) + swirl(0, [1.0]) + attraction(0, [1.0, 2.0]), "shapes (1,) and (2,) in a sum"),
        (lambda: constant((1e100,)) + constant((1e100,)), "a sum of drifts = 2e+100"),
    ],
)
def test_wrong_input_is_named(make, message):
    with pytest.raises(dincl.InvalidProblem, match=re.escape(message)):
        make()


@pytest.mark.parametrize(
    ("drift", "shape", "message"),
    [
        (constant((1.0, 0.0)), (4, 3), "drift: its velocity has shape (2,): must fit N = 4 particles in d = 3"),
        (constant([[1.0, 0.0]]), (4, 2), "drift: its velocity has shape (1, 2)"),
        (attraction(0, [1.0]), (4, 2), "drift: its stretch has shape (1,)"),
        (attraction((1.0, 0.0), [1.0] * 3), (4, 2), "drift: its velocity has shape (3, 2)"),
        (swirl(0, [1.0, 2.0]), (4, 2), "drift: its turn has shape (2,)"),
        (swirl(0, 1.0), (4, 3), "drift: a swirl needs particles in the plane, d = 2, but they have d = 3"),
    ],
)
def test_a_problem_refuses_a_drift_that_does_not_fit(drift, shape, message):
    with pytest.raises(dincl.InvalidProblem, match=f"^{re.escape(message)}"):
        dincl.Problem(np.zeros(shape), drift)


def test_only_drifts_are_added():
    with pytest.raises(TypeError):
        attraction(0) + 1.0


@pytest.mark.slow
def test_the_machine_code_is_kept(tmp_path):
    program = (
        "import dincl, sys\n"
        "assert 'numba' not in sys.modules\n"
        "dincl.drifts.attraction(0).pointer()\n"
        "from dincl.drifts.functions import affine\n"
        "print(affine.cache_hits)"
    )
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    runs = [
        subprocess.run([sys.executable, "-c", program], env=env, cwd=ROOT, capture_output=True, text=True, check=True)
        for _ in range(2)
    ]
    assert [run.stdout.strip() for run in runs] == ["0", "1"]
    assert [run.stderr for run in runs] == ["", ""]
