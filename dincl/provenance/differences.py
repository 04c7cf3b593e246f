"""What differs between two provenances."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

MAKES_NO_NUMBERS = True
CODE, DATA, LIBRARIES, SETTINGS = PARTS = ("code", "data", "libraries", "settings")
WORDS = {CODE: "module {}", DATA: "file {}", LIBRARIES: "{}", SETTINGS: "setting {}"}


def differences(old: Mapping[str, str], new: Mapping[str, str]) -> list[str]:
    """A line for each module, data file, library and setting in which two provenances differ."""
    if not all(part in old for part in PARTS):
        return ["nothing is noted of what it was made by"]
    lines: list[str] = []
    for part, words in WORDS.items():
        before, after = json.loads(old[part]), json.loads(new[part])
        values = part in (LIBRARIES, SETTINGS)
        names = (name for name in sorted({*before, *after}) if before.get(name) != after.get(name))
        lines += [words.format(name) + _change(name, before, after, values=values) for name in names]
    return lines


def changed_modules(old: Mapping[str, str], new: Mapping[str, str]) -> list[str]:
    """The modules that are in one of two provenances only, or whose code differs."""
    before, after = json.loads(old[CODE]), json.loads(new[CODE])
    return sorted(name for name in {*before, *after} if before.get(name) != after.get(name))


def _change(name: str, before: Mapping[str, Any], after: Mapping[str, Any], *, values: bool) -> str:
    if name not in before or name not in after:
        return " is new" if name in after else " is there no more"
    return f": {before[name]} -> {after[name]}" if values else " has changed"
