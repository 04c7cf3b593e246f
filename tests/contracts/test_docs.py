"""Every public name says what it is; schemes and projections say what they compute and where it comes from."""

import inspect
import re

import pytest

import dincl
from dincl import FixedStep

PUBLIC = [getattr(dincl, name) for name in dincl.__all__ if not inspect.ismodule(getattr(dincl, name))]
MODULES = (dincl.constraints, dincl.drifts, dincl.geometry, dincl.projection, dincl.rows)
PUBLIC += [getattr(module, name) for module in MODULES for name in module.__all__ if not hasattr(dincl, name)]
SCHEMES = [item for item in FixedStep.__subclasses__() if item.__module__.startswith("dincl.")]
FUNCTIONS = [item for item in vars(dincl.scenes).values() if inspect.isfunction(item)]


@pytest.mark.parametrize("item", [*PUBLIC, *FUNCTIONS], ids=lambda item: item.__name__)
def test_public_names_are_described(item):
    text = inspect.getdoc(item) or ""
    assert len(text) > 30
    assert not text.startswith(f"{item.__name__}(")  # what dataclass writes by itself


@pytest.mark.parametrize("item", [item for item in PUBLIC if inspect.isclass(item)], ids=lambda item: item.__name__)
def test_public_methods_are_described(item):
    for name, method in inspect.getmembers(item, inspect.isfunction):
        if not name.startswith("_"):
            assert inspect.getdoc(method), f"{item.__name__}.{name}"


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda item: item.__name__)
def test_schemes_give_their_formula_and_source(scheme):
    text = inspect.getdoc(scheme)
    assert "x_{k+1} =" in text
    assert re.search(r"Method \d|\(\d\.\d+\)|section \d", text)


@pytest.mark.parametrize("name", dincl.constraints.__all__)
def test_constraints_give_their_formula(name):
    assert re.search(r"g.*\(x\).*>= 0|S\(t\) =", inspect.getdoc(getattr(dincl.constraints, name)))
