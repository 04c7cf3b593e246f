"""Chapter 4, sections 4.5.3, 4.6 and 4.7: basal extrusion by times and positions, answers to the eight questions."""

from __future__ import annotations

import math
from collections.abc import Callable

from verification.claims import Correction, Effect, Evidence, Tables, Verdict
from verification.thesis.chapter4.ensembles import POPULATIONS, PRESETS
from verification.thesis.chapter4.frequencies import (
    ALIKE,
    CLAIM_LEVEL,
    GROUPS,
    KINDS,
    RANKING,
    RATIOS,
    Sized,
    alike,
    apart,
    between,
    bins,
    category,
    cells_of,
    claim_in_readings,
    evidence,
    minus,
    more,
    pooled,
    share,
)
from verification.thesis.chapter4.questions import answer, onset_first
from verification.thesis.chapter4.ratios import ProportionContrast, Ratio, as_ratio

# The middle row of Table 5, whose cells Figure 22 shows.
MIDDLE = "table5_35"
FEWEST = 100  # cells of an interval; fewer tell nothing
# Section 4.6: the rates in the most basal fifth of the tissue.
STUDY, FIFTH, LEAST, MOST = "table5_7", 0.2, 0.7, 0.8


def first_minus_last(tables: Tables, preset: str, given: str, inm: str) -> ProportionContrast:
    """Return the difference between the first and the last interval."""
    found = bins(tables, preset, MIDDLE, given, inm)
    found = found[found["of"] >= FEWEST]
    return minus(as_ratio(found.iloc[place]) for place in (0, -1))


def early_minus_late(tables: Tables, preset: str, event: str) -> list[tuple[str, ProportionContrast]]:
    """Return the difference between 6 h to 9 h and 21 h to 24 h, of cells with INM and of those without."""
    return [
        (
            f"basal extrusion, [{event}] at 6 h to 9 h minus at 21 h to 24 h, {inm}",
            first_minus_last(tables, preset, given, inm),
        )
        for given in (f"t_{event.lower()}_h",)
        for inm in KINDS
    ]


@claim_in_readings(
    "c4.timing",
    (
        "In a mixed group early [A] extrudes more cells than late [A]; early and late [B] are alike, and so are early "
        "and late [P]."
    ),
    source="section 4.5.3, Figure 20; introduction, Part II",
    also=("c0.timing",),
    quote=(
        "the basal extrusion ratios are independent of the timing of [B] and [P] … there is some trend concerning [A],"
        " preferring earlier timings"
    ),
    needs=(GROUPS,),
    chosen=f"the group '35 % [P]', [A] and [B] of cells without [P]; alike: within {ALIKE:.0%} of the cells",
)
def _timing(tables: Tables, preset: str) -> list[Sized]:
    found = {event: early_minus_late(tables, preset, event) for event in "ABP"}
    return [more(*each) for each in found["A"]] + [alike(*each) for event in "BP" for each in found[event]]


@claim_in_readings(
    "c4.onset-over-timing",
    "Basal extrusion of cells without [P] depends more on where than on when EMT begins.",
    source="section 4.6, Figures 20, 21",
    quote="Comparing Figure 21 and Figure 20 … basal positioning has more impact on basal extrusion than the timing",
    needs=(GROUPS,),
    chosen="the group '35 % [P]'",
)
def _onset(tables: Tables, preset: str) -> list[Sized]:
    """How much the first interval differs from the last, by the position and by the time of [A] or [B]."""
    return [_onset_lead(tables, preset, inm, given) for inm in KINDS for given in ("t_a_h", "t_b_h")]


def _onset_lead(tables: Tables, preset: str, inm: str, given: str) -> Sized:
    """Compare the fall of basal extrusion from low to high positions with that from early to late events."""
    onset, time = (first_minus_last(tables, preset, each, inm) for each in ("onset_ab", given))
    what = f"fall of basal extrusion by position minus by time of [{given[2].upper()}], {inm}"
    fewest = min(map(cells_of, (onset, time)))
    return apart(what, onset.interval(CLAIM_LEVEL), time.interval(CLAIM_LEVEL), fewest)


