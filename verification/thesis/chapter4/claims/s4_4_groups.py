"""Chapter 4, sections 4.4, 5 and 5.1: programs of events alone and in groups, by the kept tables."""

from __future__ import annotations

from verification.claims import Correction, Effect, Evidence, Tables, claim
from verification.thesis.chapter4.claims.s4_1_isolated import of_event
from verification.thesis.chapter4.frequencies import RATIOS, alike, evidence, in_readings, minus, more, ratio_of, share
from verification.thesis.chapter4.ratios import Ratio

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


@claim(
    "c4.dominates",
    "Each program with [P] extrudes more cells basally than each without, for cells of one kind.",
    source="section 4.3, Figure 15",
    quote="we can already draw that [P] will dominate each other event (which is also confirmed later in Figure 15)",
    needs=(RATIOS,),
)
def _dominates(tables: Tables) -> Evidence:
    what = "basal extrusion, weakest program with [P] minus strongest without"
    return in_readings(
        lambda preset: evidence(
            [more(f"{what}, {name}", minus(programs(tables, preset, kind)[1:])) for kind, name in SIZES.items()]
        )
    )


@claim(
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
    rests_on=("c4.table-4",),
    chosen="[☒] is [B☒] (c4.table-4); −10% are points",
)
def _drop(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        scenarios = ("[Bx] no INM", "[Bx] no INM, 10 cells")
        drop = minus(ratio_of(tables, preset, "figure15", name, "basal") for name in scenarios)
        what = "basal extrusion of [B☒] without INM, alone minus in a group"
        return evidence([more(what, drop), alike(f"{what}, up to 10 points", drop, UP_TO)], [more(what, drop, UP_TO)])

    return in_readings(compare)


@claim(
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
def _fewer(tables: Tables) -> Evidence:
    """Isolated cells with [BP]; rarer: in groups of ten, of which there are enough cells to see it."""
    pairs = (("[AxB]", "[ABP]"), ("[BxA]", "[BAP]"), ("[Bx]", "[BxP]"))

    def compare(preset: str) -> Evidence:
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

    return in_readings(compare)


@claim(
    "c4.only-protrusions",
    "Nearly all cells leave basally by some programs with [P], and by none without.",
    source="section 5.1",
    quote="The model suggests that such high rates of basal extrusion are only possible with cell protrusions.",
    needs=(RATIOS,),
    chosen=f"such high rates, 100 % in practice: more than {NEARLY_ALL:.0%}",
)
def _only(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        found = {name: programs(tables, preset, kind) for kind, name in SIZES.items()}
        best = max((without for _, _, without in found.values()), key=lambda each: each.value)
        return evidence(
            [
                share("basal extrusion by the strongest program without [P]", best, 0.0, NEARLY_ALL),
                *(
                    share(f"basal extrusion by the strongest program with [P], {name}", strongest, NEARLY_ALL)
                    for name, (strongest, _, _) in found.items()
                ),
            ]
        )

    return in_readings(compare)
