"""Chapter 4, sections 4.5.3 and 4.6: basal extrusion by event times and by the position at the onset."""

from __future__ import annotations

import math
from functools import partial

import pandas as pd

from tissue.statistics.comparisons import Difference
from tissue.statistics.proportions import LEVEL
from tissue.statistics.ratios import Ratio, as_ratio
from verification.claims import Evidence, Interval, Tables, Verdict
from verification.thesis.chapter4.frequencies import (
    BESIDE,
    CONDITIONAL,
    DECIDES,
    alike,
    hull,
    in_models,
    more,
    most_runs,
    needed,
    runs_by_width,
    runs_for_bound,
    runs_for_margin,
    shares,
)
from verification.thesis.chapter4.ratio_claims import ALIKE, CLAIM_LEVEL
from verification.thesis.chapter4.studies import PRESETS
from verification.thesis.chapter4.summaries import POPULATIONS
from verification.thesis.text.quoted import claim

RANKING = "emt_complete_ranking"
# The middle row of Table 5, whose cells Figure 22 shows.
MIDDLE = "table5_35"
KINDS = ("INM", "no INM")
# Section 4.6: the rates in the most basal fifth.
LEAST, MOST = 0.7, 0.8
# Fewer cells of an interval tell nothing.
FEWEST = 100


def rows(tables: Tables, study: str, given: str, inm: str) -> pd.DataFrame:
    """Basal extrusion by intervals of an event time, or of the position at the onset."""
    table = tables[CONDITIONAL]
    chosen = table[(table["study"] == study) & (table["given"] == given) & (table["inm"] == inm)]
    return chosen[chosen["of"] >= FEWEST].sort_values("low_edge")


def first_minus_last(tables: Tables, suffix: str, given: str, inm: str) -> Difference:
    """Between the first and the last interval."""
    found = rows(tables, f"{MIDDLE}{suffix}", given, inm)
    return Difference(as_ratio(found.iloc[0]), as_ratio(found.iloc[-1]))


def by_kind(tables: Tables, given: str) -> list[dict[str, Difference]]:
    """The same for cells with INM and for those without it, by model."""
    return [in_models(partial(first_minus_last, tables, given=given, inm=inm)) for inm in KINDS]


@claim(
    "c4.timing",
    "In a mixed group early [A] extrudes more cells than late [A]; early and late [B] are alike, "
    "and so are early and late [P].",
    "section 4.5.3, Figure 20",
    Verdict.OPEN,
    needs=(CONDITIONAL,),
    chosen=f"the group '35 % [P]'; independent: alike within {ALIKE:.0%}, on which the verdict for [B] depends",
)
def _timing(tables: Tables) -> Evidence:
    a, b, p = (by_kind(tables, f"t_{event}_h") for event in "abp")
    within = [runs_for_margin(each[DECIDES], ALIKE) for kinds in (b, p) for each in kinds]
    most = max(abs(end) for kinds in (b, p) for each in kinds for end in each[DECIDES].interval(CLAIM_LEVEL))
    return Evidence(
        "Basal extrusion of cells with an event at 6 h to 9 h minus at 21 h to 24 h, with and without INM: "
        f"[A] {_points(a)}; [B] {_points(b)}; [P] {_points(p)}. Alike for margins above {100 * most:.1f} points.",
        printed=(
            more("early minus late [A]", *a),
            alike("early [B]", *b, margin=ALIKE),
            alike("early [P]", *p, margin=ALIKE),
        ),
        runs_needed=most_runs((needed(*a), *within)),
    )


def _points(found: list[dict[str, Difference]]) -> str:
    """Of the model that decides, then of the others; of each with and without INM."""
    models = {DECIDES: ""} | BESIDE
    lines = {name: ", ".join(f"{100 * each[preset].value:+.1f}" for each in found) for preset, name in models.items()}
    return f"{lines.pop('')} points ({'; '.join(f'{name} {line}' for name, line in lines.items())})"


def lead(first: Interval, second: Interval) -> Interval:
    """The first number minus the second."""
    return first[0] - second[1], first[1] - second[0]


