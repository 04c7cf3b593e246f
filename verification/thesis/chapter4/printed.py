"""The ratios that the thesis prints for isolated cells, beside the measured ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import pandas as pd

from tissue.statistics.categories import Rule, What, kept_times, outcome
from tissue.statistics.ratios import ratio
from tissue.study.read import Results
from verification.thesis.chapter4.ratio_claims import PRINTED_LEVEL, against_printed, agrees
from verification.thesis.chapter4.studies import PRESETS

# Runs of each scenario of Figures 10 and 12; the end of the runs of the thesis [h].
OF, END = 400, 48.0
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
