"""Chapter 4, sections 4.4 and 4.5: homogeneous and mixed groups."""

from __future__ import annotations

import math

from verification.claims import Correction, Effect, Evidence, Tables
from verification.thesis.chapter4.claims.s4_1_isolated import of_event
from verification.thesis.chapter4.frequencies import (
    GROUPS,
    RATIOS,
    Sized,
    alike,
    claim_in_readings,
    counted,
    evidence,
    minus,
    mixed,
    more,
    own,
    ratio_of,
    share,
    weighted,
)
from verification.thesis.chapter4.ratios import ProportionContrast, Ratio

# Ends of the names of the scenarios of Figure 15.
SIZES = {"": "one with INM", " no INM": "one without", ", 10 cells": "ten with INM", " no INM, 10 cells": "ten without"}
PROGRAMS = ("[ABP]", "[BAP]", "[BPx]", "[BxP]", "[AxB]", "[BxA]", "[Ax]", "[xA]", "[Bx]", "[xB]", "no EMT")
# "Such high rates": of all cells but one in ten.
NEARLY_ALL = 0.9
# Of section 4.4.1, line 2886: in a group up to 10 points less.
UP_TO = 0.1


def programs(tables: Tables, preset: str, kind: str) -> tuple[Ratio, Ratio, Ratio]:
    """Return basal extrusion by the strongest and weakest program of Table 4 with [P], and the strongest without.

    ``kind``: the end of the names of the scenarios.
    """
    found = {name: ratio_of(tables, preset, "figure15", f"{name}{kind}", "basal") for name in PROGRAMS}
    with_p, without = (
        sorted((ratio for name, ratio in found.items() if ("P" in name) is p), key=lambda each: each.value)
        for p in (True, False)
    )
    return with_p[-1], with_p[0], without[-1]


@claim_in_readings(
    "c4.dominates",
    "Each program with [P] extrudes more cells basally than each without, for cells of one kind.",
    source="section 4.3, Figure 15",
    quote="we can already draw that [P] will dominate each other event (which is also confirmed later in Figure 15)",
    needs=(RATIOS,),
)
def _dominates(tables: Tables, preset: str) -> list[Sized]:
    what = "basal extrusion, weakest program with [P] minus strongest without"
    return [more(f"{what}, {name}", minus(programs(tables, preset, kind)[1:])) for kind, name in SIZES.items()]


@claim_in_readings(
    "c4.homogeneous-drop",
    "In a homogeneous group up to ten points fewer of the cells with [B☒] and without INM leave basally.",
    source="section 4.4.1, Table 4",
    quote="the basal extrusion for homogeneous EMT drops …, the difference is up to −10% (for example [☒] without INM)",
    correction=Correction(
        "the difference is up to −28 %, of [B☒] without INM",
        Effect.NUMBER,
        "how much a group hinders its cells, 4.4.1 and the first half of the answer to (Q5)",
        why=(
            "79 % of isolated cells with [B☒] and without INM leave basally in the published runs, 52 % of those in "
            "groups of ten"
        ),
        place=2886,
    ),
    needs=(RATIOS,),
    chosen="[☒] is [B☒] (see the errata); −10% are points",
)
def _drop(tables: Tables, preset: str) -> Evidence:
    scenarios = ("[Bx] no INM", "[Bx] no INM, 10 cells")
    drop = minus(ratio_of(tables, preset, "figure15", name, "basal") for name in scenarios)
    what = "basal extrusion of [B☒] without INM, alone minus in a group"
    return evidence([more(what, drop), alike(f"{what}, up to 10 points", drop, UP_TO)], [more(what, drop, UP_TO)])


@claim_in_readings(
    "c4.fewer-apical",
    "With [P] fewer cells leave apically than without it, by the programs with [B] of Table 4, and none with [BP].",
    source="section 5",
    quote="Protrusive activities lead to basal extrusion and prevent apical extrusion, see Figure 10.",
    correction=Correction(
        "protrusive activities make apical extrusion rarer",
        Effect.CONCLUSION,
        "the first hypothesis of section 5",
        why="section 4.1.1 says of Figure 10 that with [BP] a small number of cells exit apically, and so it is",
        place=3027,
    ),
    needs=(RATIOS,),
)
def _fewer(tables: Tables, preset: str) -> Evidence:
    """Isolated cells with [BP]; rarer: in groups of ten, of which there are enough cells to see it."""
    pairs = (("[AxB]", "[ABP]"), ("[BxA]", "[BAP]"), ("[Bx]", "[BxP]"))
    rarer = [
        more(
            f"apical extrusion of ten cells, {' minus '.join(pair)}",
            minus(ratio_of(tables, preset, "figure15", f"{name}, 10 cells", "apical") for name in pair),
        )
        for pair in pairs
    ]
    return evidence(
        [share("apical extrusion, one cell with [BP]", of_event(tables, preset, "[BP]", "apical"), 0, 0)], rarer
    )


@claim_in_readings(
    "c4.only-protrusions",
    "Nearly all cells leave basally by some programs with [P], and by none without.",
    source="section 5.1",
    quote="The model suggests that such high rates of basal extrusion are only possible with cell protrusions.",
    needs=(RATIOS,),
    chosen=f"such high rates, 100 % in practice: more than {NEARLY_ALL:.0%}",
)
def _only(tables: Tables, preset: str) -> list[Sized]:
    found = {name: programs(tables, preset, kind) for kind, name in SIZES.items()}
    best = max((without for _, _, without in found.values()), key=lambda each: each.value)
    return [
        share("basal extrusion by the strongest program without [P]", best, 0.0, NEARLY_ALL),
        *(
            share(f"basal extrusion by the strongest program with [P], {name}", strongest, NEARLY_ALL)
            for name, (strongest, _, _) in found.items()
        ),
    ]


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


@claim_in_readings(
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
def _with_inm(tables: Tables, preset: str) -> list[Sized]:
    return [
        gain(tables, preset, events, "", group, -1) for events in ("[A]", "[A] and [B]") for group in (", 10 cells", "")
    ]


@claim_in_readings(
    "c4.mixed-without-inm",
    "Cells without INM leave basally more often in a mixed group than among cells with the same events.",
    source="section 4.5.2",
    quote="EMT cells without INM show higher rates of basal extrusion than they would show in a homogeneous case",
    needs=(GROUPS, RATIOS),
    chosen=GROUP_35,
)
def _no_inm(tables: Tables, preset: str) -> list[Sized]:
    return [gain(tables, preset, events, " no INM", ", 10 cells") for events in KINDS]


@claim_in_readings(
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
def _q5_mixed(tables: Tables, preset: str) -> Evidence:
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


def lead(what: str, first: Ratio, second: Ratio, factor: float) -> Sized:
    """Compare: the first ratio is larger than so many times the second."""
    return more(what, ProportionContrast((1.0, -factor), (first, second)))


@claim_in_readings(
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
def _double(tables: Tables, preset: str) -> Evidence:
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


@claim_in_readings(
    "c4.competition",
    "The more cells of a group have [P], the fewer of those without [P] and without INM leave basally.",
    source="Figure 19",
    quote="the presence of more protrusive cells … decreases the basal extrusion rates for cells without protrusions",
    needs=(GROUPS,),
)
def _competition(tables: Tables, preset: str) -> list[Sized]:
    def crowded_out(events: str) -> Sized:
        few, many = (mixed(tables, preset, f"table5_{percent}", events, " no INM") for percent in (7, 63))
        return more(f"basal extrusion of {events} no INM, among 7 % [P] minus among 63 % [P]", minus((few, many)))

    return [crowded_out(events) for events in KINDS]
