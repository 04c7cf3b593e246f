"""The mean-field chapter: DAE, ODE, PDE and moments, how fast they meet, and where they fail."""

from __future__ import annotations

from collections.abc import Sequence

from verification.page.report import Chapter, Context, Section
from verification.thesis.chapter5.sections import agreement, cost, energy, failures, grid, rates, stability

# In the order of the page; a part may read the tables of those before it.
PARTS = (agreement.PART, energy.PART, rates.PART, stability.PART, grid.PART, cost.PART, failures.PART)


def run(context: Context) -> None:
    """Complete all studies of the chapter."""
    for part in PARTS:
        part.run(context)


def sections(context: Context) -> Sequence[Section]:
    """One for each of ``PARTS``."""
    return [part.section(context) for part in PARTS]


CHAPTER = Chapter("Mean field: DAE, ODE, PDE, moments", run, sections, place=8, tables=("meanfield_",))
