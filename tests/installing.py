"""Environments made from a wheel: what pip installs for an extra, and what a stranger runs there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("dincl", "meanfield", "tissue", "verification")
TABLES = "verification/data"
# A distribution of its own: rooms of verification, and the tables of complete studies.
AUDIT = ("verification/thesis", "verification/methods", "verification/tissues", TABLES)
BESIDE = ("pyproject.toml", "MANIFEST.in", "README.md", "CHANGELOG.md", "CITATION.cff", "SOURCE.md", "LICENSE")
LEFTOVERS = shutil.ignore_patterns("__pycache__", "build", "*.egg-info")
SDIST = "import sys; from setuptools import build_meta; build_meta.build_sdist(sys.argv[1])"


def copy_sources(tree: Path) -> Path:
    """Copy what the distributions are built from, as "make dist" does; that of the audit is in the folder "audit"."""
    tree.mkdir(exist_ok=True)
    for name in PACKAGES:
        shutil.copytree(ROOT / name, tree / name, ignore=LEFTOVERS)
    for name in BESIDE:
        shutil.copy(ROOT / name, tree)
    for name in AUDIT:
        place = tree / "audit" / ("dincl_testbed_data" if name == TABLES else name)
        place.parent.mkdir(parents=True, exist_ok=True)
        (tree / name).rename(place)
    (tree / "audit/dincl_testbed_data/pyproject.toml").rename(tree / "audit/pyproject.toml")
    pages = tree / "audit/dincl_testbed_data"
    shutil.copytree(ROOT / "docs", pages / "docs", ignore=shutil.ignore_patterns("made", "__pycache__"))
    for page in (*ROOT.glob("*.md"), *ROOT.glob("*.cff")):
        shutil.copy(page, pages)
    return tree


def build_wheels(tree: Path, out: Path) -> tuple[Path, Path]:
    """Build the wheel of the packages and the wheel of the audit from a copy of the sources."""
    pip(sys.executable, "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", out, tree, tree / "audit")
    tables, packages = sorted(out.glob("*.whl"), key=lambda wheel: "data" not in wheel.name)
    return packages, tables


def build_sdist(tree: Path, out: Path) -> Path:
    """Build the source archive of the packages from a copy of the sources."""
    run([sys.executable, "-c", SDIST, out], cwd=tree)
    (made,) = out.glob("*.tar.gz")
    return made


def pip(python: str | Path, *arguments: object) -> None:
    """Run pip in the repository."""
    run([python, "-m", "pip", "--disable-pip-version-check", "--quiet", *arguments], cwd=ROOT)


def run(command: list[object], cwd: Path) -> str:
    """Run a command as a stranger would, away from this tree; return what it prints."""
    env = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "NUMBA_CACHE_DIR")}
    done = subprocess.run(
        [str(word) for word in command], cwd=cwd, env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def installed(python: str, extra: str, wheel: Path, folder: Path, *others: Path) -> Path:
    """Make an environment with the wheel, an extra ("": none) and other wheels; return the folder of its commands."""
    run([python, "-m", "venv", folder / "venv"], cwd=folder)
    what = f"dincl-testbed[{extra}] @ {wheel.as_uri()}" if extra else f"dincl-testbed @ {wheel.as_uri()}"
    pip(folder / "venv/bin/python", "install", "--constraint", ROOT / "requirements.lock", what, *others)
    return folder / "venv/bin"
