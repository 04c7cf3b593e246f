"""Importing loads nothing heavy, names are found all the same, and what is made does not change.

``make lint`` checks the other rules of imports.
"""

import json
import pkgutil
import re
import subprocess
import sys
from dataclasses import fields
from importlib import import_module

import pytest

import dincl
import meanfield
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


# Counted work, and what is left of a budget.
CHANGES = {"Work", "_Budget"}
# Types that NumPy does not compare to one truth value, or that hold such.
HOLD_ARRAYS = re.compile(r"Floats|Indices|Offsets|[Aa]rray|Constraint|Rows|Scaling|Stepper|TimeScales|^Any$", re.M)


@pytest.mark.parametrize("package", [dincl, meanfield])
def test_what_is_made_does_not_change_and_is_compared_only_if_it_can_be(package):
    for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        for one in vars(import_module(module.name)).values():
            if isinstance(one, type) and one.__module__ == module.name and "__dataclass_params__" in vars(one):
                types = "\n".join(str(field.type) for field in fields(one))
                assert one.__dataclass_params__.frozen == (one.__name__ not in CHANGES), one
                assert not (one.__dataclass_params__.eq and HOLD_ARRAYS.search(types)), one
