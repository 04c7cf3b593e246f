"""The command ``tissue parameters``."""

from __future__ import annotations

from inspect import getdoc
from typing import TYPE_CHECKING, Annotated

import typer

from dincl.errors import InvalidProblem
from tissue.cli.messages import messages, table

if TYPE_CHECKING:
    from tissue.files.keys import KeyFacts

SECTIONS = "own, tissue, cell, numerics, rules, division, start, emt, events, forces, daha, layer, space, types"
Name = Annotated[
    str | None, typer.Argument(metavar="KEY", help=f"A key such as numerics.mu, or a section: {SECTIONS}.")
]


def list_parameters(name: Name = None) -> None:
    """List the keys of parameter files: meaning, unit, values of the presets; or tell all of a key, or of a section.

    A value is that of all presets, or of those in brackets.
    """
    from tissue.files.keys import all_keys, heading, no_key, sections
    from tissue.files.parameter_files import general
    from tissue.files.parameters import Parameters
    from tissue.files.reference import presets, spread

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
