"""The mean-field chapter: how fast particles find their limit, what each solver costs, and where they fail."""

from __future__ import annotations

from collections.abc import Callable

from dincl.study import Study
from verification.site.context import Context
from verification.thesis.chapter5 import cost, failures, rates, stability_constant

# In the order of the page.
PARTS = (rates, stability_constant, cost, failures)
STUDIES: dict[str, Callable[..., Study]] = {part.NAME: part.study for part in PARTS}


def run(context: Context) -> None:
    """Complete all studies of the chapter."""
    for name in STUDIES:
        context.rows(name)


def show(context: Context) -> None:
    """Give what the parts show."""
    for part in PARTS:
        part.show(context)
