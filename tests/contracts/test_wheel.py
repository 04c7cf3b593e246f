"""The wheel has all of the packages, and works where there is nothing else: outside of the tree, on every Python."""

import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

from tests.installing import (
    AUDIT,
    BESIDE,
    LEFTOVERS,
    PACKAGES,
    ROOT,
    TABLES,
    build_sdist,
    build_wheels,
    copy_sources,
    installed,
    pip,
    run,
)
from tests.optional import need_rendering

PYTHONS = ("3.11", "3.12", "3.13")
FILES = ("pyproject.toml", f"{TABLES}/pyproject.toml")
OF_PAGES = (".css", ".csv", ".html", ".md", ".png", ".py")
LARGEST = {"packages": 2e6, "tables": 4.5e6}  # bytes
CORE = """
import dincl, meanfield, tissue, verification

path = dincl.solve(dincl.scenes.ten_disks_corner(), dincl.PBD(dt=0.01), t=[0.1])
print(path.status.name, path.x.shape)
"""
SOLVED = """
import dincl

scene = dincl.scenes.four_disks()
for projection in (dincl.Ipopt(1e-9), dincl.Clarabel(1e-9), dincl.CvxpyQP(1e-9), dincl.Piqp(1e-9)):
    print(dincl.solve(scene, dincl.CatchUp(0.05, projection), [0.1]).status.name)
"""
ORDERS = """
import dincl
import verification as v

scene, steps = dincl.scenes.sliding_disc(), [0.1 / 2**k for k in range(5)]
print(v.save(v.order_study(scene, {"PBD": dincl.PBD}, steps, [1.0], scene.exact), "here"))
"""
GROWN = """
import tissue

run = tissue.simulate(tissue.preset("published").changed({"numerics.t_end": "1 h"}), seed=1)
print(run.summary().shape)
"""
EXPLORE = """
import subprocess, sys
from pathlib import Path
from urllib.request import urlopen

command = [str(Path(sys.executable).parent / "tissue"), "explore", "--no-browser"]
server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
try:
    page = urlopen(server.stdout.readline().strip(), timeout=60)
    assert page.status == 200 and "html" in page.read().decode()
finally:
    server.terminate()
    server.wait(60)
"""
VIEW = """
import tissue

sheet = tissue.preset("published").changed({"tissue.dimension": 3, "tissue.cells": 196, "numerics.t_end": "0.2 h"})
tissue.simulate(sheet, seed=1).view("sheet.png")
"""
MODEL = """
import meanfield

model = meanfield.StraightFibre(m=0.5, k0=1.0, y_rest=1.0, k1=0.5)
start = meanfield.State(X=[[0.5], [0.7]], y=[0.9], v=[0.0])
dae, ode = (solve(model, start, [0.5], 1e-8) for solve in (meanfield.solve_dae, meanfield.solve_ode))
assert abs(dae.y - ode.y).max() < 1e-6
assert meanfield.w1(dae.X[-1], ode.X[-1]) < 1e-6
"""
PROOF = """
import dincl, verification

print(verification.prove(dincl.scenes.two_disks(), [0.5]).bound)
"""
CONTACT = """
import h5py
from dincl.projection import read_fclib

with h5py.File("one.hdf5", "w") as made:
    made["fclib_local/spacedim"] = [1]
    made["fclib_local/vectors/mu"], made["fclib_local/vectors/q"] = [0.0], [-1.0]
    for name, value in {"nz": 1, "i": 0, "p": 0, "x": 2.0}.items():
        made[f"fclib_local/W/{name}"] = [value]
assert abs(read_fclib("one.hdf5").solve().multipliers[0] - 0.5) < 1e-12
"""
# Of the thesis here the libraries; test_the_claims_are_decided_from_the_tables has its commands.
EXTRAS = {
    "contact": CONTACT,
    "report": ORDERS,
    "meanfield": MODEL,
    "transport": "import meanfield, numpy\nprint(meanfield.w1(numpy.eye(2), numpy.ones((2, 2))))",
    "tissue": GROWN,
    "proofs": PROOF,
    "yardsticks": SOLVED,
    "explore": EXPLORE,
    "views": VIEW,
    "data": GROWN + 'assert run.to_xarray().sizes["time_h"] == 2',
    "thesis": PROOF + ORDERS + GROWN + MODEL,
}


@pytest.fixture
def folder(tmp_path):
    """Make a folder for an environment, which is removed at the end: it has up to 2.5 GB."""
    yield tmp_path
    shutil.rmtree(tmp_path / "venv", ignore_errors=True)


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """Copy the sources once."""
    return copy_sources(tmp_path_factory.mktemp("tree"))


