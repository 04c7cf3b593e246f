"""Which claims a call is about, and the tables they read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase

from dincl.errors import InvalidProblem
from verification.claims import Claim, Table, Tables
from verification.site.context import Context
from verification.thesis.register import chapter_of


def select_claims(
    claims: Iterable[Claim], chapters: Sequence[int] = (), names: Sequence[str] = ()
) -> tuple[Claim, ...]:
    """Select the claims of the chapters whose id, or an id in ``also``, fits one of the patterns; empty: all.

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
    for name in names:
        if not any(_named(claim, [name]) for claim in claims):
            near = get_close_matches(name, [each for claim in claims for each in _ids(claim)], n=5, cutoff=0.0)
            raise InvalidProblem(f"no claim is named {name}; the nearest are {', '.join(near)}")
    return tuple(
        claim
        for claim in claims
        if (not chapters or chapter_of(claim) in chapters) and (not names or _named(claim, names))
    )


def _ids(claim: Claim) -> tuple[str, ...]:
    return (claim.id, *claim.also)


def _named(claim: Claim, patterns: Iterable[str]) -> bool:
    """Return whether one of the ids of a claim fits one of the patterns."""
    return any(fnmatchcase(name, pattern) for name in _ids(claim) for pattern in patterns)


def tables_for(claims: Iterable[Claim], context: Context) -> Tables:
    """Return the tables that the claims read; only their studies are taken over, or run with ``context.full``."""
    for needed in dict.fromkeys(name for claim in claims for name in claim.needs):
        if isinstance(needed, Table):
            context.table(needed)
    return context.tables
