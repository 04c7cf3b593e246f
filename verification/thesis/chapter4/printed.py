"""The ratios that the thesis prints for isolated cells, beside the measured ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import pandas as pd

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.statistics.categories import Rule, What, kept_times, outcome
from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio, ratio
from tissue.study.read import Results
from verification.thesis.chapter4.studies import PRESETS

# Runs of each scenario of Figures 10 and 12; the end of the runs of the thesis [h].
OF, END = 400, 48.0
PRINTED_LEVEL = 0.99  # at which a measured ratio agrees with a printed one
RULES: dict[str, Rule] = {"thesis": "thesis", "corrected": "thesis", "published": "published"}


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


def compared(results: Mapping[str, Results]) -> pd.DataFrame:
    """Each printed ratio beside the measured one: their difference, its 99 % interval, whether that contains 0.

    One row for each preset, time and printed ratio. The thesis does not say at which time it prints them: its runs end
    at 48 h, those that were published at 54 h, with a rule of extrusion that looks ahead from the time before.
    """
    rows = []
    for preset, suffix in PRESETS.items():
        for printed in PRINTED:
            if printed.study + suffix not in results:
                continue
            cells = results[printed.study + suffix].cells(printed.scenario)
            times = kept_times(cells)
            shown = [time for time in times if time in {END, times[-1]}]
            rows += [{"preset": preset, "time_h": t} | _row(printed, cells, t, RULES[preset]) for t in shown]
    return pd.DataFrame(rows)


def _row(printed: Printed, cells: pd.DataFrame, t: float, rule: Rule) -> dict[str, Any]:
    measured = ratio(outcome(cells, printed.what, t, rule), cells["replicate"])
    difference = against_printed(measured, printed.value, OF)
    low, high = difference.interval(PRINTED_LEVEL)
    return {
        "scenario": printed.scenario,
        "what": printed.what,
        "source": printed.source,
        "printed": printed.value,
        "measured": measured.value,
        "runs": measured.of,
        "difference": difference.value,
        "low": low,
        "high": high,
        "agrees": agrees(difference),
    }


def against_printed(measured: Ratio, printed: float, of: int) -> Difference:
    """Return a measured ratio minus a printed one of ``of`` independent cells, which has its own chance error.

    They agree if ``agrees`` says so. A printed ratio is taken as the nearest one that ``of`` cells can have.

    Parameters
    ----------
    measured
        From the runs.
    printed
        From 0 to 1.
    of
        Cells it was printed for: n_rep = 400 for Figures 10 to 14 of chapter 4, 100 for Figure 15 of chapter 4.

    Returns
    -------
    Difference
    """
    if not 0 <= printed <= 1:
        raise InvalidProblem(f"printed = {describe(printed)}: must be a ratio from 0 to 1")
    return Difference(measured, Ratio(round(printed * of), of))


def agrees(difference: Difference, level: float = PRINTED_LEVEL) -> bool:
    """Return whether the interval of the difference contains 0."""
    low, high = difference.interval(level)
    return low <= 0 <= high
