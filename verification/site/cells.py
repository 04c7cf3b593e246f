"""Cells of tables: numbers, shares and intervals as text, and a table as HTML."""
# ruff: noqa: RUF001

from __future__ import annotations

import re
from collections.abc import Iterable
from html import escape

import numpy as np
import pandas as pd

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
