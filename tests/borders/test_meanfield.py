"""Generated calls of meanfield: each ends quickly, without warnings, with finite numbers or a documented error."""

import itertools

import numpy as np
import pytest

import meanfield
from dincl import FunctionFailed
from meanfield.density import MAX_PANELS
from tests.borders.harness import complaints
from tests.borders.meanfield_calls import CALLS

ALLOWED = (meanfield.InvalidModel, meanfield.SolveFailed)
SEED = 20260105


@pytest.mark.slow
def test_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED, 1000) == []


@pytest.mark.xslow
def test_many_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED + 1, 10_000) == []


def noise(x):
    """Evaluate a function that oscillates too fast for polynomials."""
    return 1.0 + np.sin(1e9 * x[:, 0])


def failing(x):
    """Raise a KeyError, as a density with a mistake."""
    return {}["k"]


def test_a_density_that_is_hard_to_integrate_is_refused_after_counted_work():
    seen = []

    def counted(x):
        seen.append(len(x))
        return noise(x)

    with pytest.raises(meanfield.InvalidModel, match="pdf is not resolved by 100000 panels of 16 values"):
        meanfield.Density(counted, 0.0, 1.0)
    assert sum(seen) < 2 * 16 * MAX_PANELS


def test_rejection_ends_after_counted_work(monkeypatch):
    monkeypatch.setattr("meanfield.density.MAX_REJECTION_ROUNDS", 3)
    monkeypatch.setattr("meanfield.density.MAX_TRIES", 10)
    density = meanfield.Density(lambda x: np.ones(len(x)), (0.0, 0.0), (1.0, 1.0))
    with pytest.raises(meanfield.InvalidModel, match=r"3 rounds of at most 10 points gave 2\d of 100 by rejection"):
        density.sample(np.random.default_rng(0), 100)


def test_what_a_pdf_raises_is_the_cause():
    with pytest.raises(FunctionFailed, match=r"pdf\(x of shape \(16, 1\)\) raised KeyError: 'k'") as caught:
        meanfield.Density(failing, 0.0, 1.0)
    assert isinstance(caught.value.__cause__, KeyError)


@pytest.mark.parametrize("name", ["g", "W0", "W1", "V"])
def test_what_a_function_of_a_model_raises_is_the_cause(name):
    functions = {"g": lambda X, y: X - y, "W0": lambda y: y**2, "W1": lambda X: X**2, "V": lambda r: r**2}
    functions[name] = lambda *_: 1 / 0
    with pytest.raises(
        FunctionFailed, match=rf"{name}\(.* = .*\) raised ZeroDivisionError: division by zero"
    ) as caught:
        meanfield.Model(**functions)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


@pytest.mark.parametrize("given", [itertools.count(), np.ones((1, 1, 1)), [[1.0], [2.0, 3.0]]])
def test_values_that_would_crash_casadi_are_refused(given):
    with pytest.raises(meanfield.InvalidModel, match=r"W0\(y\) = .*: must be built from CasADi operations"):
        meanfield.Model(lambda X, y: X - y, lambda y: given, lambda X: X**2)
