"""A case: a failure that theory predicts, and the function that looks for it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from dincl.study import Key, Row, Study


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
    """Say whether two numbers agree up to the part ``relative`` of the first."""
    agrees = abs(found - expected) <= relative * abs(expected)
    return Found(expected, found, agrees, f"{words}; deviation {found / expected - 1:+.1e}")


def happens(agrees: bool, words: str) -> Found:
    """Say whether what theory predicts happens, where it predicts no number."""
    return Found(math.nan, math.nan, agrees, words)


def study(cases: Sequence[Case]) -> Study:
    """Return all cases, one run each."""
    return Study(
        name="stability_cases",
        title="Stability: cases",
        key=("case",),
        runs=tuple({"case": case.id} for case in cases),
        run=_Finder({case.id: case.find for case in cases}),
    )


@dataclass(frozen=True)
class _Finder:
    """Function that looks for one of the cases; picklable."""

    finds: Mapping[str, Callable[[], Found]]

    def __call__(self, key: Key) -> list[Row]:
        return [dict(key) | self.finds[key["case"]]()._asdict()]
