"""The lock file fits pyproject.toml and what is installed; each target installs its extra."""

import os
import re
import subprocess
import tomllib
from importlib.metadata import distributions
from pathlib import Path
from shutil import copy

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests import link_copies

ROOT = Path(__file__).parents[2]
SETUP_FILES = ("Makefile", "pyproject.toml", "requirements.lock")
# Each target: the extra it installs, and what it runs then.
COMMANDS = {
    "report": ("thesis", ".venv/bin/verification report"),
    "test": ("test", ".venv/bin/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder -q"),
    "numba-range": ("test", ".venv/bin/python -m tests.numba_range"),
    "lint": ("lint", ".venv/bin/mypy"),
    "docs": ("docs", ".venv/bin/python -m sphinx -q -W -c docs -d build/doctrees . site"),
    "bench": ("thesis", ".venv/bin/python -m verification.thesis.bench"),
    "everything": ("dev", ""),
    "dist": ("dist", ".venv/bin/python -m twine check --strict dist/*"),
}
INSTALL = ".venv/bin/python -m pip --disable-pip-version-check install --quiet"
ADD = f"{INSTALL} --no-compile --no-build-isolation --constraint requirements.lock --editable"
FAILS = "#!/bin/sh\nexit 1\n"


def locked() -> list[Requirement]:
    """Read the lines of the lock file."""
    lines = (line.partition("#")[0].strip() for line in (ROOT / "requirements.lock").read_text("utf-8").splitlines())
    return [Requirement(line) for line in lines if line]


def wanted() -> set[str]:
    """Name the dependencies in pyproject.toml, those of all extras too."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    names = [*project["dependencies"], *(name for extra in project["optional-dependencies"].values() for name in extra)]
    return {canonicalize_name(Requirement(name).name) for name in names} - {project["name"]}


def make(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run make in a folder, free of what an outer make hands down."""
    outer = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "MAKEOVERRIDES", "ARGS", "FULL", "PYTHON")
    env = {key: value for key, value in os.environ.items() if key not in outer}
    return subprocess.run(["make", *arguments], cwd=folder, env=env, capture_output=True, text=True, check=False)


def script(path: Path, text: str) -> Path:
    """Write an executable file."""
    path.write_text(text, "utf-8")
    path.chmod(0o755)
    return path


@pytest.fixture
def fresh(tmp_path: Path) -> Path:
    """Make a folder with the files an installation needs, and no environment."""
    for name in SETUP_FILES:
        copy(ROOT / name, tmp_path)
    return tmp_path


def test_lock_lists_every_dependency() -> None:
    assert wanted() <= {canonicalize_name(requirement.name) for requirement in locked()}


def test_lock_gives_exact_versions_and_no_address() -> None:
    for requirement in locked():
        assert requirement.url is None
        assert [clause.operator for clause in requirement.specifier] == ["=="], requirement
        assert "*" not in str(requirement.specifier)
    assert "://" not in (ROOT / "requirements.lock").read_text("utf-8")


def test_installed_versions_are_the_locked_ones() -> None:
    """Not all that is locked need be installed: each target adds its own."""
    here = {canonicalize_name(found.name): found.version for found in distributions()}
    there = {canonicalize_name(one.name): next(iter(one.specifier)).version for one in locked()}
    assert {"numpy", "pandas", "pytest"} <= here.keys() & there.keys()
    assert {name: here[name] for name in here.keys() & there.keys()} == {
        name: there[name] for name in here.keys() & there.keys()
    }


@pytest.mark.parametrize("target", COMMANDS)
def test_target_installs_its_extra_alone_then_runs(target: str, fresh: Path) -> None:
    extra, command = COMMANDS[target]
    run = make(fresh, "-n", target)
    assert run.returncode == 0, run.stderr
    assert re.findall(rf"^{re.escape(ADD)} '\.\[(\w+)\]'$", run.stdout, re.MULTILINE) == [extra]
    first = run.stdout.index(f"{INSTALL} --constraint requirements.lock setuptools")
    assert first < run.stdout.index(ADD) < run.stdout.rindex(command)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (FAILS, "Python >= 3.11 is needed"),
        ('#!/bin/sh\ncase "$*" in *ensurepip*) exit 1 ;; esac\n', "comes without venv"),
    ],
)
def test_unfit_python_is_refused_in_words(text: str, message: str, fresh: Path) -> None:
    run = make(fresh, "test", f"PYTHON={script(fresh / 'python', text)}")
    assert run.returncode != 0
    assert message in run.stderr
    assert not (fresh / ".venv").exists()


def test_copies_get_one_place_and_keep_their_names(tmp_path: Path) -> None:
    large, other = b"a" * link_copies.SMALLEST, b"b" * link_copies.SMALLEST
    for name, content in {"one": large, "in/two": large, "three": other, "four": b"c", "five": b"c"}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(content)
    link_copies.link(tmp_path)
    places = {name: (tmp_path / name).stat().st_ino for name in ("one", "in/two", "three", "four", "five")}
    assert places["one"] == places["in/two"]
    assert len(set(places.values())) == 4
    assert [(tmp_path / name).read_bytes() for name in ("in/two", "three")] == [large, other]
    assert not list(link_copies.copies(tmp_path))
