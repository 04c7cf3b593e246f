"""What becomes of the cells by each program of events: the ratios at the end of Tables 1 to 5 of chapter 4."""

from __future__ import annotations

from typing import get_args

from dincl.study import Key, Row, Study
from tissue.study.categories import What, kept_times, outcome
from verification.thesis.chapter4.ensembles import NAMES, ensemble, scenario_of
from verification.thesis.chapter4.ratios import ratio

TITLE = "EMT: ratios at the end by program"
SMALLEST = {"study": "figure14", "scenario": "[AB]"}
COLUMNS = {
    "study": "Study",
    "scenario": "Scenario",
    "what": "Outcome",
    "value": "Ratio",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
    "effective": "Effective cells",
    "runs": "Runs",
}


def study(smallest: bool = False) -> Study:
    """Count the outcomes at the end of the runs; the groups of Table 5 have up to 50,000 runs, an hour of two cores."""
    keys = sorted(
        ({"study": name, "scenario": scenario} for name in NAMES for scenario in ensemble(name).scenarios),
        key=lambda key: -ensemble(key["study"]).replicates,
    )
    runs = (SMALLEST,) if smallest else tuple(keys)
    return Study("emt_ratios", TITLE, ("study", "scenario"), runs, ratios, columns=COLUMNS, by=("what",))


def ratios(key: Key) -> list[Row]:
    """Return a row for each outcome, with Wilson's 95 % interval on the effective number of cells."""
    cells, _ = scenario_of(**key)
    rows: list[Row] = []
    whats: tuple[What, ...] = get_args(What) if len(cells) else ()
    for what in whats:
        one = ratio(outcome(cells, what, kept_times(cells)[-1]), cells["replicate"])
        low, high = one.interval()
        counts = {"count": one.count, "of": one.of, "effective": one.size, "runs": cells["replicate"].nunique()}
        rows.append({**key, "what": what, **counts, "value": one.value, "low": low, "high": high})
    return rows
