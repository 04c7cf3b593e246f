"""The studies with few, coarse steps, in this process: the whole way to a page in seconds."""

from dataclasses import replace
from typing import Any

import pytest

from tissue.pictures import charts as style
from verification.claims import Claim
from verification.site import context as page_context
from verification.site import sheet
from verification.site.context import Context
from verification.thesis import page, register

CLAIMS = register.register()
# The first claim of each chapter.
KEPT = set({register.chapter_of(claim): claim.id for claim in reversed(CLAIMS)}.values())


def shorten(patch: pytest.MonkeyPatch) -> None:
    """The smallest studies for the commands; small figures."""
    patch.setattr(page_context, "Context", short_context)
    patch.setattr(sheet, "DPI", 50)
    patch.setattr(style, "DPI", 50)
    for module in (register, page):
        patch.setattr(module, "register", few_claims)


def short_context(*arguments: Any, complete: object = None, **options: Any) -> Context:
    """One with the smallest studies, whatever ships."""
    return Context(*arguments, smallest=True, **options)


def few_claims() -> tuple[Claim, ...]:
    """Those that read tables, and some of the others; test_claims.py decides all."""
    few = [claim for number, claim in enumerate(CLAIMS) if claim.needs or number % 16 == 0 or claim.id in KEPT]
    names = {claim.id for claim in few}
    return tuple(replace(claim, rests_on=tuple(names.intersection(claim.rests_on))) for claim in few)
