"""The geometry of the feasible set: chapter 1, section 4, and the consistency of PBD, chapter 2, section 3."""

from __future__ import annotations

from collections.abc import Callable

from dincl.study import Study
from verification.site.context import Context
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


def show(context: Context) -> None:
    """Give the constants of prox-regularity, and the consistency of one step of PBD."""
    context.draw(prox_regularity.NAME, prox_regularity.figure, context.tables[prox_regularity.NAME])
    for name in STUDIES:
        context.show(name, context.headed(name, context.tables[name]))
    consistency.show(context)
