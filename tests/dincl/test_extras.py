"""Without the libraries of the extras the core works, and whoever needs one is told which, and what brings it."""

import json
import pickle
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import dincl
from dincl.extras import PACKAGES, MissingLibrary, MissingTables, need_thesis, needs

ROOT = Path(__file__).parents[2]
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
# The import system takes None for a module that cannot be found.
WITHOUT = f"import sys; sys.modules.update(dict.fromkeys({sorted(PACKAGES)}))\n"
CORE = """
import json
import numpy as np
import dincl, meanfield, tissue, verification

scene = dincl.scenes.four_disks()
wall = dincl.Problem([[1.0, 0.0]], lambda t, x: -x, [dincl.Smooth(lambda x: x[:, 0] - 0.5, lambda x: [[1.0, 0.0]])])
paths = [dincl.solve(wall, dincl.PBD(0.1), [1.0])]
projections = (dincl.Daqp(1e-9), dincl.ProjectedCG(1e-9), dincl.ActiveSet(1e-9))
for scheme in (dincl.PBD(0.05), dincl.EventDriven(1e-9), *(dincl.CatchUp(0.05, one) for one in projections)):
    paths.append(dincl.solve(scene, scheme, [0.1]))
said = {}
asked = {
    "Clarabel": lambda: dincl.solve(scene, dincl.CatchUp(0.05, dincl.Clarabel(1e-9)), [0.1]),
    "CvxpyQP": lambda: dincl.solve(scene, dincl.CatchUp(0.05, dincl.CvxpyQP(1e-9)), [0.1]),
    "Ipopt": lambda: dincl.project(scene, scene.x0 / 2, dincl.Ipopt(1e-9)),
    "Piqp": lambda: dincl.solve(scene, dincl.CatchUp(0.05, dincl.Piqp(1e-9)), [0.1]),
    "read_fclib": lambda: dincl.projection.read_fclib("one.hdf5"),
    "plot": paths[1].plot,
    "to_frame": paths[1].forces(0.1).to_frame,
    "model": lambda: meanfield.StraightFibre(m=0.5, k0=1.0, y_rest=1.0, k1=0.5),
    "w1": lambda: meanfield.w1(np.eye(2), np.ones((2, 2))),
    "study": lambda: __import__("dincl.study"),
    "preset": lambda: tissue.preset("thesis"),
    "order_study": lambda: verification.order_study,
}
for name, ask in asked.items():
    try:
        ask()
    except dincl.InvalidProblem as missing:
        said[name] = str(missing)
line = meanfield.w1(np.arange(3.0), np.arange(3.0) + 1)
ended = [path.status.name for path in paths]
print(json.dumps({"ended": ended, "end": paths[0].final.tolist(), "w1": line, "said": said}))
"""
MESSAGES = {
    "Clarabel": "Clarabel needs clarabel, not installed here; in a clone: pip install '.[yardsticks]'",
    "CvxpyQP": "CvxpyQP needs cvxpy-base, not installed here; in a clone: pip install '.[yardsticks]'",
    "Ipopt": "Ipopt needs casadi, not installed here; in a clone: pip install '.[yardsticks]'",
    "Piqp": "Piqp needs piqp, not installed here; in a clone: pip install '.[yardsticks]'",
    "read_fclib": "read_fclib needs h5py, not installed here; in a clone: pip install '.[contact]'",
    "plot": "A picture needs matplotlib, not installed here; in a clone: pip install '.[report]'",
    "to_frame": "to_frame needs pandas, not installed here; in a clone: pip install '.[report]'",
    "model": "A model of meanfield needs casadi, not installed here; in a clone: pip install '.[meanfield]'",
    "w1": "w1 of points in d >= 2 needs POT, not installed here; in a clone: pip install '.[transport]'",
    "preset": "tissue.preset needs pydantic, not installed here; in a clone: pip install '.[tissue]'",
    "order_study": "verification.order_study needs pandas, not installed here; in a clone: pip install '.[report]'",
    "study": "dincl.study needs rich, not installed here; in a clone: pip install '.[report]'",
}
COMMANDS = {
    "from tissue.cli import main": "Error: tissue needs typer, not installed here; in a clone: pip install '.[tissue]'",
    "from verification.command import main": (
        "Error: verification needs pandas, not installed here; in a clone: pip install '.[report]'"
    ),
}


def run(code):
    """Run a program in which no library of an extra can be imported."""
    return subprocess.run([sys.executable, "-c", WITHOUT + code], cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_the_core_works_alone_and_says_what_is_missing():
    done = run(CORE)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert set(found["ended"]) == {"SUCCESS"}
    assert found["end"] == [[0.5, 0.0]]
    assert found["w1"] == 1.0
    assert found["said"] == MESSAGES


@pytest.mark.parametrize(("command", "message"), COMMANDS.items(), ids=("tissue", "verification"))
def test_a_command_without_its_libraries_ends_with_one_message(command, message):
    done = run(f"{command}\nmain()")
    assert (done.returncode, done.stderr.strip(), done.stdout) == (2, message, "")


def test_other_modules_that_are_missing_are_no_matter_of_extras(monkeypatch):
    with pytest.raises(ModuleNotFoundError, match="no_such_module") as error, needs("this", "thesis"):
        import no_such_module  # noqa: F401
    assert not isinstance(error.value, dincl.InvalidProblem)


def test_what_the_thesis_needs_names_all_that_are_missing(monkeypatch):
    need_thesis("the report")
    for name in ("flint", "cvxpy", "pyvista"):
        monkeypatch.setitem(sys.modules, name, None)
    message = r"the report needs cvxpy-base, python-flint, not installed here; .*\[thesis\]"
    with pytest.raises(MissingLibrary, match=message):
        need_thesis("the report")


def test_missing_tables_of_studies_are_named(monkeypatch):
    for package in ("verification.data", "dincl_testbed_data"):
        monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingTables, match=r"^the report needs dincl-testbed-data, .*: pip install -e '.\[thesis\]'$"):
        need_thesis("the report")


def test_the_error_goes_between_processes():
    error = pickle.loads(pickle.dumps(MissingLibrary("Ipopt", "casadi", "yardsticks")))
    assert str(error) == MESSAGES["Ipopt"]
