"""What numbers are made by: the code that a function can reach, the data beside it, the libraries, the settings.

Nothing of it is a list kept by hand: the code is found by following the import statements.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from dincl.provenance.differences import PARTS, changed_modules, differences
from dincl.provenance.settings import definitions, plain_setting, unwrapped
from dincl.provenance.source import digest_of, read_source
from dincl.provenance.walk import Closure, Start, closure

MAKES_NO_NUMBERS = True
LONGEST_SETTING = 1000
ABSENT, UNKNOWN = "not installed", "unknown"

__all__ = ["Closure", "changed_modules", "closure", "differences", "libraries", "provenance"]


def provenance(function: Start, /, *others: Start, **settings: Any) -> dict[str, str]:
    """What the results of a function, or of a module, depend on; results of equal provenance may be mixed.

    A ``functools.partial`` stands for its function, a callable dataclass for its class: the arguments of the one and
    the fields of the other are settings, unless settings are given.

    Parameters
    ----------
    function, others
        What makes the numbers; several if one finds others at run time.
    settings
        Numbers, texts, arrays, dataclasses, functions and containers of those.

    Returns
    -------
    dict[str, str]
        JSON of four mappings. "code": module -> digest of its text without docstrings and lines of comment, for all of
        ``closure``. "data": the same of the TOML files in the packages of these. "libraries": library -> version of
        those that they import, without Python. "settings": as given.

    Raises
    ------
    InvalidProblem
        If a function is not defined in a file, or a setting is nothing of the above.
    """
    plain, bound = zip(*map(unwrapped, (function, *others)), strict=True)
    used = settings or bound[0]
    reached = closure(*plain, *definitions([bound, settings]))
    parts: tuple[Mapping[str, Any], ...] = (
        {name: read_source(path).digest for name, path in reached.modules.items()},
        {name: digest_of(path.read_bytes()) for name, path in _data(reached.modules)},
        libraries(reached),
        {name: _short(plain_setting(name, value)) for name, value in used.items()},
    )
    return {name: json.dumps(part, sort_keys=True) for name, part in zip(PARTS, parts, strict=True)}


def _short(setting: Any) -> Any:
    """A setting, or a digest of a long one."""
    text = json.dumps(setting, sort_keys=True)
    return setting if len(text) <= LONGEST_SETTING else f"{text[:20]}... ({digest_of(text.encode())})"


def libraries(reached: Closure) -> dict[str, str]:
    """The versions of the libraries that a closure imports."""
    return {name: _version(name) for name in sorted(reached.libraries)}


def _data(modules: Mapping[str, Path]) -> Iterator[tuple[str, Path]]:
    """The TOML files of the packages: beside their modules, and in folders that are no packages themselves."""
    packages = {name: path.parent for name, path in modules.items() if path.stem == "__init__"}
    for name, folder in packages.items():
        inner = [path for path in folder.glob("*/") if path.is_dir() and not (path / "__init__.py").exists()]
        for place in (folder, *sorted(inner)):
            for path in sorted(place.glob("*.toml")):
                yield f"{name}/{path.relative_to(folder).as_posix()}", path


@cache
def _version(library: str) -> str:
    """The version of the distribution that an import name belongs to."""
    try:
        return version(library)
    except PackageNotFoundError:
        names = _distributions().get(library, [])
    if names:
        return ", ".join(version(name) for name in sorted(set(names)))
    return UNKNOWN if find_spec(library) is not None else ABSENT


@cache
def _distributions() -> Mapping[str, list[str]]:
    return packages_distributions()
