"""Parts of pages: numbers, shares and intervals as text, tables, templates of this room, facts of the machine."""
# ruff: noqa: RUF001

from __future__ import annotations

import os
import platform
import re
from collections.abc import Iterable, Iterator
from functools import cache
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from dincl.study.record import libraries
from verification.claims import Verdict

# Numbers smaller than this are written with an exponent.
PLAIN = 1e-2
# Texts of more letters may break into lines.
LONG = 24
VERDICTS = {verdict.value: verdict.name.lower() for verdict in Verdict}
# Scripts: in braces after anything, x^{k+1}; else after a single letter, a number or a bracket, x_k and P_S(x), since
# names of code such as cpu_seconds have none.
BRACED = re.compile(r"([_^])\{([^{}]*)\}")
SCRIPT = re.compile(
    r"((?<![A-Za-z_.])[^\W\d_][\u0300-\u036f′]*|(?<![\w.])\d+|[)\]|‖⟩>½′])"
    r"([_^])(?:\(([^()]*)\)|([^\W_]+(?:-[a-z]+)*|[*+\-−∞½]))"
)
TAGS = {"_": "sub", "^": "sup"}


def grid(table: pd.DataFrame) -> str:
    """Return a table as HTML, without the columns and rows in which nothing stands; a click on a heading sorts it."""
    said = table.notna() & (table != "")
    shown = table.loc[said.any(axis=1), said.any(axis=0)]
    heads = "".join(f"<th>{formula(str(name))}</th>" for name in shown)
    rows = (f"<tr>{''.join(map(_cell, row))}</tr>" for row in shown.itertuples(index=False, name=None))
    return f'<table class="sortable"><thead><tr>{heads}</tr></thead><tbody>{"".join(rows)}</tbody></table>'


def _cell(value: object) -> str:
    text, look = cell(value)
    look = look or ("words" if len(text) > LONG else "")
    return f'<td class="{look}">{formula(text)}</td>' if look else f"<td>{formula(text)}</td>"


def formula(text: str) -> str:
    """Return plain text as HTML, with scripts: ``x_{k+1}`` has a lowered k+1; other signs of formulas are Unicode."""
    html, before = escape(text), ""
    while html != before:
        before, html = html, BRACED.sub(lambda found: _script("", *found.groups()), html)
        html = SCRIPT.sub(lambda found: _script(found[1], found[2], found[3] or found[4]), html)
    return html


def _script(base: str, sign: str, inside: str) -> str:
    return f"{base}<{TAGS[sign]}>{inside}</{TAGS[sign]}>"


def cell(value: object) -> tuple[str, str]:
    """Return the text of a value in a table, and its CSS class."""
    if isinstance(value, bool | np.bool_):
        return ("yes" if value else "no"), ""
    if isinstance(value, float | np.floating):
        return number(float(value)), "number"
    if isinstance(value, int | np.integer):
        return str(value), "number"
    return str(value), VERDICTS.get(str(value), "")


def number(value: float) -> str:
    """Format a number with three digits, with an exponent where it is small or large."""
    if np.isnan(value):
        return "—"
    if np.isinf(value):
        return "∞" if value > 0 else "-∞"
    if value == 0:
        return "0"
    if PLAIN <= abs(value) < 1e4:
        return f"{value:.3g}" if abs(value) < 1e3 else f"{value:.0f}"
    mantissa, exponent = f"{value:.1e}".split("e")
    raised = f"10{str(int(exponent)).translate(str.maketrans('-0123456789', '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'))}"
    return raised if value == float(f"1e{exponent}") else f"{mantissa}·{raised}"


def percent(part: float, digits: int = 0) -> str:
    """Format 0.25 as ``25 %``."""
    return f"{100 * part:.{digits}f} %"


def percents(parts: tuple[float, float, float], digits: int = 0, sign: str = "") -> str:
    """Format a share with its interval as ``25 % [20, 30]``; the sign "+" marks shares above 0."""
    part, low, high = (f"{100 * one:{sign}z.{digits}f}" for one in parts)
    return f"{part} % [{low}, {high}]"


def listed(values: Iterable[object]) -> str:
    """Join the values with commas; "none" if there are none."""
    return ", ".join(map(str, values)) or "none"


def render(template: str, **values: Any) -> str:
    """Return a template, filled; ``safe`` marks HTML as such, the filter ``formula`` sets scripts."""
    return _environment().get_template(template).render(safe=Markup, **values)


@cache
def _environment() -> Environment:
    made = Environment(
        loader=PackageLoader("verification.site"),
        autoescape=select_autoescape(),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["formula"] = lambda text: Markup(formula(text))
    return made


def machine() -> Iterator[tuple[str, str]]:
    """Yield the machine, and the versions of the libraries that make numbers."""
    yield "Processor", f"{_processor()}, {os.cpu_count()} cores"
    yield "System", f"{platform.system()} {platform.release()}, Python {platform.python_version()}"
    yield "Versions", ", ".join(map(" ".join, libraries().items()))


def _processor() -> str:
    """Return the model of the processor, if the system tells it."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text("utf-8").splitlines() if information.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()