@pytest.fixture(scope="module")
def wheels(tree, tmp_path_factory):
    """Build the wheels of the packages and of the tables once."""
    return build_wheels(tree, tmp_path_factory.mktemp("wheels"))


@pytest.fixture(scope="module")
def wheel(wheels):
    """The wheel of the packages."""
    return wheels[0]


def interpreter(version):
    """A Python of this version, which may be one that pyenv keeps; the test is skipped where there is none."""
    kept = sorted((Path.home() / ".pyenv/versions").glob(f"{version}.*/bin/python"))
    found = str(kept[-1]) if kept else shutil.which(f"python{version}")
    if found is None or subprocess.run([found, "--version"], capture_output=True, check=False).returncode:
        pytest.skip(f"Python {version} is not installed")
    return found


@pytest.mark.slow
def test_the_wheel_has_every_file_of_the_packages_and_nothing_of_the_audit(wheel):
    names = contents(wheel)
    assert names == {name for name in sources() if not name.startswith(AUDIT)}
    assert [name for name in names if "test" in Path(name).stem.split("_") or name.endswith(".parquet")] == []
    assert wheel.stat().st_size < LARGEST["packages"]


@pytest.mark.slow
def test_the_audit_is_a_wheel_of_its_own(wheels):
    tables = wheels[1]
    ours = {name.replace(TABLES, "dincl_testbed_data") for name in sources() if name.startswith(AUDIT)}
    pages = [
        *ROOT.glob("*.md"),
        *ROOT.glob("*.cff"),
        *(path for path in (ROOT / "docs").rglob("*.*") if path.suffix in OF_PAGES),
    ]
    ours |= {f"dincl_testbed_data/{page.relative_to(ROOT)}" for page in pages if "made" not in page.parts}
    assert contents(tables) == ours - {"dincl_testbed_data/pyproject.toml"}
    assert tables.stat().st_size < LARGEST["tables"]
    ours, theirs = (tomllib.loads((ROOT / f).read_text("utf-8"))["project"] for f in FILES)
    assert theirs["name"] == f"{ours['name']}-data"
    for key in ("version", "requires-python", "license", "authors"):
        assert ours[key] == theirs[key]


@pytest.mark.slow
def test_the_source_archive_has_what_builds_the_wheel_and_neither_tests_nor_tables(tree, tmp_path):
    with tarfile.open(build_sdist(tree, tmp_path)) as archive:
        names = {name.partition("/")[2] for name in archive.getnames() if archive.getmember(name).isfile()}
    made = {"PKG-INFO", "setup.cfg"}
    found = {name for name in names if ".egg-info/" not in name}
    assert found == made | set(BESIDE) | {name for name in sources() if not name.startswith(AUDIT)}


def contents(wheel):
    """List the files of a wheel without those that describe it."""
    with zipfile.ZipFile(wheel) as archive:
        return {name for name in archive.namelist() if ".dist-info/" not in name}


def sources():
    """List the files of the packages in the repository."""
    files = {file for name in PACKAGES for file in (ROOT / name).rglob("*") if file.is_file()}
    names = {file.relative_to(ROOT) for file in files}
    return {name.as_posix() for name in names if not LEFTOVERS("", name.parts)}


@pytest.mark.xslow
@pytest.mark.parametrize("version", PYTHONS)
def test_the_core_runs_outside_of_the_tree(version, wheel, folder):
    commands = installed(interpreter(version), "", wheel, folder)
    assert run([commands / "python", "-c", CORE], cwd=folder) == "SUCCESS (1, 10, 2)\n"
    said = subprocess.run([commands / "tissue", "--help"], capture_output=True, text=True, check=False)
    assert (said.returncode, "pip install '.[tissue]'" in said.stderr) == (2, True)


@pytest.mark.xslow
@pytest.mark.parametrize("extra", EXTRAS)
def test_an_extra_alone_does_what_it_is_for(extra, wheel, folder):
    if extra == "views":
        need_rendering()
    commands = installed(sys.executable, extra, wheel, folder)
    (folder / "program.py").write_text(EXTRAS[extra])
    run([commands / "python", "program.py"], cwd=folder)


@pytest.mark.xslow
def test_the_claims_are_decided_from_the_tables(wheels, folder):
    commands = installed(sys.executable, "thesis", wheels[0], folder)
    claims = [commands / "verification", "claims", "--chapter", "2"]
    said = subprocess.run(claims, cwd=folder, capture_output=True, text=True, check=False)
    assert (said.returncode, "needs dincl-testbed-data" in said.stderr) == (2, True)
    pip(commands / "python", "install", "--no-deps", wheels[1])
    assert "0 with another verdict than the recorded one" in run(claims, cwd=folder)
