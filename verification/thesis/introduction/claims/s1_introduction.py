"""Introduction: claims about the method, the model of cells and the mean-field limit."""

from __future__ import annotations

from tissue.statistics.comparisons import Difference
from verification.claims import Evidence, Tables, claim
from verification.thesis.chapter4.frequencies import RATIOS, evidence, in_readings, more, ratio_of, share

# Seconds of damped Arrow-Hurwicz and of PBD, as sections 3.2 and 3.4 of chapter 3 print them.
PROTRUSIONS, OTHERS = "[BP]", ("[A]", "[B]", "[S]")


@claim(
    "c0.protrusions",
    ("Cells with protrusions leave basally far more often than others, which are at risk of leaving apically."),
    source="introduction, Part II",
    quote=(
        "cells showing protrusive activities … are much more efficient at exiting basally than cells relying "
        "on passive forces"
    ),
    needs=(RATIOS,),
    rests_on=("c4.protrusions",),
    chosen="isolated cells with one event, with INM",
)
def _protrusions(tables: Tables) -> Evidence:
    """[BP] against the best other event, by basal extrusion; and the most of apical extrusion without [P]."""

    def compare(preset: str) -> Evidence:
        with_p = ratio_of(tables, preset, "figure10", PROTRUSIONS, "basal")
        most, risk = (
            max((ratio_of(tables, preset, "figure10", event, what) for event in OTHERS), key=lambda ratio: ratio.value)
            for what in ("basal", "apical")
        )
        return evidence(
            [
                more("basal extrusion with [P] minus the most without", Difference(with_p, most)),
                share("most apical extrusion without [P]", risk, 0.01),
            ]
        )

    return in_readings(compare)
