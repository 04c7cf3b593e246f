"""The mean-field chapter: DAE, ODE, PDE and moments, how fast they meet, and where they fail."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from dincl.study import Study
from verification.site.context import Context
from verification.site.parts import Section
from verification.site.report import Chapter, Finding
from verification.thesis.chapter5 import (
    agreement,
    cost,
    drift,
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
    maps.STIFF: partial(maps.study, maps.STIFF),
    maps.PUSHED: partial(maps.study, maps.PUSHED),
    drift.NAME: drift.study,
}
# In the order of the page.
PARTS = (agreement, energy, rates, stability_constant, grid_order, cost, failures, maps, drift)


def run(context: Context) -> None:
    """Complete all studies of the chapter."""
    for name in STUDIES:
        context.rows(name)


def sections(context: Context) -> Sequence[Section]:
    """Return the sections of the parts."""
    return [part.section(context) for part in PARTS]


def findings(context: Context) -> Sequence[Finding]:
    """State how fast random starts approach their density."""
    found = rates.fits(rates.results(context.tables[rates.NAME])).set_index("case")
    line, space = (found.loc[rates.CUBES[d]] for d in (1, 3))
    said = (
        "N random particles approach their limit like N to the power "
        f"{line['slope']:.3f} [{line['low']:.3f}, {line['high']:.3f}] on a line, and "
        f"{space['slope']:.3f} [{space['low']:.3f}, {space['high']:.3f}] in space."
    )
    return [Finding(said, rates.TITLE)]


CHAPTER = Chapter(
    "meanfield",
    "Mean field: DAE, ODE, PDE, moments",
    "Do many constrained particles become their mean-field limit, at which rate, and what does each solver cost?",
    run,
    sections,
    findings,
    tables=("meanfield_",),
)
