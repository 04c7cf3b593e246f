"""Chapter 4, sections 4.5.3 and 4.6: basal extrusion by event times and by the position at the onset."""

from __future__ import annotations

import math

from verification.claims import Evidence, Tables, Verdict, claim
from verification.thesis.chapter4.ensembles import PRESETS
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
    cells_of,
    evidence,
    in_readings,
    minus,
    more,
    share,
)
from verification.thesis.chapter4.questions import onset_first
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


@claim(
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
    rests_on=("c4.figure-20",),
    chosen=f"the group '35 % [P]', [A] and [B] of cells without [P]; alike: within {ALIKE:.0%} of the cells",
)
def _timing(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        found = {event: early_minus_late(tables, preset, event) for event in "ABP"}
        return evidence(
            [more(*each) for each in found["A"]] + [alike(*each) for event in "BP" for each in found[event]]
        )

    return in_readings(compare)


@claim(
    "c4.onset-over-timing",
    "Basal extrusion of cells without [P] depends more on where than on when EMT begins.",
    source="section 4.6, Figures 20, 21",
    quote="Comparing Figure 21 and Figure 20 … basal positioning has more impact on basal extrusion than the timing",
    needs=(GROUPS,),
    chosen="the group '35 % [P]'",
)
def _onset(tables: Tables) -> Evidence:
    """How much the first interval differs from the last, by the position and by the time of [A] or [B]."""

    def compare(preset: str) -> Evidence:
        return evidence([_onset_lead(tables, preset, inm, given) for inm in KINDS for given in ("t_a_h", "t_b_h")])

    return in_readings(compare)


def _onset_lead(tables: Tables, preset: str, inm: str, given: str) -> Sized:
    """Compare the fall of basal extrusion from low to high positions with that from early to late events."""
    onset, time = (first_minus_last(tables, preset, each, inm) for each in ("onset_ab", given))
    what = f"fall of basal extrusion by position minus by time of [{given[2].upper()}], {inm}"
    fewest = min(map(cells_of, (onset, time)))
    return apart(what, onset.interval(CLAIM_LEVEL), time.interval(CLAIM_LEVEL), fewest)


@claim(
    "c4.predictor",
    "Beside protrusions nothing tells more about basal extrusion than the position at the onset.",
    source="section 4.6",
    quote="basal positioning is for cells without protrusive activities the best predictor of basal extrusion",
    needs=(RANKING,),
    chosen="the group '35 % [P]', all cells; what a factor tells: the loss of a classifier without it",
)
def _predictor(tables: Tables) -> Evidence:
    return in_readings(lambda preset: evidence([onset_first(tables, preset)]))


@claim(
    "c4.most-basal",
    "Seven or eight of ten cells without [P] and without INM that begin EMT in the lowest fifth leave basally.",
    source="section 4.6, Figure 21",
    quote="EMT cells which are in the most basal 20% of the tissue do exit basally with rates between 70 % up to 80 %.",
    recorded=Verdict.OPEN,
    needs=(GROUPS, RATIOS),
    chosen="the group '7 % [P]', in which the rates are highest",
)
def _most_basal(tables: Tables) -> Evidence:
    """Runs that would decide it: cells that would, over those of a run."""
    table = tables[RATIOS]

    def compare(preset: str) -> Evidence:
        found = between(tables, preset, STUDY, "onset_ab", "no INM", 0, FIFTH)
        rates = share("basal extrusion in the most basal fifth", found, LEAST, MOST)
        made = table.loc[table["study"] == STUDY + PRESETS[preset], "runs"].max()
        runs = None if rates.runs is None else math.ceil(rates.runs * made / found.size)
        return evidence([rates._replace(runs=runs)])

    return in_readings(compare)


@claim(
    "c4.lower-half",
    "More than half of the basally extruded cells without INM began EMT at a position below 1/2.",
    source="Figure 22",
    quote="Most cells which extrude basally start EMT from the lower half of the tissue.",
    needs=(GROUPS,),
    chosen="cells without [P], as the figure shows",
)
def _lower_half(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        table = bins(tables, preset, MIDDLE, "onset_ab", "no INM")
        lower = table[table["high_edge"] <= 0.5 + 1e-9]["count"].sum()
        return evidence(
            [
                share(
                    "basally extruded cells that began in the lower half",
                    Ratio(int(lower), int(table["count"].sum())),
                    0.5,
                )
            ]
        )

    return in_readings(compare)
