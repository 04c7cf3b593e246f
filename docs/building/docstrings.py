"""Docstrings for autodoc: their formulas are plain text, their sections those of numpydoc."""

from __future__ import annotations

import re
from collections.abc import Iterable

# The title of a section stands over a line of dashes.
DASHES = re.compile(r"-{3,}")
LITERAL = re.compile(r"(``.+?``)")
# What numpy's names for types stand for, and the names.
TYPES = {
    r"~?numpy\.ndarray\[tuple\[~?typing.Any, \.\.\.\], ~?numpy\.dtype\[~?numpy\.(\w+)\]\]": r"NDArray[\1]",
    r"NDArray\[np\.(\w+)\]": r"NDArray[\1]",
    r"_Buffer \| .*?_NestedSequence\[complex \| bytes \| str\]": "ArrayLike",
}


def as_rst(app: object, what: str, name: str, item: object, options: object, lines: list[str]) -> None:
    """Make reStructuredText of a docstring in place; an event of autodoc.

    Indented lines below a blank one are formulas and stay as they are. Elsewhere nothing but what is between two
    backticks is markup. Text below the sections, such as the source, is put above them: a section would take it for an
    entry.
    """
    prose, sections = _parted(lines)
    lines[:] = _written([*prose, *sections])


def hides(app: object, what: str, name: str, item: object, skip: bool, options: object) -> bool | None:
    """Whether a member is left out: the fields of named tuples, which describe themselves as numbers of fields."""
    return True if type(item).__name__ == "_tuplegetter" else None


def signature(
    app: object, what: str, name: str, item: object, options: object, arguments: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """A signature with the names of types that its source has."""
    for long, short in TYPES.items():
        arguments = arguments and re.sub(long, short, arguments)
        returned = returned and re.sub(long, short, returned)
    return arguments, returned


def _parted(lines: list[str]) -> tuple[list[str], list[str]]:
    """What is said, and the sections, each with its blank lines."""
    prose: list[str] = []
    sections: list[str] = []
    inside = False
    for paragraph in _paragraphs(lines):
        heads = len(paragraph) > 1 and DASHES.fullmatch(paragraph[1].strip())
        entry = paragraph[0].startswith(" ") or any(line.startswith(" ") for line in paragraph)
        inside = bool(heads) or (inside and entry)
        (sections if inside else prose).extend([*paragraph, ""])
    return prose, sections


def _paragraphs(lines: Iterable[str]) -> list[list[str]]:
    found: list[list[str]] = [[]]
    for line in lines:
        if line.strip():
            found[-1].append(line)
        elif found[-1]:
            found.append([])
    return [paragraph for paragraph in found if paragraph]


def _written(lines: list[str]) -> list[str]:
    text: list[str] = []
    last, formula = " ", False
    for line in lines:
        if line.strip():
            if last.endswith("::") and not line.startswith(
                " "
            ):  # the indentation of all lines but the first was cut off
                line = f"    {line}"  # noqa: PLW2901
            indented = line.startswith("   ")
            begins = indented and not text[-1].strip() and not last.startswith(" ")
            if begins and not last.endswith("::"):
                text += ["::", ""]
            formula = indented and (formula or begins)
            last = line
        text.append(line if formula else _escaped(line))
    return text


def _escaped(line: str) -> str:
    parts = LITERAL.split(line)
    parts[::2] = [re.sub(r"([\\*|`]|_(?!\w))", r"\\\1", part) for part in parts[::2]]
    return "".join(parts)
