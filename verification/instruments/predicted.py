"""Failures that theory predicts: cases with the number predicted and the number found, and limits by bisection."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from dincl.study import Key, Row, Study

# Halvings at most; a double has fewer bits.
MOST_HALVINGS = 60
COLUMNS = {
    "title": "Case",
    "theory": "To be expected",
    "expected": "Predicted",
    "found": "Found",
    "agrees": "Agrees",
    "words": "Particulars",
}


class Found(NamedTuple):
    """The number of the theory and the number found, of the same quantity, whether they agree, and the particulars.

    Both are NaN where theory predicts what happens, and no number: see ``happens``.
    """

    expected: float
    found: float
    agrees: bool
    words: str


@dataclass(frozen=True)
class Case:
    """A failure that theory predicts.

    Attributes
    ----------
    id
        Unique short name.
    title, theory
        What fails; what is to be expected, with its formula.
    find
        () -> Found; picklable.
    """

    id: str
    title: str
    theory: str
    find: Callable[[], Found]


def within(expected: float, found: float, relative: float, words: str) -> Found:
    """Compare two numbers, which agree up to the part ``relative`` of the first."""
    agrees = abs(found - expected) <= relative * abs(expected)
    return Found(expected, found, agrees, f"{words}; deviation {found / expected - 1:+.1e}")


def happens(agrees: bool, words: str) -> Found:
    """State whether what theory predicts happens, where it predicts no number."""
    return Found(math.nan, math.nan, agrees, words)


def boundary(holds: Callable[[float], bool], low: float, high: float, relative: float) -> float:
    """Return where ``holds`` changes from true at ``low`` to false at ``high``, to the precision ``relative``.

    0 < low < high are halved in the logarithm; ValueError if the two ends do not differ so.
    """
    if not holds(low) or holds(high):
        raise ValueError(f"low = {low:g}, high = {high:g}: must hold at the first and not at the second")
    for _ in range(MOST_HALVINGS):
        if high <= low * (1 + relative):
            break
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return math.sqrt(low * high)


def cases_study(cases: Sequence[Case], name: str, title: str) -> Study:
    """Return the study of all cases, one run each; pages join titles and theory to its rows."""
    finder = _Finder({case.id: case.find for case in cases})
    return Study(name, title, ("case",), tuple({"case": case.id} for case in cases), finder, columns=COLUMNS)


@dataclass(frozen=True)
class _Finder:
    """Function that looks for one of the cases; picklable."""

    finds: Mapping[str, Callable[[], Found]]

    def __call__(self, key: Key) -> list[Row]:
        return [dict(key) | self.finds[key["case"]]()._asdict()]
