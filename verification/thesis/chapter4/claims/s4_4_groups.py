"""Chapter 4, sections 4.4, 5 and 5.1: programs of events alone and in groups, by the kept tables."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from functools import partial

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio
from verification.claims import Evidence, Tables, Verdict
from verification.thesis.chapter4.frequencies import (
    DECIDES,
    RATIOS,
    hull,
    in_models,
    more,
    most_runs,
    needed,
    ratio_of,
    runs_for_bound,
    runs_for_margin,
    told,
)
from verification.thesis.chapter4.ratio_claims import CLAIM_LEVEL
from verification.thesis.chapter4.studies import PRESETS
from verification.thesis.text.quoted import claim

# Ends of the names of the scenarios of Figure 15.
SIZES = {"": "one with INM", " no INM": "one without", ", 10 cells": "ten with INM", " no INM, 10 cells": "ten without"}
# "Such high rates": of all cells but one in ten.
NEARLY_ALL = 0.9
# Of section 4.4.1, line 2886: in a group up to 10 points less.
UP_TO = 0.1


def programs(tables: Tables, suffix: str, kind: str) -> tuple[list[Ratio], list[Ratio]]:
    """Basal extrusion by the programs of Table 4 with [P], and by those without; ``kind``: the end of their names."""
    names = ("[ABP]", "[BAP]", "[BPx]", "[BxP]", "[AxB]", "[BxA]", "[Ax]", "[xA]", "[Bx]", "[xB]", "no EMT")
    found = {name: ratio_of(tables, f"figure15{suffix}", f"{name}{kind}", "basal") for name in names}
    return [found[name] for name in names if "P" in name], [found[name] for name in names if "P" not in name]


def least_lead(tables: Tables, suffix: str, kind: str) -> Difference:
    """The weakest program with [P] against the strongest one without."""
    with_p, without = programs(tables, suffix, kind)
    return Difference(min(with_p, key=lambda each: each.value), max(without, key=lambda each: each.value))


@claim(
    "c4.dominates",
    "Each program with [P] extrudes more cells basally than each without, for cells of one kind.",
    "section 4.3, Figure 15",
    needs=(RATIOS,),
)
def _dominates(tables: Tables) -> Evidence:
    found = {kind: in_models(partial(least_lead, tables, kind=kind)) for kind in SIZES}
    lines = (f"{SIZES[kind]} {found[kind][DECIDES]}" for kind in SIZES)
    return Evidence(
        f"Basal extrusion by the weakest program of Table 4 with [P] minus the strongest without: {'; '.join(lines)}.",
        printed=tuple(more(f"least lead of [P], {SIZES[kind]}", each) for kind, each in found.items()),
        runs_needed=needed(*found.values()),
    )


@claim(
    "c4.homogeneous-drop",
    "In a homogeneous group up to ten points fewer of the cells with [B☒] and without INM leave basally.",
    "section 4.4.1, Table 4",
    Verdict.OPEN,
    needs=(RATIOS,),
    chosen="[☒] is [B☒] (c4.table-4); −10% are points",
)
def _drop(tables: Tables) -> Evidence:
    found = in_models(
        lambda s: Difference(
            ratio_of(tables, f"figure15{s}", "[Bx] no INM", "basal"),
            ratio_of(tables, f"figure15{s}", "[Bx] no INM, 10 cells", "basal"),
        )
    )
    drop = found[DECIDES]
    return Evidence(
        f"[B☒] without INM, alone minus in a group: {told(found)}. That it drops is beyond chance; by up to "
        f"{100 * UP_TO:.0f} points or by more is not decided.",
        printed=(
            more("alone minus in a group, [B☒] without INM", found),
            hull("the same, up to 10 points", [drop.interval(CLAIM_LEVEL)], -math.inf, UP_TO),
        ),
        runs_needed=most_runs((needed(found), runs_for_margin(drop, UP_TO))),
    )


def spared(tables: Tables, suffix: str, passive: str, active: str) -> Difference:
    """Apical extrusion of ten cells by one program minus that by another."""
    without, with_p = (
        ratio_of(tables, f"figure15{suffix}", f"{name}, 10 cells", "apical") for name in (passive, active)
    )
    return Difference(without, with_p)


@claim(
    "c4.fewer-apical",
    "With [P] fewer cells leave apically than without it, by the programs with [B] of Table 4.",
    "section 5",
    Verdict.CORRECTED,
    needs=(RATIOS,),
)
def _fewer(tables: Tables) -> Evidence:
    """Isolated cells with [BP]; rarer: in groups of ten, of which there are enough cells to see it."""
    pairs = (("[AxB]", "[ABP]"), ("[BxA]", "[BAP]"), ("[Bx]", "[BxP]"))
    found = {
        f"{passive} minus {active}": in_models(partial(spared, tables, passive=passive, active=active))
        for passive, active in pairs
    }
    alone = ratio_of(tables, f"figure10{PRESETS[DECIDES]}", "[BP]", "apical")
    return Evidence(
        f"Of isolated cells with [BP] {alone} leave apically. Apical extrusion of ten cells with INM: "
        f"{'; '.join(f'{name} {each[DECIDES]}' for name, each in found.items())}.",
        printed=(hull("apical extrusion by [BP]", [alone.interval(CLAIM_LEVEL)], 0.0, 0.0),),
        corrected=tuple(more(f"apical extrusion, {name}", each) for name, each in found.items()),
        runs_needed=needed(*found.values()),
    )


@claim(
    "c4.only-protrusions",
    "Nearly all cells leave basally by some programs with [P], and by none without.",
    "section 5.1",
    needs=(RATIOS,),
    chosen=f"such high rates, 100 % in practice: more than {NEARLY_ALL:.0%}",
)
def _only(tables: Tables) -> Evidence:
    pairs = [programs(tables, PRESETS[DECIDES], kind) for kind in SIZES]
    best = max((each for _, without in pairs for each in without), key=lambda each: each.value)
    protruding = [max(with_p, key=lambda each: each.value) for with_p, _ in pairs]
    return Evidence(
        f"Without [P] no program of Table 4 extrudes more than {best}; with [P] there are programs for every kind of "
        f"cells that extrude {100 * min(each.value for each in protruding):.0f} % and more. Any limit between does.",
        printed=(
            hull("basal extrusion without [P], at most", [best.interval(CLAIM_LEVEL)], 0.0, NEARLY_ALL),
            hull("with [P], best program", [each.interval(CLAIM_LEVEL) for each in protruding], NEARLY_ALL, math.inf),
        ),
        runs_needed=most_runs(runs_for_bound(each.value, NEARLY_ALL) for each in (best, *protruding)),
    )
