"""The register: all claims of the thesis, found in the folders named ``claims``."""

from __future__ import annotations

import pkgutil
import re
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.util import find_spec

import verification.thesis
from verification.claims import Claim, stated_in
from verification.claims.decide import refuse_one_id_for_two
from verification.claims.graph import ordered

# It finds claims at run time; the numbers are made by their checks.
MAKES_NO_NUMBERS = True


@cache
def register() -> tuple[Claim, ...]:
    """Return all claims in the order of the thesis, in a file as they are defined.

    Raises
    ------
    InvalidProblem
        If two claims have one id, if a claim rests on an unknown one, or on itself through others.
    """
    found = [(_place(name), claim) for name in modules() for claim in stated_in(import_module(name))]
    claims = tuple(claim for _, claim in sorted(found, key=lambda pair: (chapter_of(pair[1]), pair[0])))
    refuse_one_id_for_two(claims)
    ordered(claims)
    return claims


def chapter_of(claim: Claim) -> int:
    """Return the chapter of a claim, by its id.

    c1 to c5; c0 is the introduction, c6 the conclusions. Appendix 1 goes with chapter 3, appendix 2 with chapter 5.
    """
    return int(claim.id[1])


def modules() -> Iterator[str]:
    """Yield the modules that state claims."""
    for part in filter(_has_claims, pkgutil.iter_modules(verification.thesis.__path__, "verification.thesis.")):
        folder = import_module(f"{part.name}.claims").__path__
        yield from (module.name for module in pkgutil.iter_modules(folder, f"{part.name}.claims."))


def _has_claims(part: pkgutil.ModuleInfo) -> bool:
    """Return whether a folder has claims."""
    return part.ispkg and find_spec(f"{part.name}.claims") is not None


def _place(module: str) -> tuple[bool, list[int], str]:
    """Return the sorting key of a module: chapters before the appendix, then by section (``s4_6_1_tools``: 4.6.1)."""
    name = module.rpartition(".")[2]
    return "appendix" in module, [int(number) for number in re.findall(r"\d+", name)], name
