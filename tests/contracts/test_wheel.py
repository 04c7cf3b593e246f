"""The wheel has all of the packages, and works where there is nothing else: outside of the tree, on every Python."""

import email
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pandas as pd
import pytest
import yaml  # comes with bokeh

from tests import installed_sizes
from tests.installing import PACKAGES, ROOT, build_wheel, installed, run

PYTHONS = ("3.11", "3.12", "3.13")
SIZES = pd.read_csv(installed_sizes.FILE, index_col="installed")["megabytes"]
CORE = """
import dincl, meanfield, tissue, verification

path = dincl.solve(dincl.scenes.ten_disks_corner(), dincl.PBD(dt=0.01), t=[0.1])
print(path.status.name, path.x.shape)
"""
PROGRAMS = {
    "dincl": """
import dincl

scene = dincl.scenes.four_disks()
for projection in (dincl.Ipopt(1e-9), dincl.Clarabel(1e-9), dincl.CvxpyQP(1e-9), dincl.Piqp(1e-9)):
    print(dincl.solve(scene, dincl.CatchUp(0.05, projection), [0.1]).status.name)
print(dincl.solve(scene, dincl.EventDriven(1e-9), [0.1]).to_frame().shape)
""",
    "meanfield": """
import numpy as np
import meanfield

model = meanfield.StraightFibre(m=0.5, k0=1.0, y_rest=1.0, k1=0.5)
start = meanfield.State(X=[[0.5], [0.7]], y=[0.9], v=[0.0])
print(meanfield.solve_ode(model, start, [0.1], 1e-8).y.shape, meanfield.w1(np.eye(2), np.ones((2, 2))))
""",
    "tissue": """
import tissue

hour = tissue.preset("published").changed({"numerics.t_end": "1 h"})
print(tissue.simulate(hour, seed=0).summary().shape)
""",
    "verification": """
import dincl
import verification as v

scene, steps = dincl.scenes.sliding_disc(), [0.1 / 2**k for k in range(5)]
print(v.save(v.order_study(scene, {"PBD": dincl.PBD}, steps, [1.0], scene.exact), "here"))
""",
}


EXTRAS = {
    "report": PROGRAMS["verification"],
    "meanfield": "import meanfield\nprint(meanfield.StraightFibre(m=0.5, k0=1.0, y_rest=1.0, k1=0.5))",
    "transport": PROGRAMS["meanfield"],
    "tissue": PROGRAMS["tissue"],
    "proofs": "import dincl, verification\nprint(verification.prove(dincl.scenes.two_disks(), [0.5]))",
    "yardsticks": PROGRAMS["dincl"].replace(".to_frame().shape", ".x.shape"),
    "explore": "from verification.explore import server",
    "cluster": "from distributed import Client\nimport tissue",
    "views": "from tissue.pictures.view import view\nimport pyvista",
}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Build the wheel once."""
    return build_wheel(tmp_path_factory.mktemp("tree"), tmp_path_factory.mktemp("wheel"))


def interpreter(version):
    """A Python of this version, which may be one that pyenv keeps; the test is skipped where there is none."""
    kept = sorted((Path.home() / ".pyenv/versions").glob(f"{version}.*/bin/python"))
    found = str(kept[-1]) if kept else shutil.which(f"python{version}")
    if found is None or subprocess.run([found, "--version"], capture_output=True, check=False).returncode:
        pytest.skip(f"Python {version} is not installed")
    return found


def test_the_wheel_has_every_file_of_the_packages(wheel):
    files = {file for name in PACKAGES for file in (ROOT / name).rglob("*") if file.is_file()}
    wanted = {file.relative_to(ROOT).as_posix() for file in files if "__pycache__" not in file.parts}
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert names == wanted


def test_the_wheel_says_what_it_is(wheel):
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        said = email.message_from_bytes(archive.read(name))
    assert said["Description-Content-Type"] == "text/markdown"
    assert said.get_payload(decode=True).decode() == (ROOT / "README.md").read_text("utf-8")
    assert said["Keywords"].split(",") == yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))["keywords"]
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    assert set(said.get_all("Provides-Extra")) == extras.keys()
    assert {f"Programming Language :: Python :: {version}" for version in PYTHONS} <= set(said.get_all("Classifier"))


@pytest.mark.xslow
@pytest.mark.parametrize("version", PYTHONS)
def test_the_core_is_small_and_runs_outside_of_the_tree(version, wheel, tmp_path):
    commands, megabytes = installed(interpreter(version), "", wheel, tmp_path)
    assert megabytes == pytest.approx(SIZES[installed_sizes.CORE], rel=0.15)
    assert run([commands / "python", "-c", CORE], cwd=tmp_path) == "SUCCESS (1, 10, 2)\n"
    said = subprocess.run([commands / "tissue", "--help"], capture_output=True, text=True, check=False)
    assert (said.returncode, "pip install '.[tissue]'" in said.stderr) == (2, True)


@pytest.mark.xslow
@pytest.mark.parametrize("extra", EXTRAS)
def test_an_extra_alone_is_as_large_as_measured_and_does_what_it_is_for(extra, wheel, tmp_path):
    commands, megabytes = installed(sys.executable, extra, wheel, tmp_path)
    assert megabytes == pytest.approx(SIZES[extra], rel=0.05)
    run([commands / "python", "-c", EXTRAS[extra]], cwd=tmp_path)


@pytest.mark.xslow
@pytest.mark.parametrize("version", PYTHONS)
def test_every_package_and_command_runs_outside_of_the_tree(version, wheel, tmp_path):
    commands, _ = installed(interpreter(version), "all", wheel, tmp_path)
    for program in PROGRAMS.values():
        run([commands / "python", "-c", program], cwd=tmp_path)
    for name in ("tissue", "verification"):
        assert "Usage" in run([commands / name, "--help"], cwd=tmp_path)
