"""The register: all claims of the thesis, found in the folders named ``claims``."""

from __future__ import annotations

import pkgutil
import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from importlib import import_module

import verification.thesis
from verification.claim import Claim

# It finds claims at run time; the numbers are made by their checks.
MAKES_NO_NUMBERS = True


@cache
def register() -> tuple[Claim, ...]:
    """All claims in the order of the thesis; ValueError if two have one id."""
    found = [(_place(name), claim) for name in modules() for claim in import_module(name).CLAIMS]
    claims = tuple(claim for _, claim in sorted(found, key=lambda pair: (pair[1].chapter, pair[0])))
    twice = [name for name, count in Counter(claim.id for claim in claims).items() if count > 1]
    if twice:
        raise ValueError(f"claim ids {', '.join(twice)} are given twice: each must be unique")
    return claims


def modules() -> Iterator[str]:
    """The modules that state claims."""
    for part in pkgutil.iter_modules(verification.thesis.__path__, "verification.thesis."):
        if part.ispkg:
            folder = import_module(f"{part.name}.claims").__path__
            yield from (module.name for module in pkgutil.iter_modules(folder, f"{part.name}.claims."))


def _place(module: str) -> tuple[bool, list[int], str]:
    """Chapters before the appendix, then by section: ``s4_6_1_tools`` is section 4.6.1."""
    name = module.rpartition(".")[2]
    return "appendix" in module, [int(number) for number in re.findall(r"\d+", name)], name
