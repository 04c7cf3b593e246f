"""Chapter 4, section 4.7: the answers to the eight questions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from tissue.study.comparisons import CLAIM_LEVEL, Difference
from tissue.study.questions import QUESTIONS
from tissue.study.ratios import Ratio, as_ratio
from verification.claims import Correction, Effect, Tables, claim
from verification.evidence import Comparison, Evidence, Kind
from verification.thesis.chapter4.frequencies import (
    CATEGORIES,
    CONDITIONAL,
    category,
    hull,
    in_both,
    more,
    most_runs,
    needed,
    runs_for_bound,
    told,
)
from verification.thesis.chapter4.studies import PRESETS
from verification.thesis.chapter4.summaries import POPULATIONS

ANSWERS = "emt_complete_answers"
TRUTH = {"holds": 1.0, "does not hold": 0.0, "not decided": float("nan")}
# 'Get extruded': one cell in a hundred, at least. 'Favourable': the lower half of the scale, as in Figure 22.
SOME, FAVOURABLE = 0.01, 0.5
# Of (Q2) only the first half: the second one is a claim of its own.
PARTS = {"Q2": "Yes, without INM all cell events with [A], [B] or [P] lead to extrusion."}
STATED = {"Q2": "Without INM cells with [A], with [B] and with [P] are extruded, more often than cells without event."}
# Where both models say the same; the others are open.
RECORDED = {"Q2": Kind.HOLDS, "Q7": Kind.HOLDS}


def truths(verdicts: list[str]) -> Comparison:
    """What the models say, from 0, does not hold, to 1, holds: where they differ nothing is decided."""
    values = [TRUTH[verdict] for verdict in verdicts]
    interval = (float(np.min(values)), float(np.max(values)))
    return Comparison("the answer holds, by all models", float(np.mean(values)), 1.0, 1.0, interval)


def _answer(question: str) -> Callable[[Tables], Evidence]:
    """What the heterogeneous and the isolated studies say of an answer of section 4.7, by the published model, too."""

    def check(tables: Tables) -> Evidence:
        """The verdicts of both models on one question."""
        table = tables[ANSWERS]
        mine = table[table["id"] == question].set_index("preset")
        said = ", ".join(f"{preset} preset: {row['verdict']}" for preset, row in mine.iterrows())
        runs = mine["needed"].dropna() if "needed" in mine else []
        return Evidence(
            f"{said}; the numbers are in the chapter on EMT",
            printed=(truths(list(mine["verdict"])),),
            runs_needed=int(max(runs)) if len(runs) else None,
        )

    return check


ANSWERED = tuple(
    claim(
        f"c4.{name.lower()}",
        STATED.get(
            name, f"The answer to question {name[1:]}, by claims about ratios of basal extrusion with intervals."
        ),
        source=f"section 4.7, ({name})",
        quote=f"{question.text} {PARTS.get(name, question.thesis)}",
        needs=(ANSWERS,),
        recorded=RECORDED.get(name, Kind.OPEN),
        chosen="the claims that an answer is taken to make, in tissue/study/questions.py",
    )(_answer(name))
    for name, question in QUESTIONS.items()
)


def pooled(ratios: Sequence[Ratio]) -> Ratio:
    """The cells of several groups together."""
    return Ratio(sum(r.count for r in ratios), sum(r.of for r in ratios), sum(r.size for r in ratios))


def of_events(tables: Tables, suffix: str, *categories: str) -> Ratio:
    """Basal extrusion of cells with INM and these events in the three groups of Table 5."""
    return pooled([category(tables, f"{study}{suffix}", *categories) for study in POPULATIONS])


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
    alone = of_events(tables, suffix, "[B]")
    low, high = onsets(tables, suffix)
    share = low.of / (low.of + high.of)
    return Ratio(alone.count, round(share * alone.of), share * alone.size)


@claim(
    "c4.q2-inm",
    "Which cells with INM leave basally: those with [P], and well placed ones with [A] or with [B].",
    source="section 4.7, (Q2)",
    quote="If cells continue to perform INM, then only [P] or cells with [A] or [B] and favourable basal positioning "
    "get extruded.",
    needs=(CATEGORIES, CONDITIONAL),
    recorded=Kind.CORRECTED,
    correction=Correction(
        "[P], or [A], with or without [B], and favourable basal positioning: [B] alone with INM does not extrude, "
        "as Figure 19 says",
        Effect.CONCLUSION,
        "the second half of the answer to (Q2); in homogeneous groups of ten of the published runs [B] extrudes 0.3 % "
        "to 0.5 % of the cells",
    ),
    chosen=f"favourable: the lower half at the onset, in which cells with [B] are as often as those with [A];"
    f" get extruded: {SOME:.0%} of the cells, at least",
)
def _with_inm(tables: Tables) -> Evidence:
    p, a, b = (
        {name: of_events(tables, suffix, events) for name, suffix in PRESETS.items()}
        for events in ("[BP]", "[A]", "[B]")
    )
    low = {name: favourable(tables, suffix) for name, suffix in PRESETS.items()}
    by_onset = in_both(lambda suffix: Difference(*onsets(tables, suffix)))

    def leave(what: str, found: Mapping[str, Ratio], least: float, most: float) -> Comparison:
        return hull(what, [each.interval(CLAIM_LEVEL) for each in found.values()], least, most)

    others = (leave("basal extrusion by [BP]", p, SOME, math.inf), leave("by [A]", a, SOME, math.inf))
    return Evidence(
        f"With INM, in the groups of Table 5, model as printed and published one: [B] {_both(b)}, about "
        f"{' and '.join(str(each.of) for each in low.values())} from the lower half; [A] {_both(a)}; [BP] {_both(p)}; "
        f"without [P], lower minus upper half {told(by_onset)}.",
        printed=(*others, leave("by [B] from the lower half", low, SOME, math.inf)),
        corrected=(
            *others,
            leave("by [B] from the lower half", low, -math.inf, SOME),
            more("began in the lower minus in the upper half", by_onset),
        ),
        runs_needed=most_runs(
            (needed(by_onset), *(runs_for_bound(each.value, SOME) for both in (p, a, low) for each in both.values()))
        ),
    )


def _both(found: Mapping[str, Ratio]) -> str:
    return " and ".join(f"{100 * each.value:.1f} % of {each.of}" for each in found.values())
