"""Generated calls: an answer without a NaN, or a documented error; never another one, a warning or a wait."""

import itertools
from importlib import import_module

import numpy as np
import pytest

import dincl
import meanfield
import tissue
from dincl import FunctionFailed
from dincl.study import StudyStopped
from meanfield.density import MAX_PANELS
from tests.borders.harness import complaints
from tests.tissue.users import shelves
from tissue.plugins import registry
from tissue.runs.registration import KINDS

ALLOWED = {
    "dincl": (dincl.InvalidProblem, dincl.StepFailed, dincl.ProjectionFailed, dincl.MinimisationFailed),
    "meanfield": (meanfield.InvalidModel, meanfield.SolveFailed),
    "tissue": (dincl.InvalidProblem, dincl.ProjectionFailed, tissue.RunFailed, StudyStopped),
}
SEED = 20260105


def complained(package, seed, count):
    """Files are written to the present folder, and what is registered is gone behind."""
    with shelves():
        before = [dict(registry(kind)) for kind in KINDS]
        found = complaints(import_module(f"tests.borders.{package}_calls").CALLS, ALLOWED[package], seed, count)
        assert [dict(registry(kind)) for kind in KINDS] == before
    return found


@pytest.mark.slow
@pytest.mark.parametrize("package", ALLOWED)
def test_generated_calls(package, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert complained(package, SEED, 1000) == []


@pytest.mark.xslow
@pytest.mark.parametrize("package", ALLOWED)
def test_many_generated_calls(package, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert complained(package, SEED + 1, 10_000) == []


# What such calls have found in functions of users of meanfield


def test_a_density_that_is_hard_to_integrate_is_refused_after_counted_work():
    seen = []

    def noise(x):
        seen.append(len(x))
        return 1.0 + np.sin(1e9 * x[:, 0])

    with pytest.raises(meanfield.InvalidModel, match="pdf is not resolved by 100000 panels of 16 values"):
        meanfield.Density(noise, 0.0, 1.0)
    assert sum(seen) < 2 * 16 * MAX_PANELS


def test_rejection_ends_after_counted_work(monkeypatch):
    monkeypatch.setattr("meanfield.density.MAX_REJECTION_ROUNDS", 3)
    monkeypatch.setattr("meanfield.density.MAX_TRIES", 10)
    density = meanfield.Density(lambda x: np.ones(len(x)), (0.0, 0.0), (1.0, 1.0))
    with pytest.raises(meanfield.InvalidModel, match=r"3 rounds of at most 10 points gave 2\d of 100 by rejection"):
        density.sample(np.random.default_rng(0), 100)


MODEL = {"g": lambda X, y: X - y, "W0": lambda y: y**2, "W1": lambda X: X**2, "V": lambda r: r**2}


@pytest.mark.parametrize("name", ["pdf", *MODEL])
def test_what_a_function_raises_is_the_cause(name):
    fails = {name: lambda *_: 1 / 0}
    message = rf"{name}\(.*\) raised ZeroDivisionError: division by zero"
    with pytest.raises(FunctionFailed, match=message) as caught:
        meanfield.Density(fails[name], 0.0, 1.0) if name == "pdf" else meanfield.Model(**MODEL | fails)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


@pytest.mark.parametrize("given", [itertools.count(), np.ones((1, 1, 1)), [[1.0], [2.0, 3.0]]])
def test_values_that_would_crash_casadi_are_refused(given):
    with pytest.raises(meanfield.InvalidModel, match=r"W0\(y\) = .*: must be built from CasADi operations"):
        meanfield.Model(**MODEL | {"W0": lambda y: given})
