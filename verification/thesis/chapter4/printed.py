"""The ratios that the thesis prints for isolated cells, and whether measured ones agree with them."""

from __future__ import annotations

from typing import NamedTuple

import pandas as pd

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.study.categories import What
from verification.claims import Tables
from verification.thesis.chapter4.ensembles import PRESETS
from verification.thesis.chapter4.outcomes import LOOKS_AHEAD
from verification.thesis.chapter4.ratios import ProportionContrast, Ratio, difference

# Runs of each scenario of Figures 10 and 12; the end of the runs of the thesis [h], and of those that were published.
OF, END, LATER = 400, 48.0, 54.0
PRINTED_LEVEL = 0.99  # at which a measured ratio agrees with a printed one


class Printed(NamedTuple):
    """A ratio as the thesis prints it."""

    study: str
    scenario: str
    what: What
    value: float
    source: str


PRINTED = (
    Printed("figure10", "[A]", "apical", 0.3, "caption of Figure 10"),
    Printed("figure10", "[A]", "basal", 0.1, "caption of Figure 10, section 4.2.1"),
    Printed("figure10", "[A]", "below", 0.6, "section 4.1.2"),
    Printed("figure10", "[B]", "basal", 0.0, "section 4.2.1"),
    Printed("figure12", "[A] no INM", "basal", 0.2, "section 4.2.1"),
    Printed("figure12", "[B] no INM", "basal", 0.7, "section 4.2.1"),
)


def compared(tables: Tables) -> pd.DataFrame:
    """Compare each printed ratio with the measured one: their difference, its 99 % interval, whether that contains 0.

    One row for each preset, time and printed ratio. The thesis does not say at which time it prints them: its runs end
    at 48 h, those that were published at 54 h, with a rule of extrusion that looks ahead from the time before.
    """
    ends = tables["emt_ratios"].set_index(["study", "scenario", "what"])
    before = tables["emt_in_time"].set_index(["study", "scenario", "what", "time_h"])
    rows = []
    for preset, ending in PRESETS.items():
        for one in PRINTED:
            name = one.study + ending
            if preset == "published":
                what = LOOKS_AHEAD if one.what == "basal" else one.what
                rows.append(_row(preset, END, one, before.loc[(name, one.scenario, what, END)]))
            end = LATER if preset == "published" else END
            rows.append(_row(preset, end, one, ends.loc[(name, one.scenario, one.what)]))
    return pd.DataFrame(rows)


def _row(preset: str, t: float, printed: Printed, counted: pd.Series) -> dict[str, object]:
    measured = Ratio(int(counted["count"]), int(counted["of"]))
    found = against_printed(measured, printed.value, OF)
    low, high = found.interval(PRINTED_LEVEL)
    return {
        "preset": preset,
        "time_h": t,
        "scenario": printed.scenario,
        "what": printed.what,
        "printed": printed.value,
        "measured": measured.value,
        "difference": found.value,
        "low": low,
        "high": high,
        "agrees": agrees(found),
    }


def against_printed(measured: Ratio, printed: float, of: int) -> ProportionContrast:
    """Return a measured ratio minus a printed one of ``of`` independent cells, which has its own chance error.

    They agree if ``agrees`` says so. A printed ratio is taken as the nearest one that ``of`` cells can have: n_rep =
    400 for Figures 10 to 14 of chapter 4.
    """
    if not 0 <= printed <= 1:
        raise InvalidProblem(f"printed = {describe(printed)}: must be a ratio from 0 to 1")
    return difference(measured, Ratio(round(printed * of), of))


def agrees(found: ProportionContrast) -> bool:
    """Return whether the interval of the difference contains 0."""
    low, high = found.interval(PRINTED_LEVEL)
    return low <= 0 <= high
