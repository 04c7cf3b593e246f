"""A sentence or formula of the thesis with the machine check that decides it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

import pandas as pd

Tables = Mapping[str, pd.DataFrame]


class Kind(Enum):
    """How a claim came out."""

    HOLDS = "holds"
    CORRECTED = "holds with correction"
    FAILS = "fails"
    OPEN = "not decided"


@dataclass(frozen=True)
class Verdict:
    """How a claim came out, and the numbers that say so."""

    kind: Kind
    measured: str


@dataclass(frozen=True)
class Claim:
    """One statement.

    Attributes
    ----------
    id
        Unique short name.
    source
        Section or equation of the thesis.
    quote
        One sentence or formula, as printed.
    check
        tables -> Verdict.
    needs
        Names of the tables that ``check`` reads.
    """

    id: str
    source: str
    quote: str
    check: Callable[[Tables], Verdict]
    needs: tuple[str, ...] = ()

    def decide(self, tables: Tables) -> Verdict:
        """The verdict; "not decided" where a table is missing."""
        missing = [name for name in self.needs if name not in tables]
        if missing:
            return Verdict(Kind.OPEN, f"the table {', '.join(missing)} is not there: run the report")
        return self.check(tables)


def holds_if(true: bool, measured: str) -> Verdict:
    """A statement that stands or falls as printed."""
    return Verdict(Kind.HOLDS if true else Kind.FAILS, measured)


def corrected_if(printed: bool, corrected: bool, measured: str) -> Verdict:
    """A statement that holds as printed, else with its correction, else not at all."""
    if printed:
        return Verdict(Kind.HOLDS, measured)
    return Verdict(Kind.CORRECTED if corrected else Kind.FAILS, measured)
