"""Parameter files: TOML text from disk, and back."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from dincl.errors import InvalidProblem

FOLDER = Path(__file__).parent / "presets"


def read(path: str | PathLike[str]) -> dict[str, Any]:
    """The tables of a TOML file.

    Raises
    ------
    InvalidProblem
        If it cannot be read, with the reason: for an error of syntax its line.
    """
    try:
        return tomllib.loads(Path(path).read_text("utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InvalidProblem(f"{path}: must be a readable TOML file: {error}") from error


def merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a base with the keys of the changes in place of its own; what is no table replaces as a whole."""
    result = dict(base)
    for name, change in changes.items():
        ours = result.get(name)
        result[name] = {**ours, **change} if isinstance(ours, Mapping) and isinstance(change, Mapping) else change
    return result


def written(tables: Mapping[str, Mapping[str, Any]], comments: Mapping[str, str]) -> str:
    """TOML text of tables of texts, numbers, flags and lists: TOML writes these as JSON does.

    ``comments``: what stands behind a value, by keys such as "tissue.cells".
    """

    def line(section: str, name: str, value: Any) -> str:
        comment = comments.get(f"{section}.{name}")
        return f"{name} = {json.dumps(value)}" + (f"  # {comment}\n" if comment else "\n")

    return "\n".join(
        f"[{section}]\n" + "".join(line(section, name, value) for name, value in table.items())
        for section, table in tables.items()
    )
