"""Chapter 4, section 4.5 and (Q5): mixed groups of EMT cells, by the kept tables of the complete studies."""

from __future__ import annotations

import math

from verification.claims import Correction, Effect, Evidence, Tables, claim
from verification.thesis.chapter4.frequencies import (
    GROUPS,
    RATIOS,
    Sized,
    counted,
    evidence,
    in_readings,
    minus,
    mixed,
    more,
    own,
    weighted,
)
from verification.thesis.chapter4.ratios import ProportionContrast, Ratio

# Of the sentence "almost double"; and a difference that is none.
ALMOST_TWICE, LITTLE = 1.5, 0.05
POINT = 0.01  # a gain: the thesis prints whole per cents
KINDS = ("[A]", "[B]", "[A] and [B]")
GROUP_35 = "the group '35 % [P]'; homogeneous: the same events, each cell at its own time"


def gain(tables: Tables, preset: str, events: str, inm: str, group: str, sign: int = 1, least: float = 0.0) -> Sized:
    """Compare a mixed group, '35 % [P]', with cells alone or in a group of their like; ``sign`` -1: the reverse."""
    sides = (mixed(tables, preset, "table5_35", events, inm), own(tables, preset, events, inm, group))
    names = ("mixed", "homogeneous" if group else "alone")
    what = f"basal extrusion of {events}{inm}, {' minus '.join(names[::sign])}"
    return more(what, minus(sides[::sign]), least)


@claim(
    "c4.mixed-with-inm",
    (
        "Cells with INM and [A], with or without [B], leave basally less often in a mixed group than alone, and than "
        "among cells with the same events."
    ),
    source="section 4.5.1",
    quote="for EMT cells with INM the frequency of basal extrusion is lowest in the case of heterogeneous EMT",
    needs=(GROUPS, RATIOS),
    chosen=GROUP_35,
)
def _with_inm(tables: Tables) -> Evidence:
    return in_readings(
        lambda preset: evidence(
            [
                gain(tables, preset, events, "", group, -1)
                for events in ("[A]", "[A] and [B]")
                for group in (", 10 cells", "")
            ]
        )
    )


@claim(
    "c4.mixed-without-inm",
    "Cells without INM leave basally more often in a mixed group than among cells with the same events.",
    source="section 4.5.2",
    quote="EMT cells without INM show higher rates of basal extrusion than they would show in a homogeneous case",
    needs=(GROUPS, RATIOS),
    chosen=GROUP_35,
)
def _no_inm(tables: Tables) -> Evidence:
    return in_readings(
        lambda preset: evidence([gain(tables, preset, events, " no INM", ", 10 cells") for events in KINDS])
    )


@claim(
    "c4.q5-mixed",
    "Of the six kinds of cells of Figures 17 to 19 more than half leave basally more often in mixed groups.",
    source="section 4.7, (Q5)",
    quote=(
        "heterogeneous groups increase the efficiency of basal extrusion for most EMT programs compared to homogeneous"
        " groups."
    ),
    correction=Correction(
        (
            "for cells without INM with [A], in the published runs for all without INM; for those with INM and [A], "
            "with and without [B], they decrease it"
        ),
        Effect.CONCLUSION,
        "the second half of the answer to (Q5)",
        why=(
            "the observation of 4.5.1 has a lower frequency with INM, that of 4.5.2 a higher one without: three of six"
            " figures are not most, and with the corrected energies it is one"
        ),
        place=3007,
    ),
    needs=(GROUPS, RATIOS),
    rests_on=("c4.mixed-with-inm", "c4.mixed-without-inm"),
    chosen=f"{GROUP_35}; most: more than half of [A], [B] and both, with and without INM; to gain: one point or more",
)
def _q5_mixed(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        kinds = [(events, inm) for inm in ("", " no INM") for events in KINDS]
        gains = [gain(tables, preset, *kind, ", 10 cells", least=POINT) for kind in kinds]
        most = counted("kinds that gain", [each.comparison for each in gains], len(kinds) // 2 + 1)
        return evidence(
            [Sized(most, None)],
            [
                gain(tables, preset, "[A]", " no INM", ", 10 cells"),
                *(gain(tables, preset, events, "", ", 10 cells", -1) for events in ("[A]", "[A] and [B]")),
            ],
        )

    return in_readings(compare)


def lead(what: str, first: Ratio, second: Ratio, factor: float) -> Sized:
    """Compare: the first ratio is larger than so many times the second."""
    return more(what, ProportionContrast((1.0, -factor), (first, second)))


@claim(
    "c4.almost-double",
    "Cells with [A] and without INM leave basally almost twice as often in a mixed group as alone.",
    source="section 4.5.2, Figure 18",
    quote=(
        "In all but one of the examples, individual cells are more efficient than cells in a heterogeneous "
        "environment. The only exception is in Figure 18 where cells with [A] do almost double their extrusion ratios"
    ),
    correction=Correction(
        (
            "cells with [A] are no exception: in a mixed group they leave no more often than alone, and more often "
            "than in a homogeneous one"
        ),
        Effect.CONCLUSION,
        "the caption of Figure 18, and that heterogeneity makes inefficient events more efficient",
        why=(
            "only with the energies as printed in chapter 3, with which hardly a cell with [A] leaves alone, does the "
            "mixed group help them beyond that"
        ),
        place=2934,
    ),
    needs=(GROUPS, RATIOS),
    rests_on=("c4.mixed-without-inm",),
    chosen=f"the group '35 % [P]'; alone and in a homogeneous group: [A] at any time, as in the mixed one; "
    f"almost twice: {ALMOST_TWICE:g} times; no more often: by less than {LITTLE:.0%} of the cells",
)
def _double(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        mine = mixed(tables, preset, "table5_35", "[A]", " no INM")
        alone = own(tables, preset, "[A]", " no INM", "")
        what = "basal extrusion of [A] no INM, mixed minus"
        return evidence(
            [lead(f"{what} {ALMOST_TWICE:g} times alone", mine, alone, ALMOST_TWICE)],
            [
                weighted(f"{what} alone [points]", minus((mine, alone)), -math.inf, LITTLE),
                gain(tables, preset, "[A]", " no INM", ", 10 cells"),
            ],
        )

    return in_readings(compare)


@claim(
    "c4.competition",
    "The more cells of a group have [P], the fewer of those without [P] and without INM leave basally.",
    source="Figure 19",
    quote="the presence of more protrusive cells … decreases the basal extrusion rates for cells without protrusions",
    needs=(GROUPS,),
)
def _competition(tables: Tables) -> Evidence:
    def crowded_out(preset: str, events: str) -> Sized:
        few, many = (mixed(tables, preset, f"table5_{percent}", events, " no INM") for percent in (7, 63))
        return more(f"basal extrusion of {events} no INM, among 7 % [P] minus among 63 % [P]", minus((few, many)))

    return in_readings(lambda preset: evidence([crowded_out(preset, events) for events in KINDS]))
