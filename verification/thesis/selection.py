"""Which claims a call is about, and the tables they read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from dincl.errors import InvalidProblem
from verification.claims import Claim, Cost, Tables
from verification.claims.selection import select
from verification.page.context import Context
from verification.thesis.chapter4 import kept
from verification.thesis.register import chapter_of


def select_claims(
    claims: Iterable[Claim], chapters: Sequence[int] = (), names: Sequence[str] = (), cost: Cost | None = None
) -> tuple[Claim, ...]:
    """Select the claims of the chapters whose id fits one of the patterns, and that cost no more; empty: all.

    Raises
    ------
    InvalidProblem
        If a chapter or a pattern fits no claim.
    """
    claims = tuple(claims)
    known = sorted({chapter_of(claim) for claim in claims})
    for chapter in chapters:
        if chapter not in known:
            raise InvalidProblem(f"chapter {chapter} has no claims: those that have are {', '.join(map(str, known))}")
    return tuple(claim for claim in select(claims, names, cost) if not chapters or chapter_of(claim) in chapters)


def tables_for(claims: Iterable[Claim], context: Context) -> Tables:
    """Return the tables that the claims read; chapters of the report are run for tables that do not ship."""
    from verification.page.chapters import CHAPTERS

    needed = {name for claim in claims for name in claim.needs}
    if not context.full:
        context.tables |= kept.tables()
    for chapter in CHAPTERS:
        if any(name.startswith(chapter.tables) for name in needed - context.tables.keys()):
            chapter.run(context)
    return context.tables
