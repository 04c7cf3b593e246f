"""The command ``tissue parameters``."""

from __future__ import annotations

import json
from inspect import getdoc
from typing import TYPE_CHECKING, Annotated, Any

import typer

from dincl.errors import InvalidProblem
from tissue.cli.messages import messages

if TYPE_CHECKING:
    from tissue.files.keys import KeyFacts

MAKES_NO_NUMBERS = True
# Of a list that goes to a file: no value is broken.
WIDE = 320

SECTIONS = "own, tissue, cell, numerics, rules, division, start, emt, events, forces, daha, layer, space, types"
Name = Annotated[
    str | None, typer.Argument(metavar="KEY", help=f"A key such as numerics.mu, or a section: {SECTIONS}.")
]


def list_parameters(name: Name = None) -> None:
    """List the keys of parameter files: meaning, unit, values of the presets; or tell all of a key, or of a section.

    A value is that of all presets, or of those in brackets.
    """
    from tissue.files.keys import all_keys, heading, sections
    from tissue.files.messages import no_key
    from tissue.files.parameter_files import general
    from tissue.files.parameters import Parameters
    from tissue.files.reference import presets

    keys, found = all_keys(Parameters), sections(Parameters)
    name = name if name is None else general(name)
    with messages():
        if name is not None and name not in keys and name not in found:
            raise InvalidProblem(f"{name}: {no_key(name, [*found, *keys])}")
        values = presets()
    if name is not None:
        if name in found:
            print(f"{getdoc(found[name])}\n")
        print("\n\n".join(_told(facts, values) for facts in keys.values() if name in (facts.name, facts.section)))
        return
    for section, fields in found.items():
        print(f"[{section}] {heading(fields)}")
        mine = [facts for facts in keys.values() if facts.section == section]
        _list(mine, values) if mine else print()


def _list(keys: list[KeyFacts], presets: dict[str, dict[str, Any]]) -> None:
    """Print a table of some keys."""
    from rich.console import Console
    from rich.table import Table

    from tissue.files.reference import spread

    table = Table("key", "meaning", "unit", "value", box=None, pad_edge=False)
    for facts in keys:
        table.add_row(facts.name, facts.meaning, facts.unit, spread(facts, presets))
    width = None if Console().is_terminal else WIDE
    Console(width=width, markup=False, highlight=False, emoji=False).print(table, "")


def _told(facts: KeyFacts, presets: dict[str, dict[str, Any]]) -> str:
    """Return all of one key, a line each."""
    lines = {
        "meaning": facts.meaning,
        "symbol": facts.symbol,
        "source": facts.source,
        "allowed": facts.allowed,
        "default": json.dumps(facts.default) if facts.has_default else "none: a file without base has to give it",
    }
    theirs = {
        name: json.dumps(values.get(facts.name, facts.default))
        for name, values in presets.items()
        if facts.has_default or facts.name in values
    }
    if set(theirs.values()) != {lines["default"]}:  # else the default says it
        lines |= theirs
    width = max(map(len, lines))
    return "\n".join([facts.name, *(f"  {what:{width}}  {text}" for what, text in lines.items() if text)])
