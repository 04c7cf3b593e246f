"""The register: all claims of the thesis, listed by the sections that state them; a choice of them; errata."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

import pandas as pd

from dincl.errors import InvalidProblem
from verification.claims import Claim, Table, Tables, stated_in
from verification.claims.decide import refuse_one_id_for_two
from verification.claims.graph import ordered
from verification.site.context import Context


def modules() -> list[str]:
    """Return the modules that state claims, in the order of the thesis."""
    found: list[str] = []
    for chapter in range(1, 6):
        folder = f"verification.thesis.chapter{chapter}.claims"
        names = [one.name for one in iter_modules(import_module(folder).__path__)]
        found += [f"{folder}.{name}" for name in sorted(names, key=_place)]
    return found


def _place(name: str) -> tuple[bool, list[int], str]:
    """Return the section with which the name of a module begins; conclusions and the appendix are last."""
    numbers = [int(part) for part in name.removeprefix("s").split("_") if part.isdigit()]
    return not numbers, numbers, name


@cache
def register() -> tuple[Claim, ...]:
    """Return all claims in the order of the thesis, in a file as they are defined.

    Raises
    ------
    InvalidProblem
        If two claims have one id, if a claim rests on an unknown one, or on itself through others.
    """
    claims = tuple(sorted((one for name in modules() for one in stated_in(import_module(name))), key=chapter_of))
    refuse_one_id_for_two(claims)
    ordered(claims)
    return claims


def chapter_of(claim: Claim) -> int:
    """Return the chapter of a claim, by its id.

    c1 to c5; c0 is the introduction, c6 the conclusions. Appendix 1 goes with chapter 3, appendix 2 with
    chapter 5.
    """
    return int(claim.id[1])


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


# What is printed wrong in the thesis and has no check of its own.
FILE = Path(__file__).parent / "text" / "errata.csv"


@cache
def errata() -> pd.DataFrame:
    """One row for each: id, chapter, source, as printed, to be read, what it changes, what depends on it, why, line.

    The last column, ``claim``, names the claim whose check decides it, too; it is empty where none does.
    """
    return pd.read_csv(FILE, dtype={"id": str, "chapter": int, "place": int}).fillna({"claim": ""})