@claim_in_readings(
    "c4.predictor",
    "Beside protrusions nothing tells more about basal extrusion than the position at the onset.",
    source="section 4.6",
    quote="basal positioning is for cells without protrusive activities the best predictor of basal extrusion",
    needs=(RANKING,),
    chosen="the group '35 % [P]', all cells; what a factor tells: the loss of a classifier without it",
)
def _predictor(tables: Tables, preset: str) -> list[Sized]:
    return [onset_first(tables, preset)]


@claim_in_readings(
    "c4.most-basal",
    "Seven or eight of ten cells without [P] and without INM that begin EMT in the lowest fifth leave basally.",
    source="section 4.6, Figure 21",
    quote="EMT cells which are in the most basal 20% of the tissue do exit basally with rates between 70 % up to 80 %.",
    recorded=Verdict.OPEN,
    needs=(GROUPS, RATIOS),
    chosen="the group '7 % [P]', in which the rates are highest",
)
def _most_basal(tables: Tables, preset: str) -> list[Sized]:
    """Runs that would decide it: cells that would, over those of a run."""
    table = tables[RATIOS]
    found = between(tables, preset, STUDY, "onset_ab", "no INM", 0, FIFTH)
    rates = share("basal extrusion in the most basal fifth", found, LEAST, MOST)
    made = table.loc[table["study"] == STUDY + PRESETS[preset], "runs"].max()
    runs = None if rates.runs is None else math.ceil(rates.runs * made / found.size)
    return [rates._replace(runs=runs)]


@claim_in_readings(
    "c4.lower-half",
    "More than half of the basally extruded cells without INM began EMT at a position below 1/2.",
    source="Figure 22",
    quote="Most cells which extrude basally start EMT from the lower half of the tissue.",
    needs=(GROUPS,),
    chosen="cells without [P], as the figure shows",
)
def _lower_half(tables: Tables, preset: str) -> list[Sized]:
    table = bins(tables, preset, MIDDLE, "onset_ab", "no INM")
    lower = table[table["high_edge"] <= 0.5 + 1e-9]["count"].sum()
    return [
        share(
            "basally extruded cells that began in the lower half",
            Ratio(int(lower), int(table["count"].sum())),
            0.5,
        )
    ]


# 'Get extruded': one cell in a hundred, at least. 'Favourable': the lower half of the scale, as in Figure 22.
SOME, FAVOURABLE = 0.01, 0.5
MORE_THAN_HALF = "of the comparisons that the page of EMT lists more than half have to hold"
ALL = "all comparisons have to hold"
# By question: the statement, what it reads, and what is chosen. The second halves of (Q2) and (Q5) are claims of their
# own, c4.q2-inm and c4.q5-mixed.
STATED = {
    "Q1": (
        "Are groups of EMT cells more efficient than isolated ones? No, in most cases heterogeneous groups are less "
        "efficient than individual cells.",
        "Cells with the same events leave basally more often alone than in a mixed group.",
        (RATIOS, GROUPS),
        MORE_THAN_HALF,
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
        f"{MORE_THAN_HALF}: the answer says mostly",
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
        f"{MORE_THAN_HALF}, without pairs of which all cells leave, or none",
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


def _answer(question: str) -> Callable[[Tables, str], Evidence]:
    """Return the check of an answer of section 4.7."""
    return lambda tables, preset: answer(tables, question, preset).evidence


# Claims that the answers use.
RESTS_ON = {"Q4": ("c4.timing",), "Q6": ("c4.without-inm",), "Q7": ("c4.predictor",), "Q8": ("c4.competition",)}
ANSWERED = tuple(
    claim_in_readings(
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


@claim_in_readings(
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
def _with_inm(tables: Tables, preset: str) -> Evidence:
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
