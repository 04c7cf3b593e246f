"""Chapter 4, section 4.7: the answers to the eight questions."""

from __future__ import annotations

from collections.abc import Callable

from verification.claims import Correction, Effect, Evidence, Tables, claim
from verification.thesis.chapter4.ensembles import POPULATIONS
from verification.thesis.chapter4.frequencies import (
    GROUPS,
    RANKING,
    RATIOS,
    between,
    category,
    evidence,
    in_readings,
    minus,
    more,
    pooled,
    share,
)
from verification.thesis.chapter4.questions import answer
from verification.thesis.chapter4.ratios import Ratio

# 'Get extruded': one cell in a hundred, at least. 'Favourable': the lower half of the scale, as in Figure 22.
SOME, FAVOURABLE = 0.01, 0.5
MOST = "of the comparisons in verification/thesis/chapter4/questions.py more than half have to hold"
ALL = "all comparisons in verification/thesis/chapter4/questions.py have to hold"
# By question: the statement, what it reads, and what is chosen. The second halves of (Q2) and (Q5) are claims of their
# own, c4.q2-inm and c4.q5-mixed.
STATED = {
    "Q1": (
        "Are groups of EMT cells more efficient than isolated ones? No, in most cases heterogeneous groups are less "
        "efficient than individual cells.",
        "Cells with the same events leave basally more often alone than in a mixed group.",
        (RATIOS, GROUPS),
        MOST,
    ),
    "Q2": (
        "Is basal extrusion possible without all EMT events, and which have to occur? Yes, without INM all cell events"
        " with [A], [B] or [P] lead to extrusion.",
        "Without INM cells with [A], with [B] and with [P] are extruded, more often than cells without event.",
        (GROUPS,),
        ALL,
    ),
    "Q3": (
        "Are early EMT events more efficient? Mostly no. Only early [A] shows some increase.",
        "Early [A] extrudes more cells than late [A]; early and late [B] are alike, and so are early and late [P].",
        (GROUPS,),
        f"{MOST}: the answer says mostly",
    ),
    "Q4": (
        "Do specific orders of EMT events lead to more basal extrusion? The order can lead to small differences, which"
        " are better explained by the absolute timing of one event.",
        "With [A] at the same time [AB] and [BA] extrude alike; the order matters more where the times differ.",
        (GROUPS,),
        f"{ALL}; the same time: the same interval of 3 h; 2,000 runs of each group",
    ),
    "Q5": (
        "Is it an advantage if all cells of a group have the same timings, or is a mixture better? Individual cells "
        "are more effective than groups; for most programs mixed groups beat homogeneous ones.",
        "Cells leave basally more often alone than in a group of cells with the same events at the same times.",
        (RATIOS,),
        f"{MOST}, without pairs of which all cells leave, or none",
    ),
    "Q6": (
        "Are EMT cells without INM more effective? Yes: lack of INM increases basal extrusion for EMT programs "
        "involving [B].",
        "Each program with [B] and without [P] extrudes more cells without INM than with INM.",
        (RATIOS,),
        ALL,
    ),
    "Q7": (
        "Does the position of an EMT cell at the start of EMT impact the outcome? Very much so; for cells without [P] "
        "it is more important than the timing and selection of events.",
        "Of cells without [P] those in the most basal fifth leave basally more often, and the position at the onset "
        "tells more than the events and their times.",
        (GROUPS, RANKING),
        f"{ALL}; what a factor tells: the loss of a classifier without it",
    ),
    "Q8": (
        "Do cells with very effective EMT programs decrease the efficiency of non-effective programs? Yes, a bit.",
        "The more cells of a group have [P], the fewer of the others leave basally, with INM and without on average.",
        (GROUPS,),
        "the mean of cells with [A], [B] and both, with INM and without, in '7 % [P]' and in '63 % [P]'",
    ),
}


def _answer(question: str) -> Callable[[Tables], Evidence]:
    """Return the check of an answer of section 4.7."""

    def check(tables: Tables) -> Evidence:
        return in_readings(lambda preset: answer(tables, question, preset).evidence)

    return check


# Claims that the answers use.
RESTS_ON = {"Q4": ("c4.timing",), "Q6": ("c4.without-inm",), "Q7": ("c4.predictor",), "Q8": ("c4.competition",)}
ANSWERED = tuple(
    claim(
        f"c4.{name.lower()}",
        statement,
        source=f"section 4.7, ({name})",
        quote=quote,
        needs=needs,
        rests_on=RESTS_ON.get(name, ()),
        chosen=chosen,
    )(_answer(name))
    for name, (quote, statement, needs, chosen) in STATED.items()
)


def of_kind(tables: Tables, preset: str, events: str) -> Ratio:
    """Return basal extrusion of cells with INM and these events in the three groups of Table 5."""
    return pooled([category(tables, preset, study, events) for study in POPULATIONS])


def onsets(tables: Tables, preset: str) -> tuple[Ratio, Ratio]:
    """Return basal extrusion of cells with INM and without [P] that began EMT in the lower half, and of the others."""
    halves = ((0.0, FAVOURABLE), (FAVOURABLE, 1.0))
    lower, upper = (
        pooled([between(tables, preset, study, "onset_ab", "INM", *half) for study in POPULATIONS]) for half in halves
    )
    return lower, upper


def favourable(tables: Tables, preset: str) -> Ratio:
    """Return basal extrusion of cells with [B] alone that began in the lower half: all that left, of their number."""
    alone = of_kind(tables, preset, "[B]")
    low, high = onsets(tables, preset)
    part = low.of / (low.of + high.of)
    of = round(part * alone.of)
    return Ratio(alone.count, of, min(part * alone.size, of))


@claim(
    "c4.q2-inm",
    "Cells with INM leave basally if they have [P], or [A] or [B] and a favourable place.",
    source="section 4.7, (Q2)",
    quote=(
        "If cells continue to perform INM, then only [P] or cells with [A] or [B] and favourable basal positioning get"
        " extruded."
    ),
    correction=Correction(
        (
            "[P], or [A], with or without [B], and favourable basal positioning: [B] alone with INM does not extrude, "
            "as Figure 19 says"
        ),
        Effect.CONCLUSION,
        (
            "the second half of the answer to (Q2); in homogeneous groups of ten of the published runs [B] extrudes "
            "0.3 % to 0.5 % of the cells"
        ),
        why="of cells with INM and [B] alone fewer than one in a hundred leave basally, wherever EMT begins",
        place=2990,
    ),
    needs=(GROUPS,),
    rests_on=("c4.q2",),
    chosen=f"favourable: the lower half at the onset, in which cells with [B] are as often as those with [A];"
    f" get extruded: {SOME:.0%} of the cells, at least; each limit between [B] and [A] decides alike",
)
def _with_inm(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        others = [share(f"basal extrusion by {e}", of_kind(tables, preset, e), SOME) for e in ("[BP]", "[A]")]
        low, by_b = favourable(tables, preset), "basal extrusion by [B] from the lower half"
        by_onset = minus(onsets(tables, preset))
        return evidence(
            [*others, share(by_b, low, SOME)],
            [
                *others,
                share(by_b, low, high=SOME),
                more("basal extrusion without [P], began in the lower minus in the upper half", by_onset),
            ],
        )

    return in_readings(compare)
