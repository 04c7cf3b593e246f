"""The modules of users, which parameters list by their files: they register what is not in this package."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

from dincl.errors import InvalidProblem

MODULES = 'a list of files of Python, such as ["my_module.py"]'


def read_modules(raw: Any) -> tuple[str, ...]:
    """Import files of Python: the other values may name what they register; raises ValueError for none."""
    if not isinstance(raw, (list, tuple)) or not all(isinstance(file, str) for file in raw):
        raise ValueError
    files = [Path(file).resolve() for file in raw]
    for file in files:
        imported(file)
    return tuple(map(str, files))


def not_imported(values: Mapping[str, Any]) -> list[str]:
    """Return the files of Python that values by their keys name, and that ``Parameters.changed`` of these would run."""
    files = values.get("own.modules")
    names = [file for file in files if isinstance(file, str)] if isinstance(files, (list, tuple)) else []
    return [file for file in names if not _is_imported(Path(file).resolve())]


def placed(tables: Mapping[str, Any], folder: Path, before: Sequence[str] = ()) -> dict[str, Any]:
    """Return the tables of a file, its ``own.modules`` relative to its folder and behind those of its base."""
    own = tables.get("own")
    if not isinstance(own, Mapping):
        return dict(tables)
    given = own.get("modules")
    if not isinstance(given, (list, tuple)) or not all(isinstance(file, str) for file in given):
        return dict(tables)  # refused where they are imported
    files = [str((folder / file).resolve()) for file in given]
    return {**tables, "own": {**own, "modules": list(dict.fromkeys([*before, *files]))}}


def imported(file: Path) -> None:
    """Import a module of users from its file, once in a process.

    Raises
    ------
    InvalidProblem
        If there is no such file, it cannot be imported, or its name is that of another module.
    """
    if _is_imported(file):
        return
    spec = find_spec(file.stem)
    if file.stem in sys.modules or (spec is not None and _place(spec.origin) != file):
        raise InvalidProblem(f"{file}: must have another name, there is a module {file.stem} already")
    spec = spec_from_file_location(file.stem, file)
    if not file.is_file() or spec is None or spec.loader is None:
        raise InvalidProblem(f"{file}: must be a file of Python, my_module.py")
    module, is_whole = module_from_spec(spec), False
    sys.modules[file.stem] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise InvalidProblem(f"{file}: cannot be imported: {type(error).__name__}: {error}") from error
    else:
        is_whole = True
    finally:
        if not is_whole:  # also after Ctrl-C: what ran half is no module
            del sys.modules[file.stem]


def _is_imported(file: Path) -> bool:
    known = (sys.modules.get(file.stem), sys.modules["__main__"])
    return any(one is not None and _place(getattr(one, "__file__", None)) == file for one in known)


def _place(name: str | None) -> Path | None:
    return None if name is None else Path(name).resolve()
