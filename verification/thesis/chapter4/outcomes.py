"""What becomes of the cells: ratios at the end by program (Tables 1 to 5 of chapter 4), isolated cells in time."""

from __future__ import annotations

from typing import get_args

from dincl.study import Key, Row, Study
from tissue.study.categories import What, in_time, kept_times, outcome
from tissue.study.outcomes import CONTROLS
from verification.thesis.chapter4.ensembles import ISOLATED, NAMES, PRESETS, ensemble, scenario_of
from verification.thesis.chapter4.ratios import outcome_published, ratio

SMALLEST = {"study": "figure14", "scenario": "[AB]"}
COLUMNS_AT_THE_END = {
    "study": "Study",
    "scenario": "Scenario",
    "what": "Outcome",
    "value": "Ratio",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
    "effective": "Effective cells",
    "runs": "Runs",
}


def at_the_end(smallest: bool = False) -> Study:
    """Count the outcomes at the end of the runs; the groups of Table 5 have up to 50,000 runs, an hour of two cores."""
    keys = sorted(
        ({"study": name, "scenario": scenario} for name in NAMES for scenario in ensemble(name).scenarios),
        key=lambda key: -ensemble(key["study"]).replicates,
    )
    runs = (SMALLEST,) if smallest else tuple(keys)
    return Study(
        "emt_ratios",
        "EMT: ratios at the end by program",
        ("study", "scenario"),
        runs,
        ratios,
        columns=COLUMNS_AT_THE_END,
        by=("what",),
    )


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


# What becomes of isolated cells in time: Figures 10, 12 and 14 of chapter 4, made in full in two minutes.
# With corrected energies those of Figure 14 alone, which a claim reads.
STUDIES = [name + PRESETS[preset] for preset in ("thesis", "published") for name in ISOLATED] + ["figure14_corrected"]
# Outcomes beside "basal", "apical" and "below": basal extrusion by the published rule, which looks ahead in time; and
# apical extrusion among all control cells.
LOOKS_AHEAD, CONTROL = "basal, published rule", "control cells, apical"
COLUMNS_IN_HOURS = {
    "study": "Study",
    "scenario": "Scenario",
    "time_h": "Time [h]",
    "what": "Outcome",
    "count": "Cells with it",
    "of": "Cells",
    "a_h": "Time of [A] [h]",
}


def in_hours(smallest: bool = False) -> Study:
    """Count the cells with each outcome at each hour; 400 runs of each scenario, one EMT cell in each."""
    keys = ({"study": name, "scenario": scenario} for name in STUDIES for scenario in ensemble(name).scenarios)
    runs = (SMALLEST,) if smallest else tuple(keys)
    return Study(
        "emt_in_time",
        "EMT: isolated cells in time",
        ("study", "scenario"),
        runs,
        counts,
        columns=COLUMNS_IN_HOURS,
        by=("time_h", "what"),
    )


def counts(key: Key) -> list[Row]:
    """Return a row for each time and outcome."""
    cells, runs = scenario_of(**key)
    a_h = float(cells["t_a_h"].iloc[0])  # the same for all cells, or infinite
    found = in_time(cells)
    rows: list[Row] = []
    for k, t in enumerate(kept_times(cells)):
        hits: dict[str, tuple[int, int]] = {what: (int(of[k].sum()), len(cells)) for what, of in found.items()}
        hits[LOOKS_AHEAD] = int(outcome_published(cells, "basal", t).sum()), len(cells)
        every, apical, _ = (int(runs[f"{name}_{t:g}h"].sum()) for name in CONTROLS)
        hits[CONTROL] = apical, every
        rows += [{**key, "time_h": t, "what": what, "count": n, "of": m, "a_h": a_h} for what, (n, m) in hits.items()]
    return rows
