"""The geometry of the feasible set: chapter 1, section 4, and the consistency of PBD, chapter 2, section 3."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dincl.study import Study
from verification.site.context import Context
from verification.site.parts import Section
from verification.site.report import Chapter, Finding
from verification.thesis.chapter1 import consistency, prox_regularity

STUDIES: dict[str, Callable[..., Study]] = {
    prox_regularity.NAME: prox_regularity.study,
    prox_regularity.ARRANGED: prox_regularity.arrangements_study,
}


def run(context: Context) -> None:
    """Complete the searches and the limits of PBD."""
    for name in STUDIES:
        context.rows(name)
    consistency.run(context)


def sections(context: Context) -> Sequence[Section]:
    """Write about the constant of prox-regularity and about the consistency of one step of PBD."""
    return [prox_regularity.section(context), consistency.section(context)]


def findings(context: Context) -> Sequence[Finding]:
    """Say by how much the printed constant is too small."""
    return [Finding(prox_regularity.finding(context.tables[prox_regularity.NAME]), prox_regularity.TITLE)]


CHAPTER = Chapter(
    "geometry",
    "The geometry of the feasible set",
    "How far from convex is the feasible set of discs, and which inclusion does one step of PBD belong to?",
    run,
    sections,
    findings,
    tables=("prox_", "consistency"),
)
