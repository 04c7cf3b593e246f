"""A statement of the thesis, the check that decides it, and what to read instead where it is wrong."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from enum import Enum

import pandas as pd

from verification.evidence import Evidence, Kind

Tables = Mapping[str, pd.DataFrame]


class MissingRow(RuntimeError):
    """A table has no row of the kind that a check is about: the studies were too short for it."""


class Effect(Enum):
    """What a correction changes; the most serious first."""

    CONCLUSION = "a conclusion"
    MODEL = "the model or method"
    NUMBER = "a number"
    PROOF = "a step of a proof"
    NOTATION = "notation only"


class Cost(Enum):
    """How long a check takes, with the studies whose tables it reads; those that the repository keeps cost nothing."""

    SECONDS = "seconds"
    MINUTES = "minutes"
    HOURS = "hours"


@dataclass(frozen=True)
class Correction:
    """What to read instead of a statement that is wrong as printed.

    Attributes
    ----------
    text
        The statement as it holds.
    effect
        What changes for a reader who takes the correction.
    depends
        What else rests on the statement: equations, algorithms, figures, conclusions.
    """

    text: str
    effect: Effect
    depends: str


@dataclass(frozen=True)
class Claim:
    """One statement.

    Attributes
    ----------
    id
        Unique short name; it begins with the chapter: c1 to c5, c0 the introduction, c6 the conclusions. Appendix 1
        goes with chapter 3, appendix 2 with chapter 5.
    source
        Section, equation, table or figure of the chapter.
    quote
        One sentence or formula, as printed.
    check
        tables -> Evidence.
    needs
        Names of the tables that ``check`` reads.
    statement
        What is stated, in other words than those of the thesis.
    recorded
        The verdict that was found; another one is a regression.
    correction
        Where the statement is wrong as printed.
    chosen
        What the text leaves open and the check had to choose.
    cost
        See ``Cost``.
    """

    id: str
    source: str
    quote: str
    check: Callable[[Tables], Evidence]
    needs: tuple[str, ...] = ()
    _: KW_ONLY
    statement: str
    recorded: Kind = Kind.HOLDS
    correction: Correction | None = None
    chosen: str = ""
    cost: Cost = Cost.SECONDS

    @property
    def chapter(self) -> int:
        """The chapter of the thesis, by the id."""
        return int(self.id[1])

    def decide(self, tables: Tables) -> Evidence:
        """What the check finds; inconclusive where a table is missing."""
        missing = [name for name in self.needs if name not in tables]
        if missing:
            return Evidence(f"the table {', '.join(missing)} is not there: run the report", ())
        return self.check(tables)
