"""What becomes of isolated cells in time: Figures 10, 12 and 14 of chapter 4, made in full in two minutes."""

from __future__ import annotations

from dincl.study import Key, Row, Study
from tissue.study.categories import in_time, kept_times
from tissue.study.outcomes import CONTROLS
from verification.thesis.chapter4.categories import outcome_published
from verification.thesis.chapter4.ensembles import ISOLATED, PRESETS, ensemble, scenario_of

TITLE = "EMT: isolated cells in time"
# With corrected energies those of Figure 14 alone, which a claim reads.
STUDIES = [name + PRESETS[preset] for preset in ("thesis", "published") for name in ISOLATED] + ["figure14_corrected"]
SMALLEST = {"study": "figure14", "scenario": "[AB]"}
# Outcomes beside "basal", "apical" and "below": basal extrusion by the published rule, which looks ahead in time; and
# apical extrusion among all control cells.
LOOKS_AHEAD, CONTROL = "basal, published rule", "control cells, apical"
COLUMNS = {
    "study": "Study",
    "scenario": "Scenario",
    "time_h": "Time [h]",
    "what": "Outcome",
    "count": "Cells with it",
    "of": "Cells",
    "a_h": "Time of [A] [h]",
}


def study(smallest: bool = False) -> Study:
    """Count the cells with each outcome at each hour; 400 runs of each scenario, one EMT cell in each."""
    keys = ({"study": name, "scenario": scenario} for name in STUDIES for scenario in ensemble(name).scenarios)
    runs = (SMALLEST,) if smallest else tuple(keys)
    return Study("emt_in_time", TITLE, ("study", "scenario"), runs, counts, columns=COLUMNS, by=("time_h", "what"))


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
