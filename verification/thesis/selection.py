"""Which claims a call is about, and the tables they read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase

from verification.claim import Claim, Cost, Tables
from verification.page.report import Context
from verification.thesis.chapter4 import kept


def selected(
    claims: Iterable[Claim], chapters: Sequence[int] = (), names: Sequence[str] = (), cost: Cost | None = None
) -> tuple[Claim, ...]:
    """Those of the chapters, whose id fits one of the patterns, and that cost no more; empty: all.

    Raises
    ------
    ValueError
        If a chapter or a pattern fits no claim.
    """
    claims = tuple(claims)
    for name in names:
        if not any(fnmatchcase(claim.id, name) for claim in claims):
            near = get_close_matches(name, [claim.id for claim in claims], n=5, cutoff=0.0)
            raise ValueError(f"no claim is named {name}; the nearest are {', '.join(near)}")
    known = sorted({claim.chapter for claim in claims})
    for chapter in chapters:
        if chapter not in known:
            raise ValueError(f"chapter {chapter} has no claims: those that have are {', '.join(map(str, known))}")
    order = list(Cost)
    return tuple(
        claim
        for claim in claims
        if (not chapters or claim.chapter in chapters)
        and (not names or any(fnmatchcase(claim.id, name) for name in names))
        and (cost is None or order.index(claim.cost) <= order.index(cost))
    )


def tables_for(claims: Iterable[Claim], context: Context) -> Tables:
    """The tables that the claims read: kept ones, and those of the report's chapters, which are run for them."""
    from verification.thesis.chapters import CHAPTERS

    needed = {name for claim in claims for name in claim.needs}
    if not context.full:
        context.tables |= kept.tables()
    for chapter in CHAPTERS:
        if any(name.startswith(chapter.tables) for name in needed - context.tables.keys()):
            chapter.run(context)
    return context.tables
