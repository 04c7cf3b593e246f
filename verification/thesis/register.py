"""The register: all claims of the thesis, listed by the sections that state them."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from verification.claims import Claim, stated_in
from verification.claims.decide import refuse_one_id_for_two
from verification.claims.graph import ordered


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
