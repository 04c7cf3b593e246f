"""Drawing of the graph of claims: boxes in columns, each to the right of the claims that it rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from graphlib import TopologicalSorter
from typing import NamedTuple

MAKES_NO_NUMBERS = True
# Sizes of a drawing [dots].
COLUMN, ROW, BOX, HIGH, EDGE = 190, 26, 150, 20, 8


class ClaimBox(NamedTuple):
    """A claim at its place [dots], with the CSS class of its verdict."""

    id: str
    x: int
    y: int
    look: str


class Arrow(NamedTuple):
    """A line from a claim to one that rests on it [dots]."""

    x0: int
    y0: int
    x1: int
    y1: int


@dataclass(frozen=True)
class ClaimGraph:
    """Graph of some claims.

    Attributes
    ----------
    looks
        CSS class of each claim, by id.
    rests_on
        Ids that each claim rests on; claims without a neighbour are left out.
    caption
        One sentence.
    """

    looks: Mapping[str, str]
    rests_on: Mapping[str, Sequence[str]]
    caption: str
    kind: str = field(default="graph", init=False)
    box: tuple[int, int] = field(default=(BOX, HIGH), init=False)

    @property
    def columns(self) -> list[list[str]]:
        """Ids by the length of the longest chain of claims below; within a column near the claims below."""
        sorter = TopologicalSorter({name: below for name, below in self.rests_on.items() if below})
        sorter.prepare()
        columns: list[list[str]] = []
        rows: dict[str, int] = {}
        while sorter.is_active():
            ready = sorter.get_ready()
            columns.append(sorted(ready, key=lambda name: (self._mean_row(name, rows), name)))
            rows |= {name: k for k, name in enumerate(columns[-1])}
            sorter.done(*ready)
        return columns

    def _mean_row(self, name: str, rows: Mapping[str, int]) -> float:
        """Return the mean row of the claims below."""
        below = [rows[other] for other in self.rests_on.get(name, ()) if other in rows]
        return sum(below) / max(len(below), 1)

    @property
    def boxes(self) -> list[ClaimBox]:
        """All boxes."""
        return [
            ClaimBox(name, EDGE + COLUMN * i, EDGE + ROW * k, self.looks.get(name, ""))
            for i, column in enumerate(self.columns)
            for k, name in enumerate(column)
        ]

    @property
    def arrows(self) -> list[Arrow]:
        """All lines."""
        at = {box.id: box for box in self.boxes}
        return [
            Arrow(at[below].x + BOX, at[below].y + HIGH // 2, at[name].x, at[name].y + HIGH // 2)
            for name, found in self.rests_on.items()
            for below in found
        ]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        columns = self.columns
        return COLUMN * len(columns) + 2 * EDGE, ROW * max(map(len, columns), default=0) + 2 * EDGE
