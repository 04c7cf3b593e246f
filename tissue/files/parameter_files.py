"""Parameter files: TOML text from disk, and back."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from dincl.checks import describe
from dincl.errors import InvalidProblem

FOLDER = Path(__file__).parent / "presets"
PRESETS = ("thesis", "corrected", "published", "chick", "gastrulation", "cuboidal", "sheet")
BASES = ", ".join(f'"{name}"' for name in PRESETS[:-1]) + f' or "{PRESETS[-1]}"'
# What stands for the name of a type of cells in the names of its keys.
TYPE = "NAME"


def general(key: str) -> str:
    """Return the name under which a key is known: "types.NAME.cells" for "types.soft.cells"."""
    section, *rest = key.split(".")
    return ".".join((section, TYPE, *rest[1:])) if section == "types" and rest else key


def read(path: str | PathLike[str]) -> dict[str, Any]:
    """Read the tables of a TOML file.

    Raises
    ------
    InvalidProblem
        If it cannot be read, with the reason: for an error of syntax its line.
    """
    try:
        return tomllib.loads(Path(path).read_text("utf-8-sig"))  # some editors write a byte order mark
    except (OSError, ValueError, RecursionError) as error:
        raise InvalidProblem(f"{path}: must be a readable TOML file: {error}") from error


def merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Replace the values of a base by those of changes; tables are merged, other values replaced as a whole."""
    result = dict(base)
    for name, change in changes.items():
        ours = result.get(name)
        result[name] = merged(ours, change) if isinstance(ours, Mapping) and isinstance(change, Mapping) else change
    return result


def flat(tables: Mapping[str, Any], section: str = "") -> dict[str, Any]:
    """Return values by keys such as "emt.cells" or "types.soft.cells", as ``Parameters.changed`` takes them."""
    values: dict[str, Any] = {}
    for name, value in tables.items():
        values |= flat(value, f"{section}{name}.") if isinstance(value, Mapping) else {f"{section}{name}": value}
    return values


def nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of a file that have these values by their keys; raises InvalidProblem for what is no key."""
    tables: dict[str, Any] = {}
    for key, value in values.items():
        *sections, name = key.split(".") if isinstance(key, str) else [key]
        table = tables
        for section in sections:
            table = table.setdefault(section, {})
            if not isinstance(table, dict):
                raise InvalidProblem(f"{key} = {describe(value)}: must not be given beside a value of {section}")
        if not isinstance(key, str) or name in table:
            raise InvalidProblem(f"{describe(key)} = {describe(value)}: must have a key such as numerics.mu, once")
        table[name] = dict(value) if isinstance(value, Mapping) else value
    return tables


def written(tables: Mapping[str, Mapping[str, Any]], comments: Mapping[str, str]) -> str:
    """Write tables of texts, numbers, flags and lists as TOML, which writes these as JSON does.

    ``comments``: what stands behind a value, by keys such as "tissue.cells".
    """

    def line(section: str, name: str, value: Any) -> str:
        comment = comments.get(general(f"{section}.{name}"))
        return f"{name} = {json.dumps(value)}" + (f"  # {comment}\n" if comment else "\n")

    return "\n".join(
        f"[{section}]\n" + "".join(line(section, name, value) for name, value in table.items())
        for section, table in _leaves(tables)
    )


def _leaves(tables: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Give the tables that have values, under their whole names."""
    for name, table in tables.items():
        inside = {key: value for key, value in table.items() if isinstance(value, Mapping)}
        if len(inside) < len(table) or not table:
            yield f"{above}{name}", {key: value for key, value in table.items() if key not in inside}
        yield from _leaves(inside, f"{above}{name}.")
