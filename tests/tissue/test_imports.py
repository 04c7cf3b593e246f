"""Importing the package loads nothing heavy, and its names are found all the same."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import tissue

ROOT = Path(__file__).parents[2]


def loaded(code):
    """The top modules that a fresh interpreter has after the code."""
    code += "; import json, sys; print(json.dumps([m.partition('.')[0] for m in sys.modules]))"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return set(json.loads(run.stdout))


@pytest.mark.parametrize("code", ["import tissue", "import tissue.cli"])
def test_importing_loads_nothing_heavy(code):
    heavy = {"matplotlib", "PIL", "pydantic", "casadi", "cvxpy", "pandas", "numba", "scipy"}
    assert loaded(code).isdisjoint(heavy)


@pytest.mark.slow
def test_simulating_draws_nothing_and_makes_no_tables():
    code = "import tissue; tissue.simulate(tissue.preset('thesis').changed({'numerics.t_end': '1 h'}))"
    assert loaded(code).isdisjoint({"matplotlib", "PIL", "casadi", "cvxpy", "pandas"})


def test_public_names():
    assert set(tissue.__all__) <= set(dir(tissue))
    for name in tissue.__all__:
        assert getattr(tissue, name).__doc__
    with pytest.raises(AttributeError, match="module 'tissue' has no attribute 'simulated'"):
        _ = tissue.simulated
