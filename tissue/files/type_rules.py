"""Which values of named types of cells go together, with each other and with those of all cells."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from tissue.events.known import events
from tissue.files.cell_types import MOST_TYPES, OWN_KEYS, PAIR_KEYS, SCATTERED, UNNAMED, TypeKeys, first_of
from tissue.files.combinations import OF_NEIGHBOURS, RULES, SHORT_FOR_CELLS, UNIT, broken_of, waiting
from tissue.files.rule import show
from tissue.files.space_rules import IN_SPACE
from tissue.files.timing import Timing
from tissue.state.space import FLAT

_NAME = re.compile("[A-Za-z_][A-Za-z0-9_]*")
# Of [cell] alone: they hold for the values of each type, as those of basal neighbours do.
_CELL_RULES = tuple(rule for rule in RULES if all(key.startswith("cell.") or key == UNIT for key in rule.keys))


def wrong_names(types: Any) -> list[str]:
    """Return a line for each name that a type must not have, and one if there are too many types."""
    names = list(types) if isinstance(types, Mapping) else []
    lines = [
        f"types.{name}: must have another name, of letters, digits and _, and neither {' nor '.join(UNNAMED)}"
        for name in names
        if not _may_be(name)
    ]
    many = f"types = {', '.join(names)}: must be {MOST_TYPES} types at most"
    return [*lines, many] if len(names) > MOST_TYPES else lines


def _may_be(name: str) -> bool:
    """Return whether a type may have this name."""
    return _NAME.fullmatch(name) is not None and name not in UNNAMED


def broken_types(values: Mapping[str, Any]) -> list[str]:
    """Return a line for each rule that the types among the values break; ``values`` by keys, such as "types.soft"."""
    types = {name.partition(".")[2]: one for name, one in values.items() if name.startswith("types.")}
    types = {name: one for name, one in types.items() if _may_be(name)}
    lines = [line for name, one in types.items() for line in _own(name, one, values)]
    if {"tissue.cells", "emt.cells"} <= values.keys():
        lines += broken_groups(types, values["tissue.cells"], values["emt.cells"])
    return lines


def broken_groups(types: Mapping[str, TypeKeys], cells: int, emt: int) -> list[str]:
    """Return a line for each group that has no room among so many cells, of which ``emt`` are in the middle."""
    return [*_numbers(types, cells, emt)] or [*_overlaps(types, cells, emt)]


def _own(name: str, one: TypeKeys, values: Mapping[str, Any]) -> list[str]:
    """Apply the rules of [cell] and of events to the values of a type."""
    own = {f"{OWN_KEYS[key]}.{key}": value for key, value in one.own().items()}
    times: dict[str, Any] = {f"emt.{event.name}": Timing() for event in events()}
    times |= {f"emt.{key}": value for key, value in one.times().items()}
    rules = (*_CELL_RULES, *OF_NEIGHBOURS, SHORT_FOR_CELLS)
    unit = {UNIT: values["cell.soft_radius"]} if "cell.soft_radius" in values else {}
    found = broken_of(rules, {**values, **own, **unit}) + broken_of(waiting(), times)
    mine = "|".join(re.escape(key) for key in (*own, *times))
    said = (re.sub(rf"\b({mine})\b", lambda key: f"types.{name}.{key[0].partition('.')[2]}", line) for line in found)
    plain = broken_of(rules, values)
    return [*(line for line in said if line not in plain), *_in_space(name, one, values)]


def _in_space(name: str, one: TypeKeys, values: Mapping[str, Any]) -> Iterator[str]:
    """Refuse numbers of pairs in three dimensions, where all pairs have the same."""
    for key in PAIR_KEYS:
        if key in one.own() and values.get("tissue.dimension", FLAT) != FLAT:
            all_cells = f"{OWN_KEYS[key]}.{key}"
            yield f"types.{name}.{key} = {show(one.own()[key])}: must be left to {all_cells} {IN_SPACE}"


def _numbers(types: Mapping[str, TypeKeys], cells: int, emt: int) -> Iterator[str]:
    """Check that there are cells for all groups, and some left to measure EMT cells by."""
    before, leaving = emt, emt
    for name, one in types.items():
        most, what = cells - before, f"other groups have {before} of {cells} cells"
        if one.has_events and cells - 2 - leaving < most:
            most, what = cells - 2 - leaving, f"two of {cells} cells at least undergo no EMT"
        if one.cells > max(0, most):
            yield f"types.{name}.cells = {one.cells}: must be at most {max(0, most)}: {what}"
        before, leaving = before + one.cells, leaving + one.cells * one.has_events


def _overlaps(types: Mapping[str, TypeKeys], cells: int, emt: int) -> Iterator[str]:
    """Check that groups at a place have no cell in common."""
    first = (cells - emt) // 2
    taken = [("emt", range(first, first + emt))]
    for name, one in types.items():
        if isinstance(one.place, str):
            continue
        begin = first_of(cells, one.cells, one.place)
        mine = range(begin, begin + one.cells)
        for other, theirs in taken:
            if max(mine.start, theirs.start) < min(mine.stop, theirs.stop):
                section = other if other in UNNAMED else f"types.{other}"
                yield (
                    f"types.{name}.place = {show(one.place)}: must be elsewhere, or {show(SCATTERED)}: its cells "
                    f"{_span(mine)} from the left overlap with {_span(theirs)} of [{section}]"
                )
                break
        taken.append((name, mine))


def _span(cells: range) -> str:
    return f"{cells.start + 1} to {cells.stop}" if len(cells) > 1 else f"{cells.start + 1}"
