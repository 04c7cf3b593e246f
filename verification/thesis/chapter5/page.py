"""The mean-field chapter: DAE, ODE, PDE and moments, how fast they meet, and where they fail."""

from __future__ import annotations

from collections.abc import Callable

from dincl.study import Study
from verification.site.context import Context
from verification.thesis.chapter5 import (
    agreement,
    cost,
    energy,
    failures,
    grid_order,
    maps,
    rates,
    stability_constant,
)

STUDIES: dict[str, Callable[..., Study]] = {
    agreement.NAME: agreement.study,
    energy.NAME: energy.study,
    energy.LONG: energy.long_study,
    rates.NAME: rates.study,
    stability_constant.NAME: stability_constant.study,
    grid_order.NAME: grid_order.study,
    cost.NAME: cost.study,
    failures.NAME: failures.study,
    maps.NAME: maps.study,
}
# In the order of the page.
PARTS = (agreement, energy, rates, stability_constant, grid_order, cost, failures, maps)


def run(context: Context) -> None:
    """Complete all studies of the chapter."""
    for name in STUDIES:
        context.rows(name)


def show(context: Context) -> None:
    """Give what the parts show."""
    for part in PARTS:
        part.show(context)
