"""The list of all keys of parameter files, for ``tissue parameters`` and the page docs/reference/parameters.md.

``python -m tissue.files.reference`` writes this page.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dincl.files import write_text
from tissue.files.keys import KeyFacts, all_keys, heading, sections
from tissue.files.parameter_files import FOLDER, PRESETS, flat, merged, read
from tissue.files.parameters import Parameters

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "parameters.md"
COLUMNS = ("key", "meaning", "symbol", "unit, or what is allowed", "value", "source")
TOP = """# The keys of parameter files

`tissue parameters` lists them, too; `tissue parameters numerics.mu` and `tissue parameters emt` say more of a key or a
section. A value is that of all presets, or of those in brackets. A key with a default may be left out in any file.
Each value of a preset cites its source in `tissue/files/presets`. The [source](../../SOURCE.md) of a key is
its place in the thesis, or a row of the table of model variants. `python -m tissue.files.reference` makes this page
from `tissue/files/sections.py`.
"""


def presets() -> dict[str, dict[str, Any]]:
    """Return the values of each preset as its file gives them, by key, without those left to their default."""
    return {preset: flat(_tables(preset)) for preset in PRESETS}


def spread(facts: KeyFacts, values: Mapping[str, Mapping[str, Any]]) -> str:
    """Write the values of a key in the presets: one if all have it, else each with its presets."""
    groups: dict[str, list[str]] = {}
    for preset, theirs in values.items():
        if facts.has_default or facts.name in theirs:  # no preset has a type of cells
            groups.setdefault(json.dumps(theirs.get(facts.name, facts.default)), []).append(preset)
    if len(groups) == 1:
        groups = {value: [] for value in groups}
    if facts.has_default:
        default = json.dumps(facts.default)
        groups[default] = [*groups.get(default, []), "default"]
    return "; ".join(f"{value} ({', '.join(names)})" if names else value for value, names in groups.items())


def page() -> str:
    """Write the page, in Markdown."""
    values, keys, parts = presets(), all_keys(Parameters).values(), [TOP]
    for section, fields in sections(Parameters).items():
        about, rows = heading(fields), [COLUMNS, ("---",) * len(COLUMNS)]
        for facts in keys:
            if facts.section == section:
                symbol = f"`{facts.symbol}`" if facts.symbol else ""
                value = spread(facts, values)
                rows.append((f"`{facts.name}`", facts.meaning, symbol, facts.unit, value, facts.source))
        parts += [f"## [{section}]\n", f"{about[0].upper()}{about[1:]}\n"]
        if len(rows) > 2:
            parts.append("".join(f"| {' | '.join(cells)} |\n" for cells in rows))
    return "\n".join(parts)


def _tables(name: str) -> dict[str, Any]:
    tables = read(FOLDER / f"{name}.toml")
    base = tables.pop("base", None)
    return tables if base is None else merged(_tables(base), tables)


if __name__ == "__main__":
    write_text(PAGE, page())
