"""Prose from templates: HTML with Jinja blocks, one file for a section, filled with numbers computed in Python."""

from __future__ import annotations

from decimal import ROUND_CEILING, Decimal
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from verification.site.parts import number, number_up
from verification.site.render import counted


def fill(template: Path, **values: Any) -> dict[str, str]:
    """Return the blocks of a template by name, with the values filled in and white space made single blanks.

    Filters: ``counted`` (a number with its noun), ``number`` (three digits) and ``percent`` (of a part), which are
    ``number_up`` and ``percent_up`` after "at most", ``percents`` (of a part and its interval), ``interval`` (two
    numbers), ``duration`` (of seconds), ``listed`` (a sequence).

    Raises
    ------
    jinja2.UndefinedError
        If a block uses a value that is not given.
    """
    made = _environment(template.parent).get_template(template.name)
    context = made.new_context(values)
    return {name: " ".join("".join(block(context)).split()) for name, block in made.blocks.items()}


@cache
def _environment(folder: Path) -> Environment:
    # Values go in as they are: templates are HTML for paragraphs, plain text for captions, which the page escapes.
    made = Environment(loader=FileSystemLoader(folder), undefined=StrictUndefined, autoescape=False)
    filters = (counted, number, number_up, percent, percent_up, percents, interval, duration, listed)
    made.filters |= {one.__name__: one for one in filters}
    return made


def percent(part: float, digits: int = 0) -> str:
    """Format 0.25 as ``25 %``."""
    return f"{100 * part:.{digits}f} %"


def percent_up(part: float, digits: int = 0) -> str:
    """Format a part that follows "at most": as ``percent`` does, but rounded up."""
    return f"{(100 * Decimal(repr(float(part)))).quantize(Decimal(1).scaleb(-digits), ROUND_CEILING)} %"


def percents(parts: tuple[float, float, float], digits: int = 0, sign: str = "") -> str:
    """Format a share with its interval as ``25 % [20, 30]``; the sign "+" marks shares above 0."""
    part, low, high = (f"{100 * one:{sign}z.{digits}f}" for one in parts)
    return f"{part} % [{low}, {high}]"


def interval(ends: tuple[float, float]) -> str:
    """Format two numbers as ``[0.96, 1.01]``."""
    low, high = ends
    return f"[{number(low)}, {number(high)}]"


def duration(seconds: float) -> str:
    """Format seconds with two digits, in s, ms or µs: ``3.4 ms``."""
    unit, factor = next((one for one in (("s", 1.0), ("ms", 1e3)) if seconds * one[1] >= 0.1), ("µs", 1e6))
    return f"{float(f'{seconds * factor:.2g}'):g} {unit}"


def listed(values: Any) -> str:
    """Join the values with commas; "none" if there are none."""
    return ", ".join(map(str, values)) or "none"
