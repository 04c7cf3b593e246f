"""Imports run one way between the packages, and in each a heavy library is imported in one file only."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

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
    "pint",
    "piqp",
    "qdldl",
    "sklearn",
)
NOT_WITH_DINCL = ("casadi", "cvxpy", "matplotlib", "numba", "pandas")


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
        ("from verification.order import fit", {"verification"}),
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


def test_in_dincl_only_studies_and_frames_know_pandas() -> None:
    files = [path for path in sources("dincl") if "pandas" in imported(path.read_text("utf-8"))]
    assert files
    assert {path.parent for path in files if path.name != "frame.py"} == {ROOT / "dincl" / "study"}


def test_import_dincl_loads_nothing_heavy() -> None:
    code = "import json, sys, dincl; print(json.dumps([m.partition('.')[0] for m in sys.modules]))"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    loaded = set(json.loads(run.stdout))
    assert "dincl" in loaded
    assert loaded.isdisjoint(NOT_WITH_DINCL)
