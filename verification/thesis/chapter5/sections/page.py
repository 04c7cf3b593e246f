"""The mean-field chapter: DAE, ODE, PDE and moments, how fast they meet, and where they fail."""

from __future__ import annotations

from collections.abc import Sequence

from verification.instruments.rates import IID, PAIR
from verification.page.context import Context
from verification.page.parts import Section
from verification.page.prose import fill
from verification.page.report import Chapter, Finding
from verification.thesis.chapter5.sections import agreement, cost, energy, failures, grid, rates, stability
from verification.thesis.chapter5.sections.words import PROSE

# In the order of the page; a part may read the tables of those before it.
PARTS = (agreement.PART, energy.PART, rates.PART, stability.PART, grid.PART, cost.PART, failures.PART)


def run(context: Context) -> None:
    """Complete all studies of the chapter."""
    for part in PARTS:
        part.run(context)


def sections(context: Context) -> Sequence[Section]:
    """Return one section for each of ``PARTS``."""
    return [part.section(context) for part in PARTS]


def findings(context: Context) -> Sequence[Finding]:
    """State how fast random starts approach their density, by the complete distances, which ship."""
    random = context.tables["meanfield_start_exponents"].set_index(["d", "start"])
    line, space = random.loc[(1, IID)], random.loc[(3, PAIR)]
    said = fill(PROSE / "learned.html", line=line, space=space)
    return [Finding(said["rates"], rates.TITLE)]


CHAPTER = Chapter(
    "meanfield",
    "Mean field: DAE, ODE, PDE, moments",
    "Do many constrained particles become their mean-field limit, at which rate, and what does each solver cost?",
    run,
    sections,
    findings,
    place=13,
    tables=("meanfield_",),
)
