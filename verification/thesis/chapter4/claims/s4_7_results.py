"""Chapter 4, section 4.7: the answers to the eight questions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import pandas as pd

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio, as_ratio
from verification.claims import Comparison, Evidence, Tables, Verdict
from verification.thesis.chapter4.frequencies import (
    CATEGORIES,
    CONDITIONAL,
    DECIDES,
    category,
    hull,
    in_models,
    more,
    most_runs,
    needed,
    runs_for_bound,
    shares,
    told,
)
from verification.thesis.chapter4.questions import QUESTIONS
from verification.thesis.chapter4.ratio_claims import CLAIM_LEVEL
from verification.thesis.chapter4.summaries import POPULATIONS
from verification.thesis.text.quoted import claim

ANSWERS = "emt_complete_answers"
TRUTH = {"holds": 1.0, "does not hold": 0.0, "not decided": float("nan")}
# 'Get extruded': one cell in a hundred, at least. 'Favourable': the lower half of the scale, as in Figure 22.
SOME, FAVOURABLE = 0.01, 0.5
# Of (Q2) only the first half: the second one is a claim of its own.
PARTS = {"Q2": "Yes, without INM all cell events with [A], [B] or [P] lead to extrusion."}
STATED = {
    "Q2": "Without INM cells with [A], with [B] and with [P] are extruded, more often than cells without event.",
    "Q5": "The answer to question 5, both halves together, by claims about ratios. The second half: c4.q5-mixed.",
}
# What the model says that decides; the others are open.
RECORDED = dict.fromkeys(("Q1", "Q2", "Q7"), Verdict.HOLDS)


def truth(verdict: str) -> Comparison:
    """What the model says that decides: 0, does not hold, or 1, holds; else nothing."""
    return Comparison("the answer holds", TRUTH[verdict], 1.0, 1.0)


def _answer(question: str) -> Callable[[Tables], Evidence]:
    """What the heterogeneous and the isolated studies say of an answer of section 4.7."""

    def check(tables: Tables) -> Evidence:
        """The verdicts of the models on one question."""
        table = tables[ANSWERS]
        mine = table[table["id"] == question].set_index("preset")
        said = ", ".join(f"{preset} preset: {row['verdict']}" for preset, row in mine.iterrows())
        deciding = mine.loc[DECIDES]
        return Evidence(
            f"{said}; the numbers are in the chapter on EMT",
            printed=(truth(deciding["verdict"]),),
            runs_needed=None if pd.isna(deciding["needed"]) else int(deciding["needed"]),
        )

    return check


ANSWERED = tuple(
    claim(
        f"c4.{name.lower()}",
        STATED.get(
            name, f"The answer to question {name[1:]}, by claims about ratios of basal extrusion with intervals."
        ),
        f"section 4.7, ({name})",
        RECORDED.get(name, Verdict.OPEN),
        needs=(ANSWERS,),
        chosen="the claims that an answer is taken to make, in tissue/study/questions.py",
    )(_answer(name))
    for name, question in QUESTIONS.items()
)


def pooled(ratios: Sequence[Ratio]) -> Ratio:
    """The cells of several groups together."""
    return Ratio(sum(r.count for r in ratios), sum(r.of for r in ratios), sum(r.size for r in ratios))


def of_kind(tables: Tables, suffix: str, events: str) -> Ratio:
    """Basal extrusion of cells with INM and these events in the three groups of Table 5."""
    return pooled([category(tables, f"{study}{suffix}", events) for study in POPULATIONS])


def onsets(tables: Tables, suffix: str) -> tuple[Ratio, Ratio]:
    """Of cells with INM and without [P], those that began EMT in the lower half, and the others, of these groups."""
    table = tables[CONDITIONAL]
    studies = [f"{study}{suffix}" for study in POPULATIONS]
    rows = table[table["study"].isin(studies) & (table["given"] == "onset_ab") & (table["inm"] == "INM")]
    low = rows["high_edge"] <= FAVOURABLE + 1e-9
    lower, upper = (pooled([as_ratio(row) for _, row in rows[side].iterrows()]) for side in (low, ~low))
    return lower, upper


def favourable(tables: Tables, suffix: str) -> Ratio:
    """Cells with [B] alone that began in the lower half: all that left, of their expected number."""
    alone = of_kind(tables, suffix, "[B]")
    low, high = onsets(tables, suffix)
    share = low.of / (low.of + high.of)
    return Ratio(alone.count, round(share * alone.of), share * alone.size)


@claim(
    "c4.q2-inm",
    "Which cells with INM leave basally: those with [P], and well placed ones with [A] or with [B].",
    "section 4.7, (Q2)",
    Verdict.CORRECTED,
    needs=(CATEGORIES, CONDITIONAL),
    chosen=f"favourable: the lower half at the onset, in which cells with [B] are as often as those with [A];"
    f" get extruded: {SOME:.0%} of the cells, at least; each limit between [B] and [A] decides alike",
)
def _with_inm(tables: Tables) -> Evidence:
    p, a, b = (in_models(partial(of_kind, tables, events=events)) for events in ("[BP]", "[A]", "[B]"))
    low = in_models(partial(favourable, tables))
    by_onset = in_models(lambda suffix: Difference(*onsets(tables, suffix)))

    def leave(what: str, found: Mapping[str, Ratio], least: float, most: float) -> Comparison:
        return hull(what, [found[DECIDES].interval(CLAIM_LEVEL)], least, most)

    others = (leave("basal extrusion by [BP]", p, SOME, math.inf), leave("by [A]", a, SOME, math.inf))
    return Evidence(
        f"With INM, in the groups of Table 5: [B] {shares(b)}, {low[DECIDES].of} of them from the lower half; "
        f"[A] {a[DECIDES]}; [BP] {p[DECIDES]}; without [P], lower minus upper half {told(by_onset)}.",
        printed=(*others, leave("by [B] from the lower half", low, SOME, math.inf)),
        corrected=(
            *others,
            leave("by [B] from the lower half", low, -math.inf, SOME),
            more("began in the lower minus in the upper half", by_onset),
        ),
        runs_needed=most_runs((needed(by_onset), *(runs_for_bound(each[DECIDES].value, SOME) for each in (p, a, low)))),
    )
