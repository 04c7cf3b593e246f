"""The tables of the chapter on EMT: ratios of all scenarios, conditional ratios, controls, orders, rankings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import get_args

import numpy as np
import pandas as pd

from tissue.statistics.categories import NO_INM, What, by_order, happened, kept_times, outcome
from tissue.statistics.ranking import by_importance
from tissue.statistics.ratios import given, ratio, ratios
from tissue.study.read import Results
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.chapter4 import open_programs
from verification.thesis.chapter4.studies import FURTHER, PRESETS

POPULATIONS = ("table5_63", "table5_35", "table5_7")
RANKED = "table5_35"
# Of the position at the onset (Figure 21), and of the event times [h] (Figure 20).
ONSETS, TIMES = tuple(np.arange(11) / 10), tuple(range(6, 25, 3))
SEED = 0
# Of each heterogeneous study, for tables that need no more: 20,000 cells.
FIRST_RUNS = 2000
SINCE_A = 24.0  # [h]
COLUMNS = ["count", "of", "effective", "runs", "value", "low", "high"]


def scenario_ratios(results: Mapping[str, Results]) -> pd.DataFrame:
    """Each outcome at the end of the runs, one row for each study, scenario and outcome, with 95 % intervals."""
    rows = []
    for study, found in _named(results):
        for scenario in found.study.scenarios:
            cells = found.cells(scenario)
            for what in get_args(What):
                hits = outcome(cells, what, kept_times(cells)[-1])
                one = ratio(hits, cells["replicate"])
                low, high = one.interval()
                counts = {"count": one.count, "of": one.of, "effective": one.size, "runs": cells["replicate"].nunique()}
                value = {"value": one.value, "low": low, "high": high}
                rows.append({"study": study, "scenario": scenario, "what": what} | counts | value)
    return pd.DataFrame(rows)


def since_a(results: Mapping[str, Results]) -> pd.DataFrame:
    """Basal extrusion so many hours after [A] by the programs of Figure 14, by the rule of the thesis.

    The right of Figure 14 counts from [A] on; 24 h after it the runs of the program with the latest [A] end.
    """
    rows = []
    for study, found in results.items():
        for scenario in found.study.scenarios if study.startswith("figure14") else ():
            cells = found.cells(scenario)
            # The last kept time until then: in the studies themselves each hour is kept.
            t = max(time for time in kept_times(cells) if time <= cells["t_a_h"].iloc[0] + SINCE_A)
            one = ratio(outcome(cells, "basal", t), cells["replicate"])
            numbers = (one.count, one.of, one.size, cells["replicate"].nunique(), one.value, *one.interval())
            rows.append({"study": study, "scenario": scenario} | dict(zip(COLUMNS, numbers, strict=True)))
    return pd.DataFrame(rows, columns=["study", "scenario", *COLUMNS])


def category_ratios(results: Mapping[str, Results]) -> pd.DataFrame:
    """Basal extrusion in the heterogeneous groups by the events of a cell in their order, with and without INM."""
    parts = []
    for study, scenario, cells, end in _populations(results):
        table = ratios(outcome(cells, "basal", end), cells["replicate"], by_order(cells, end, inm=True))
        parts.append(table.rename_axis("category").reset_index().assign(study=study, scenario=scenario))
    return pd.concat(parts, ignore_index=True)[["study", "scenario", "category", *COLUMNS]]


def conditional(results: Mapping[str, Results]) -> pd.DataFrame:
    """Basal extrusion by the position at the onset, without [P] (Figure 21), and by event times (Figure 20)."""
    parts = []
    for study, _, cells, end in _populations(results):
        basal = outcome(cells, "basal", end)
        passive = ~happened(cells, end)["P"]
        for inm, text in ((True, "INM"), (False, "no INM")):
            for column, edges, among in (
                ("onset_ab", ONSETS, passive),
                ("t_a_h", TIMES, passive),
                ("t_b_h", TIMES, passive),
                ("t_p_h", TIMES, ~passive),
            ):
                kind = among & (cells["inm"] == inm)
                table = given(basal[kind], cells["replicate"][kind], cells[column][kind], edges)
                parts.append(table.assign(study=study, given=column, inm=text))
    names = ["study", "given", "inm", "low_edge", "high_edge", "middle", *COLUMNS]
    return pd.concat(parts, ignore_index=True)[names]


def outside(results: Mapping[str, Results]) -> pd.DataFrame:
    """How many cells of the heterogeneous groups of each preset begin EMT outside of 0 < y_AB <= 1."""
    rows = []
    for preset, suffix in PRESETS.items():
        found = [cells["onset_ab"] for *_, cells, _ in _populations(results, [name + suffix for name in POPULATIONS])]
        if found:
            onsets = pd.concat(found).dropna()
            beyond = int((~onsets.between(0, 1, inclusive="right")).sum())
            rows.append({"preset": preset, "outside": beyond, "of": len(onsets)})
    return pd.DataFrame(rows)


def controls(results: Mapping[str, Results]) -> pd.DataFrame:
    """Control cells with y_AB > 1 and < 0 at the end, means over runs with 95 % intervals, for each study."""
    rows = []
    for study, found in _named(results):
        if study in open_programs.MORE:
            continue
        runs = pd.concat([found.runs(scenario) for scenario in found.study.scenarios])
        end = found.parameters(found.study.scenarios[0]).t_end
        sound = runs[runs["status"] == "SUCCESS"]
        row = {"study": study, "runs": len(runs), "failed": len(runs) - len(sound)}
        for side in ("apical", "basal"):
            share = sound[f"controls_{side}_{end:g}h"] / sound[f"controls_{end:g}h"]
            mean, low, high = over_seeds(share)
            row |= {side: mean, f"{side}_low": low, f"{side}_high": high}
        rows.append(row)
    return pd.DataFrame(rows)


def orders(results: Mapping[str, Results]) -> pd.DataFrame:
    """Basal extrusion of cells with [A] and [B], without [P], by their order and the time of [A], for (Q4)."""
    parts = []
    for study, _, every, end in _populations(results):
        cells = every[every["replicate"] < FIRST_RUNS]
        order, basal = by_order(cells, end, inm=True), outcome(cells, "basal", end)
        for inm, ending in (("INM", ""), ("no INM", NO_INM)):
            for name in ("[AB]", "[BA]"):
                kind = order == f"{name}{ending}"
                if kind.any():
                    table = given(basal[kind], cells["replicate"][kind], cells["t_a_h"][kind], TIMES)
                    parts.append(table.assign(study=study, order=name, inm=inm))
    return pd.concat(parts, ignore_index=True)[["study", "order", "inm", "low_edge", "high_edge", *COLUMNS]]


def ranking(results: Mapping[str, Results]) -> pd.DataFrame:
    """Permutation importance of each factor for basal extrusion in a heterogeneous group, for each preset."""
    parts = []
    for preset, suffix in PRESETS.items():
        for _, _, cells, end in _populations(results, (RANKED + suffix,)):
            found = by_importance(cells, outcome(cells, "basal", end), end, seed=SEED)
            numbers = {"cells": found.cells, "loss": found.loss, "without": found.without}
            parts.append(found.table.assign(preset=preset, **numbers))
    return pd.concat(parts, ignore_index=True)


def _named(results: Mapping[str, Results]) -> Iterator[tuple[str, Results]]:
    """The studies of the tables of the thesis."""
    return ((name, found) for name, found in results.items() if name not in FURTHER)


def _populations(
    results: Mapping[str, Results], names: Sequence[str] | None = None
) -> Iterator[tuple[str, str, pd.DataFrame, float]]:
    """Study, scenario, cells and end of the heterogeneous studies that are there."""
    for name in names or [name + suffix for suffix in PRESETS.values() for name in POPULATIONS]:
        if name in results:
            (scenario,) = results[name].study.scenarios
            cells = results[name].cells(scenario)
            yield name, scenario, cells, kept_times(cells)[-1]
