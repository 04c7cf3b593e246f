"""Folders that hold kernels: a digest of their code is the key of cached machine code.

The digest leaves out docstrings and comments, so that a new docstring compiles nothing. A kernel of dincl depends on
the folders in dincl, a kernel of another package on the folders of its package, too. A function in any other file, of a
user or of a test, depends on all folders and on the files outside of the packages that its file imports, directly or
through others.
"""

from __future__ import annotations

import json
import platform
import time
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from dincl.provenance.code import PACKAGES, closure, digest_of, read_source

MAKES_NO_NUMBERS = True
# Modules with kernels, and packages, which stand for all that is beneath them. Kernels take no numbers from elsewhere:
# tests/dincl/compiled/test_kernel_imports.py follows their imports.
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
    *(
        f"dincl.steps.{name}"
        for name in ("adaptive", "catch_up", "compliant", "loop", "programs", "sweeping", "sweeps")
    ),
    "dincl.system.arrays",
    "meanfield.solvers.grid.finite_volume",
    "tissue.events",
    "tissue.frames.observables",
    "tissue.pictures.scaled",
    "tissue.kernels",
    "tissue.model",
    "tissue.network",
    "tissue.plugins",
    "tissue.quasi_steady",
    "tissue.rules",
    "tissue.runs.compiled_rules",
    "tissue.runs.force_error",
    "tissue.state",
    "tissue.step",
)
LIBRARIES = ("numba", "llvmlite", "numpy")
# How ``dincl.compiled.cache`` writes its files: programs that write them in another way have folders of their own.
FILES = "files 2"
_ROOT = Path(__file__).parents[2]
# When this process began to load modules with compiled functions [s].
LOADED = time.time()


def require_folder(function: Callable[..., Any]) -> None:
    """Raise RuntimeError for a function of these packages outside of the folders: its cached code could be outdated."""
    name = function.__module__ or ""
    if name.partition(".")[0] in PACKAGES and not holds_kernels(name):
        raise RuntimeError(f"{name} compiles {function.__name__}: add its folder to dincl.compiled.folders.FOLDERS")


def holds_kernels(module: str) -> bool:
    """Return whether a module is in one of the folders."""
    return any(module == folder or module.startswith(f"{folder}.") for folder in FOLDERS)


def stamp(function: Callable[..., Any]) -> str:
    """Compute the digest of the versions and the code that the machine code of a function depends on."""
    module = function.__module__
    if module not in _CODE:
        top = module.partition(".")[0]
        code = [
            digest
            for package in sorted({"dincl", top} if top in PACKAGES else PACKAGES)
            for digest in _folders(package)
        ]
        if top not in PACKAGES:
            imported = closure(function).modules.items()
            code += [
                f"{name} {read_source(path).digest}"
                for name, path in imported
                if name.partition(".")[0] not in PACKAGES
            ]
        _CODE[module] = code
    return digest_of(json.dumps([versions(), *_CODE[module]]).encode())


# The digests of the code by module: all functions of a module depend on the same files.
_CODE: dict[str, list[str]] = {}


@cache
def versions() -> list[str]:
    """List the versions of what makes machine code and its files; numba itself adds the processor."""
    return [platform.python_version(), FILES, *map(version, LIBRARIES)]


@cache
def _folders(package: str) -> list[str]:
    """Compute a digest for each folder of a package; modules with MAKES_NO_NUMBERS do not count.

    A file that was changed after this process began may have been loaded as it was before. The digest is then one of
    this process alone, so that no other one takes its machine code for that of the new file.
    """
    digests = []
    for name in FOLDERS:
        if name.startswith(f"{package}."):
            place = _ROOT.joinpath(*name.split("."))
            files = sorted(place.rglob("*.py")) if place.is_dir() else [place.with_suffix(".py")]
            if any(path.stat().st_mtime > LOADED for path in files):
                digests.append(f"changed while it ran: {LOADED}")
            sources = ((path.relative_to(_ROOT).as_posix(), read_source(path)) for path in files)
            code = [(path, found.digest) for path, found in sources if found.makes_numbers]
            digests.append(digest_of(json.dumps(code).encode()))
    return digests
