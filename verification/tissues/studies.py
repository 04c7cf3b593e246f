"""The studies of this room, by the names of their tables."""

from __future__ import annotations

from collections.abc import Callable

from dincl.study import Study
from verification.tissues import curved, fits
from verification.tissues.needs import study as needs
from verification.tissues.space import growth, isolated, sheet

# Name -> the function ``study(smallest=False)``; the smallest form has some of the runs of the complete one.
STUDIES: dict[str, Callable[..., Study]] = {
    "space_growth": growth.study,
    "space_isolated": isolated.study,
    "space_sheet": sheet.study,
    "curved_ways_out": curved.study,
    "needs_answers": needs.study,
    "fit_coverage": fits.study,
}
