"""The folders that hold kernels: a digest of their code is the key of all machine code that is kept.

Code is what is left of a file without docstrings and comments, so that a new docstring compiles nothing. A kernel of
dincl depends on the folders in dincl, one of another package on those in this package, too. A function in any other
file, of a user or of a test, depends on all folders and on the files outside of the packages that its file imports,
directly or through others.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Iterator
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from dincl.provenance.code import PACKAGES, closure, digest_of, read_source

MAKES_NO_NUMBERS = True
# Modules with kernels, and packages, which stand for all that is beneath them. Kernels take no numbers from elsewhere:
# tests/contracts/test_compiled_room.py follows their imports.
FOLDERS = (
    "dincl.compiled",
    "dincl.constants",
    "dincl.drifts.functions",
    *(f"dincl.events.{name}" for name in ("contacts", "event_functions", "integrate", "location")),
    *(f"dincl.events.{name}" for name in ("motion", "runge_kutta", "steps", "workspace")),
    "dincl.matrices.products",
    "dincl.neighbours",
    "dincl.rows.candidates",
    "dincl.rows.formulas",
    "dincl.rows.table",
    "dincl.solvers",
    *(f"dincl.steps.{name}" for name in ("catch_up", "loop", "programs", "sweeping", "sweeps")),
    "dincl.system.arrays",
    "meanfield.solvers.grid.finite_volume",
    "tissue.division",
    "tissue.events",
    "tissue.explore.scaled",
    "tissue.kernels",
    "tissue.model",
    "tissue.quasi_steady",
    "tissue.slopes",
    "tissue.space",
    "tissue.state",
    "tissue.step",
)
LIBRARIES = ("numba", "llvmlite", "numpy")
_ROOT = Path(__file__).parents[2]


def require_folder(function: Callable[..., Any]) -> None:
    """Raise RuntimeError for a function of these packages outside of the folders: its kept code could be outdated."""
    name = function.__module__ or ""
    if name.partition(".")[0] in PACKAGES and not holds_kernels(name):
        raise RuntimeError(f"{name} compiles {function.__name__}: add its folder to dincl.compiled.folders.FOLDERS")


def holds_kernels(module: str) -> bool:
    """Say whether a module is in one of the folders."""
    return any(module == folder or module.startswith(f"{folder}.") for folder in FOLDERS)


def stamp(function: Callable[..., Any]) -> str:
    """Compute the digest of the versions and the code that the machine code of a function depends on."""
    return digest_of(json.dumps([versions(), *_code_of(function.__module__, function)]).encode())


@cache
def versions() -> list[str]:
    """List the versions of Python and of the libraries that make machine code; numba itself adds the processor."""
    return [platform.python_version(), *map(version, LIBRARIES)]


# By module: what a function's file imports is the same for all functions in it.
_CODE: dict[str, list[str]] = {}


def _code_of(module: str, function: Callable[..., Any]) -> list[str]:
    if module not in _CODE:
        top = module.partition(".")[0]
        outside = [] if top in PACKAGES else list(_outside(function))
        packages = ("dincl", top) if top in PACKAGES else PACKAGES
        _CODE[module] = [digest for package in sorted({*packages}) for digest in _folders(package)] + outside
    return _CODE[module]


@cache
def _folders(package: str) -> list[str]:
    """Compute a digest for each folder of a package."""
    return [_folder(name) for name in FOLDERS if name.startswith(f"{package}.")]


def _folder(name: str) -> str:
    """Compute the digest of a folder; modules with MAKES_NO_NUMBERS do not count."""
    place = _ROOT.joinpath(*name.split("."))
    files = sorted(place.rglob("*.py")) if place.is_dir() else [place.with_suffix(".py")]
    sources = ((path.relative_to(_ROOT).as_posix(), read_source(path)) for path in files)
    return digest_of(json.dumps([(path, found.digest) for path, found in sources if found.makes_numbers]).encode())


def _outside(function: Callable[..., Any]) -> Iterator[str]:
    """Name the modules outside of the packages that the file of a function imports, with their digests."""
    for name, path in closure(function).modules.items():
        if name.partition(".")[0] not in PACKAGES:
            yield f"{name} {read_source(path).digest}"
