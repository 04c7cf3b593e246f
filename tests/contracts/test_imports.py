"""Imports run one way between the packages, and in each a heavy library is imported in one file only."""

import ast
import json
import subprocess
import sys
import tomllib
from collections.abc import Iterable
from functools import cache
from importlib.metadata import requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from dincl.extras import PACKAGES

ROOT = Path(__file__).parents[2]
MAY_IMPORT = {
    "dincl": set(),
    "meanfield": {"dincl"},
    "tissue": {"dincl"},
    "verification": {"dincl", "meanfield", "tissue"},
}
HEAVY = (
    "SALib",
    "bokeh",
    "casadi",
    "clarabel",
    "cvxpy",
    "daqp",
    "distributed",
    "matplotlib",
    "ot",
    "piqp",
    "qdldl",
    "sklearn",
    "statsmodels",
)
# What an extra is for, and what other extras serve of it: a minimiser, views, a cluster; proofs, pages of the report.
OTHER_EXTRAS = ("beyond", "explore", "formal", "proofs", "thesis")
SERVED = {
    "meanfield": ("meanfield", ("meanfield/transport/discrete.py",)),
    "report": ("verification", tuple([f"verification/{name}/" for name in OTHER_EXTRAS])),
    "tissue": ("tissue", ("tissue/quasi_steady/program.py", "tissue/pictures/scene.py", "tissue/study/run.py")),
}
NOT_WITH_DINCL = ("casadi", "cvxpy", "matplotlib", "numba", "pandas")


@cache
def imported(source: str) -> set[str]:
    """Name the top-level packages that import statements and ``import_module("...")`` calls in a source refer to."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import():
                names.update(alias.name for alias in node.names)
            case ast.ImportFrom(module=str(module), level=0):
                names.add(module)
            case ast.Call(
                func=ast.Name(id="import_module" | "__import__") | ast.Attribute(attr="import_module"),
                args=[ast.Constant(value=str(module)), *_],
            ):
                names.add(module)
    return {name.partition(".")[0] for name in names}


def sources(package: str) -> list[Path]:
    """List the source files of a package: none if it does not exist yet."""
    return sorted((ROOT / package).rglob("*.py"))


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("import tissue.cli as cli, numpy", {"tissue", "numpy"}),
        ("from verification.instruments.order import fit", {"verification"}),
        ("def f():\n    if True:\n        import casadi", {"casadi"}),
        ("from importlib import import_module\nimport_module('ot.lp')", {"importlib", "ot"}),
        ("import importlib\nimportlib.import_module('dask')", {"importlib", "dask"}),
        ("__import__('cvxpy')", {"cvxpy"}),
        ("from . import tissue\nfrom .tissue import x", set()),
        ("'import tissue'  # import tissue", set()),
    ],
)
def test_reader_sees_every_form_of_import(source: str, names: set[str]) -> None:
    assert imported(source) == names


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_arrows(package: str) -> None:
    forbidden = MAY_IMPORT.keys() - MAY_IMPORT[package] - {package}
    wrong = {str(path.relative_to(ROOT)): imported(path.read_text("utf-8")) & forbidden for path in sources(package)}
    assert not {path: names for path, names in wrong.items() if names}


@pytest.mark.parametrize("library", HEAVY)
@pytest.mark.parametrize("package", MAY_IMPORT)
def test_heavy_library_has_one_door_in_a_package(package: str, library: str) -> None:
    files = sources(package)
    doors = [str(path.relative_to(ROOT)) for path in files if library in imported(path.read_text("utf-8"))]
    assert len(doors) <= 1


def test_in_dincl_only_studies_and_trajectories_import_pandas() -> None:
    files = [path for path in sources("dincl") if "pandas" in imported(path.read_text("utf-8"))]
    assert files
    rooms = {path.parent.name for path in files if path.name != "trajectory.py"}
    assert rooms == {"study"}


def test_import_dincl_loads_nothing_heavy() -> None:
    code = "import json, sys, dincl; print(json.dumps([m.partition('.')[0] for m in sys.modules]))"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    loaded = set(json.loads(run.stdout))
    assert "dincl" in loaded
    assert loaded.isdisjoint(NOT_WITH_DINCL)


def brought(names: Iterable[str]) -> set[str]:
    """The packages that these bring, with all that they need in turn."""
    found: set[str] = set()
    todo = list(names)
    while todo:
        name = canonicalize_name(todo.pop())
        if name not in found:
            found.add(name)
            needed = [Requirement(text) for text in requires(name) or ()]
            todo += [each.name for each in needed if not each.marker or each.marker.evaluate({"extra": ""})]
    return found


@pytest.mark.parametrize("extra", SERVED)
def test_an_extra_brings_all_that_its_package_imports(extra: str) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    named = [*project["dependencies"], *project["optional-dependencies"][extra]]
    there = brought(Requirement(text).name for text in named)
    room, others = SERVED[extra]
    absent = {module for module, package in PACKAGES.items() if canonicalize_name(package) not in there}
    assert "cvxpy" in absent
    files = [path.relative_to(ROOT).as_posix() for path in sources(room)]
    wrong = {name: imported((ROOT / name).read_text("utf-8")) & absent for name in files if not name.startswith(others)}
    assert not {name: found for name, found in wrong.items() if found}
