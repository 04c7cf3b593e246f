"""Importing loads nothing heavy, and names are found all the same; ``make lint`` checks the other rules of imports."""

import json
import subprocess
import sys

import pytest

import tissue
from tests.pages import ROOT

HEAVY = {"casadi", "cvxpy", "matplotlib", "PIL", "numba", "pandas", "pydantic"}
GROWS = "import tissue; tissue.simulate(tissue.preset('thesis').changed({'numerics.t_end': '1 h'}))"


@pytest.mark.slow_with("simulate")
@pytest.mark.parametrize(
    ("code", "heavy"),
    [
        ("import dincl", HEAVY),
        ("import tissue", HEAVY | {"scipy"}),
        ("import tissue.cli", HEAVY | {"scipy"}),
        (GROWS, HEAVY - {"numba", "pydantic"}),
    ],
)
def test_nothing_heavy_is_loaded_before_it_is_needed(code, heavy):
    code += "; import json, sys; print(json.dumps([m.partition('.')[0] for m in sys.modules]))"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert heavy.isdisjoint(json.loads(run.stdout))


def test_public_names_of_tissue():
    assert set(tissue.__all__) <= set(dir(tissue))
    assert all(getattr(tissue, name).__doc__ for name in tissue.__all__)
    with pytest.raises(AttributeError, match="module 'tissue' has no attribute 'simulated'"):
        _ = tissue.simulated
