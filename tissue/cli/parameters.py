"""The command ``tissue parameters``."""

from __future__ import annotations

import json
from collections.abc import Mapping
from inspect import getdoc
from typing import TYPE_CHECKING, Annotated, Any

import typer

from dincl.errors import InvalidProblem
from tissue.cli.messages import messages, table
from tissue.files.parameter_files import FOLDER, PRESETS, flat, general, merged, read

if TYPE_CHECKING:
    from tissue.files.keys import KeyFacts

SECTIONS = "own, tissue, cell, numerics, rules, division, start, emt, events, forces, layer, space, types"
Name = Annotated[
    str | None, typer.Argument(metavar="KEY", help=f"A key such as numerics.mu, or a section: {SECTIONS}.")
]


def list_parameters(name: Name = None) -> None:
    """List the keys of parameter files: meaning, unit, values of the presets; or tell all of a key, or of a section.

    A value is that of all presets, or of those in brackets.
    """
    from tissue.files.keys import all_keys, heading, no_key, sections
    from tissue.files.parameters import Parameters

    keys, found = all_keys(Parameters), sections(Parameters)
    name = name if name is None else general(name)
    with messages():
        if name is not None and name not in keys and name not in found:
            raise InvalidProblem(f"{name}: {no_key(name, [*found, *keys])}")
        values = presets()
    if name is not None:
        if name in found:
            print(f"{getdoc(found[name])}\n")
        mine = [facts for facts in keys.values() if name in (facts.name, facts.section)]
        print("\n\n".join(_told(facts, spread(facts, values)) for facts in mine))
        return
    for section, fields in found.items():
        mine = [facts for facts in keys.values() if facts.section == section]
        rows = [(facts.name, facts.meaning, facts.unit, spread(facts, values)) for facts in mine]
        title = f"[{section}] {heading(fields)}"
        print(table(title, ("key", "meaning", "unit", "value"), rows) or f"{title}\n")


def _told(facts: KeyFacts, value: str) -> str:
    """Return all of one key, a line each."""
    lines = {
        "meaning": facts.meaning,
        "symbol": facts.symbol,
        "source": facts.source,
        "allowed": facts.allowed,
        "value": value if facts.has_default else f"{value}; a file without base has to give it",
    }
    return "\n".join([facts.name, *(f"  {what:7}  {text}" for what, text in lines.items() if text)])


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


def _tables(name: str) -> dict[str, Any]:
    tables = read(FOLDER / f"{name}.toml")
    base = tables.pop("base", None)
    return tables if base is None else merged(_tables(base), tables)
