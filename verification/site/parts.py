"""Parts of a page: paragraphs, figures, tables and claims, in sections."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from decimal import ROUND_CEILING, Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from verification.claims import Verdict
from verification.claims.decide import READING, readings
from verification.site.sources import link

# Numbers smaller than this are written with an exponent.
PLAIN = 1e-2
VERDICTS = {verdict.value: verdict.name.lower() for verdict in Verdict}


@dataclass(frozen=True)
class Text:
    """A paragraph; HTML."""

    html: str
    kind: str = field(default="text", init=False)


@dataclass(frozen=True)
class Follows:
    """Conclusion of a section, its last paragraph; HTML."""

    html: str
    kind: str = field(default="follows", init=False)


@dataclass(frozen=True)
class Picture:
    """A figure file with its caption; the page links it."""

    path: Path
    caption: str
    kind: str = field(default="picture", init=False)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in dots, so that a page keeps room for it; the file is a PNG."""
        return struct.unpack(">II", self.path.read_bytes()[16:24])


@dataclass(frozen=True)
class Chart:
    """Interactive chart: its HTML, the script that its page needs once, and a picture for readers without scripts.

    Without a picture the page refers to the figures below the chart.
    """

    html: str
    script: str
    caption: str
    picture: Picture | None = None
    kind: str = field(default="chart", init=False)


@dataclass(frozen=True)
class Grid:
    """A table on the page; ``file`` is the table it was taken from; a ``folded`` one opens on a click."""

    rows: pd.DataFrame
    caption: str
    file: str
    folded: bool = False
    kind: str = field(default="grid", init=False)

    @property
    def shown(self) -> pd.DataFrame:
        """The rows without columns and rows in which nothing stands."""
        said = self.rows.notna() & (self.rows != "")
        return self.rows.loc[said.any(axis=1), said.any(axis=0)]

    @property
    def cells(self) -> list[list[tuple[str, str]]]:
        """Text and CSS class of every cell that is shown."""
        return [[cell(value) for value in row] for row in self.shown.itertuples(index=False, name=None)]


@dataclass(frozen=True)
class SearchField:
    """Search field: hides the claims below it that lack a typed word or have another verdict."""

    kind: str = field(default="search", init=False)
    verdicts: tuple[str, ...] = tuple(VERDICTS)


@dataclass(frozen=True)
class Statements:
    """Claims, one below the other; the rows of ``verification.claims.decide.decide_all``, with their chapter.

    ``wrong`` names, for each claim, the claims wrong as printed that it rests on.
    """

    table: pd.DataFrame
    wrong: Mapping[str, Sequence[str]]
    kind: str = field(default="statements", init=False)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One dictionary for each claim, with the CSS class of its verdict and the addresses of check and runs."""
        columns = readings(self.table)
        return [
            row
            | {
                "look": VERDICTS[row["verdict"]],
                "code": link(row["check"]),
                "runs": _names(row["runs"]),
                "also": _names(row["also"]),
                "below": _names(row["rests_on"]),
                "wrong": self.wrong[row["id"]],
                # A sentence made of the comparisons says them all.
                "compared": row["printed"] not in row["measured"],
                "by_reading": _by_reading(row, columns),
            }
            for row in self.table.to_dict("records")
        ]


def _names(listed: str) -> list[str]:
    return listed.split(", ") if listed else []


def _by_reading(row: Mapping[str, Any], columns: Sequence[str]) -> list[tuple[str, str, str]]:
    """Return name, verdict and numbers of each reading; nothing for a claim with one reading."""
    measured = dict(line.split(": ", 1) for line in row["readings"].splitlines())
    found = [(column.removeprefix(READING), row[column]) for column in columns if row[column]]
    return [(name, verdict, measured[name]) for name, verdict in found]


@dataclass(frozen=True)
class HowMeasured:
    """Paragraphs on how something was measured; they open on a click."""

    texts: Sequence[Text]
    kind: str = field(default="method", init=False)


Part = Text | Follows | Picture | Chart | Grid | SearchField | Statements | HowMeasured


@dataclass(frozen=True)
class Section:
    """A heading with its parts."""

    title: str
    parts: Sequence[Part]

    @property
    def ordered(self) -> Sequence[Part]:
        """The parts in the order of a page: pictures, the result, tables, others, then how it was measured.

        A section without pictures stays as it is.
        """
        if not any(isinstance(part, Picture | Chart) for part in self.parts):
            return self.parts
        kinds = ((Picture, Chart), (Follows,), (Grid,), (SearchField, Statements, HowMeasured))
        found = [part for kind in kinds for part in self.parts if isinstance(part, kind)]
        texts = [part for part in self.parts if isinstance(part, Text)]
        return [*found, HowMeasured(texts)] if texts else found


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


def number_up(value: float) -> str:
    """Format a number that follows "at most": as ``number`` does, but rounded up."""
    if not np.isfinite(value):
        return number(value)
    exact, digits = Decimal(repr(float(value))), 3 if PLAIN <= value < 1e3 else 2
    return number(float(exact.quantize(Decimal(1).scaleb(exact.adjusted() - digits + 1), ROUND_CEILING)))