@claim(
    "c4.onset-over-timing",
    "Basal extrusion of cells without [P] depends more on where than on when EMT begins.",
    "section 4.6, Figures 20, 21",
    needs=(CONDITIONAL,),
    chosen="the group '35 % [P]'",
)
def _onset(tables: Tables) -> Evidence:
    """How much the first interval differs from the last, by the position and by the time of [A] or [B]."""
    onset, *times = (by_kind(tables, given) for given in ("onset_ab", "t_a_h", "t_b_h"))
    pairs = [
        (each[DECIDES], max((time[k][DECIDES] for time in times), key=lambda fall: fall.interval(CLAIM_LEVEL)[1]))
        for k, each in enumerate(onset)
    ]
    leads = [lead(each.interval(CLAIM_LEVEL), time.interval(CLAIM_LEVEL)) for each, time in pairs]
    fewest = [min(side.size for found in pair for side in (found.first, found.second)) for pair in pairs]
    return Evidence(
        "From the lowest to the highest position at the onset basal extrusion falls by "
        f"{_points(onset)} with and without INM; from early to late [A] by {_points(times[0])}, [B] by "
        f"{_points(times[1])}.",
        printed=(hull("fall by position minus fall by time", leads, 0.0, math.inf),),
        runs_needed=most_runs(runs_by_width(*found, CLAIM_LEVEL) for found in zip(fewest, leads, strict=True)),
    )


@claim(
    "c4.predictor",
    "Beside protrusions nothing tells more about basal extrusion than the position at the onset.",
    "section 4.6",
    needs=(RANKING,),
    chosen="the group '35 % [P]', all cells; what a factor tells: the loss of a classifier without it",
)
def _predictor(tables: Tables) -> Evidence:
    """By permutation importance in the group '35 % [P]'."""
    table, lines, leads = tables[RANKING], {}, {}
    for preset in PRESETS:
        found = table[(table["preset"] == preset) & (table["factor"] != "P")].set_index("factor")
        onset, others = found.loc["onset"], found.drop(index="onset").sort_values("value")
        leads[preset] = lead((onset["low"], onset["high"]), (others["low"].max(), others["high"].max()))
        lines[preset] = f"{onset['value']:.3f} nats against {others['value'].iloc[-1]:.3f} of {others.index[-1]}"
    beside = "; ".join(f"{name} {lines[preset]}" for preset, name in BESIDE.items())
    return Evidence(
        "The position at the onset has the greatest importance for basal extrusion beside [P]: "
        f"{lines[DECIDES]} ({beside}).",
        printed=(
            hull("importance of the onset minus that of the next factor [nats]", [leads[DECIDES]], 0.0, math.inf),
        ),
        runs_needed=runs_by_width(table.loc[table["preset"] == DECIDES, "cells"].max(), leads[DECIDES], LEVEL),
    )


@claim(
    "c4.most-basal",
    "Seven or eight of ten cells without [P] that begin EMT in the lowest fifth leave basally.",
    "section 4.6, Figure 21",
    Verdict.OPEN,
    needs=(CONDITIONAL,),
)
def _most_basal(tables: Tables) -> Evidence:
    """Figure 21 does not say of which group and of which cells it is: all are taken."""
    found = [
        as_ratio(row)
        for study in POPULATIONS
        for inm in KINDS
        for _, row in rows(tables, f"{study}{PRESETS[DECIDES]}", "onset_ab", inm).iterrows()
        if row["high_edge"] <= 0.2 + 1e-9
    ]
    intervals = [each.interval(CLAIM_LEVEL) for each in found]
    values = [each.value for each in found]
    return Evidence(
        f"In the two lowest tenths {100 * min(values):.0f} % to {100 * max(values):.0f} % leave basally, by the group "
        "of Table 5, with or without INM; the text does not say of which.",
        printed=(hull("basal extrusion in the most basal fifth", intervals, LEAST, MOST),),
    )


@claim(
    "c4.lower-half",
    "More than half of the basally extruded cells without INM began EMT at a position below 1/2.",
    "Figure 22",
    needs=(CONDITIONAL,),
    chosen="cells without [P], as the figure shows",
)
def _lower_half(tables: Tables) -> Evidence:

    def lower(suffix: str) -> Ratio:
        table = rows(tables, f"{MIDDLE}{suffix}", "onset_ab", "no INM")
        return Ratio(int(table[table["high_edge"] <= 0.5 + 1e-9]["count"].sum()), int(table["count"].sum()))

    found = in_models(lower)
    return Evidence(
        f"Of the basally extruded cells without [P] and INM began EMT in the lower half: {shares(found)}.",
        printed=(hull("from the lower half", [found[DECIDES].interval(CLAIM_LEVEL)], 0.5, math.inf),),
        runs_needed=runs_for_bound(found[DECIDES].value, 0.5),
    )
