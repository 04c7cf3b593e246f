"""Setting of a visitor: parameters to begin with and changes, as texts of fields; and their faults."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from dincl.errors import InvalidProblem
from tissue.files.parameter_files import flat
from tissue.files.parameters import preset
from verification.explore.knobs import CLOSED

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters


@dataclass(frozen=True)
class Setting:
    """Parameters that are valid: those of a preset or a file, ``base`` by its name, with some values changed."""

    base: str
    first: Parameters
    changes: Mapping[str, Any] = field(default_factory=dict)  # values as in a file, by key
    parameters: Parameters = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "parameters", self.first.changed(self.changes))
        before, now = flat(self.first.as_dict()), flat(self.parameters.as_dict())
        kept = {key: now[key] for key in self.changes if now[key] != before.get(key)}
        object.__setattr__(self, "changes", kept)

    @classmethod
    def of(cls, parameters: Parameters) -> Setting:
        """Make a setting of any parameters, as changes of the preset "thesis"."""
        return cls("thesis", preset("thesis"), flat(parameters.as_dict()))

    def with_values(self, values: Mapping[str, Any]) -> Setting:
        """Set some values; values that are as in the base are no changes.

        Raises
        ------
        InvalidProblem
            As ``Parameters.changed``, and for ``CLOSED``.
        """
        if CLOSED in values:
            raise InvalidProblem(f"{CLOSED} cannot be changed here: files of Python are named in a parameter file")
        return Setting(self.base, self.first, {**self.changes, **values})

    def values(self) -> dict[str, Any]:
        """Return all values as in a file, by key."""
        return flat(self.parameters.as_dict())


def value_of(text: str) -> Any:
    """Return the value that the text of a field stands for: as TOML has it, quotes may be left out."""
    try:
        table = tomllib.loads(f"value = {text}")
        return table["value"] if len(table) == 1 else text
    except tomllib.TOMLDecodeError:
        return text.strip()


def text_of(value: Any) -> str:
    """Return the text of a field that stands for a value."""
    return value if isinstance(value, str) else json.dumps(value)


def faults_of(error: InvalidProblem, changed: list[str]) -> tuple[dict[str, str], list[str]]:
    """Split an error by the keys that were changed; what names none of them comes last.

    A line that begins with no such key but names one, as of two values that do not go together, stands at that key.
    """
    first, *lines = str(error).split("\n  ")
    at: dict[str, str] = {}
    others = []
    for line in lines or [first.partition(": ")[2]]:
        key, _, said = line.partition(" = ")
        keys = [key] if key in changed else [key for key in changed if _is_named(key, line)]
        at |= {key: said.partition(": ")[2] if line.startswith(f"{key} = ") else line for key in keys}
        others += [] if keys else [line]
    return at, others


def _is_named(key: str, line: str) -> bool:
    """Return whether a line names a key; without its section, if that is the section of the key it begins with."""
    section, _, name = key.rpartition(".")
    names = [key, name] if line.startswith(f"{section}.") else [key]
    return any(re.search(rf"\b{re.escape(one)}\b", line) for one in names)
