"""Chapter 4, sections 4.1 to 4.3: isolated cells with INM and without, programs of events, tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

from tissue.files.parameters import preset as named
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate_many
from tissue.state.cells import Floats
from verification.claims import Correction, Effect, Evidence, Tables, at_least, at_most, claim
from verification.thesis.chapter4.ensembles import PRESETS
from verification.thesis.chapter4.frequencies import (
    ALIKE,
    CLAIM_LEVEL,
    IN_TIME,
    MODEL,
    OUTCOMES,
    RATIOS,
    Sized,
    alike,
    apart,
    claim_in_readings,
    evidence,
    in_readings,
    minus,
    more,
    ratio_of,
    share,
)
from verification.thesis.chapter4.printed import compared
from verification.thesis.chapter4.ratios import ProportionContrast, Ratio

# Of Table 3 those with the longest delays.
PROGRAMS = ("[AxB]", "[BxA]")
SINCE_A = 24.0  # [h], after which the runs of the program with the latest [A] end
# 'Almost guarantees': more than half of all cells more than any other event does.
HALF = 0.5
# 'A small number': up to a fifth. 'Lead to apical extrusion': of one cell in a hundred, at least.
FEW, SOME = 0.2, 0.01


@claim(
    "c4.isolated",
    "The ratios of Figures 10 and 12 come out of the model as chapter 3 prints it.",
    source="sections 4.1, 4.2.1, Figures 10, 12",
    quote=(
        "All simulations use the default parameters from Tables 1 to 3 (from Chapter 3) … [A] 30 % apically, 10 % "
        "basally, without INM 20 %; [B] 0 %, without INM 70 %"
    ),
    correction=Correction(
        (
            "they come out of the published runs; of the twelve rows in which they differ from chapter 3 two decide: "
            "the energies of the cytoskeleton and of the apical junctions"
        ),
        Effect.MODEL,
        (
            "all numbers of section 4; averaged over all other rows the first raises basal extrusion of [A] by 28 "
            "points, without INM by 40, of [B] without INM by 58; the second lowers them by 14, 17, 9; no other by "
            "over 6"
        ),
        why=(
            "with (3.9), (3.10) as printed the springs are too stiff by the factor R^soft + η, and hardly a cell "
            "leaves basally; the published program divides by the square (src/core/compute_forces.jl, line 28, of "
            "SteffenPL/sEMTor.jl), and its junctions have half the energy of (3.11) without dimension (line 83)"
        ),
        place=2758,
    ),
    needs=(RATIOS, IN_TIME),
    rests_on=("c3.dimensions",),
    chosen="the ends of the runs, 48 h and 54 h, for the text gives none; what chapter 3 leaves open as in the "
    "published runs",
)
def _printed(tables: Tables) -> Evidence:
    """The ratios that agree, at the time at which most do: the thesis does not say when it counts."""
    table = compared(tables)
    counts = table.groupby(["preset", "time_h"], sort=False)["agrees"].agg(["sum", "size"])
    off = (counts["size"] - counts["sum"]).groupby("preset").min()
    lines = (f"{name} preset at {t:g} h {row['sum']} of {row['size']}" for (name, t), row in counts.iterrows())
    what = "printed ratios outside of the joint 99 % interval"
    return Evidence(
        f"Printed ratios that agree with the measured ones: {'; '.join(lines)}.",
        printed=(at_most(f"{what}, model as printed", int(off["thesis"]), 0),),
        corrected=(at_most(f"{what}, published runs", int(off["published"]), 0),),
    )


def of_event(tables: Tables, preset: str, event: str, what: str) -> Ratio:
    """Return how often an isolated cell with INM and one event ends so, Figure 10."""
    return ratio_of(tables, preset, "figure10", event, what)


@claim_in_readings(
    "c4.protrusions",
    "Far more isolated cells leave basally with protrusions than by any other single event.",
    source="section 4.1.1, Figure 10; introduction, Part II",
    also=("c0.protrusions",),
    quote="This makes [P] extremely effective compared to all other EMT events.",
    needs=(RATIOS,),
    chosen="far more: by at least half of all cells",
)
def _protrusions(tables: Tables, preset: str) -> list[Sized]:
    def lead(event: str) -> ProportionContrast:
        return minus(of_event(tables, preset, each, "basal") for each in ("[BP]", event))

    return [more(f"basal extrusion, [BP] minus {event}", lead(event), HALF) for event in ("[A]", "[B]", "[S]")]


@claim_in_readings(
    "c4.remain",
    "More than half of the cells with [B], and of those with [S], are not above or below the others.",
    source="Figure 10",
    quote="For loss of basal adhesion [B] and loss of straightness [S], cells remain mostly between the control cells.",
    needs=(RATIOS,),
)
def _remain(tables: Tables, preset: str) -> list[Sized]:
    def remain(event: str) -> Sized:
        out, below = (of_event(tables, preset, event, what) for what in ("apical", "below"))
        left = Ratio(out.of - out.count - below.count, out.of)
        return share(f"cells with {event} neither above the tissue nor below all control cells", left, HALF)

    return [remain(event) for event in ("[B]", "[S]")]


@claim_in_readings(
    "c4.mostly-basally",
    "Of the cells that [A] drives out of the tissue most leave basally.",
    source="sections 4.1, 4.1.2",
    quote=(
        "[A] drives cells out of the tissue, mostly basally. … While there is more apical extrusion than basal "
        "extrusion …, in 60 % of the cases, the loss of apical adhesion pushes cells basally"
    ),
    correction=Correction(
        "[A] brings most cells below all others, but out of the tissue fewer basally than apically",
        Effect.CONCLUSION,
        "the second of the observations in 4.1, the heading of 4.1.2, whose text has 30 % apically, 10 % basally",
        why="a cell that lies below all others is not extruded by (4.3); the section counts it with the extruded ones",
        place=2764,
    ),
    needs=(RATIOS,),
)
def _mostly_basally(tables: Tables, preset: str) -> Evidence:
    """No cell has two of the outcomes, so they are compared among the cells that have one of both."""
    basal, apical, below = (of_event(tables, preset, "[A]", what) for what in ("basal", "apical", "below"))
    return evidence(
        [share("cells with [A] that leave, basally", of_both(basal, apical), HALF)],
        [
            share("cells with [A] apically extruded or below all others, below", of_both(below, apical), HALF),
            share("cells with [A] that leave, apically", of_both(apical, basal), HALF),
        ],
    )


def of_both(first: Ratio, second: Ratio) -> Ratio:
    """Return the first outcome among the cells with one of two that exclude each other; one cell in each run."""
    return Ratio(first.count, first.count + second.count)


@claim_in_readings(
    "c4.apical",
    "Isolated cells with [A], [B] or [BP] leave apically, too, those with [BP] rarely.",
    source="sections 4.1.1, 4.1.3",
    quote="[A] and [B] also lead to apical extrusion; with [BP], a small number of cells exit apically",
    needs=(RATIOS,),
    chosen=f"too: {SOME:.0%} of the cells, at least; a small number: up to {FEW:.0%}",
)
def _apical(tables: Tables, preset: str) -> list[Sized]:
    most = {"[A]": math.inf, "[B]": math.inf, "[BP]": FEW}
    return [
        share(f"apical extrusion, {event}", of_event(tables, preset, event, "apical"), SOME, high)
        for event, high in most.items()
    ]


def _counted(row: pd.Series) -> Ratio:
    return Ratio(int(row["count"]), int(row["of"]))


@claim_in_readings(
    "c4.timing-isolated",
    "An isolated cell leaves basally as often whether [A] is early and [B] late, or the other way round.",
    source="section 4.3, Table 3",
    quote="we can conclude that the timing of EMT events does not seem to have an impact on basal extrusion",
    correction=Correction(
        "the time of [A] has an impact; the order of [A] and [B], counted from [A] on, has less",
        Effect.CONCLUSION,
        "4.3 and 4.3.1; the captions of Figures 14 and 20 and section 4.5.3 say that the time of [A] has an impact",
        why=(
            "a cell whose [A] comes 18 h earlier has 18 h more to leave, and the curves of both orders differ even if "
            "they begin at [A]"
        ),
        place=2841,
    ),
    needs=(RATIOS, IN_TIME),
    chosen=f"the programs of Table 3 with the longest delays; alike: within {ALIKE:.0%} of the cells; "
    "the end of the runs, and 24 h after [A]",
)
def _timing(tables: Tables, preset: str) -> Evidence:
    """Whether the end shows a difference, and whether counting from [A] on makes it smaller."""
    table = tables[IN_TIME]
    later = table[(table["what"] == "basal") & (table["time_h"] == table["a_h"] + SINCE_A)]
    rows = later.set_index(["study", "scenario"])
    at_end = minus(ratio_of(tables, preset, "figure14", name, "basal") for name in PROGRAMS)
    since = minus(_counted(rows.loc[("figure14" + PRESETS[preset], name)]) for name in PROGRAMS)
    smaller = apart("the same, end minus 24 h after [A]", at_end.interval(CLAIM_LEVEL), since.interval(CLAIM_LEVEL))
    what = "basal extrusion at the end, [A☒B] minus [B☒A]"
    return evidence([alike(what, at_end)], [more(what, at_end), smaller])


# By so much [S] may change a ratio if it is 'mostly irrelevant'.
LITTLE = 0.2


def of_still(tables: Tables, preset: str, event: str, what: str) -> Ratio:
    """Return how often an isolated cell without INM ends so, Figure 12."""
    return ratio_of(tables, preset, "figure12", f"{event} no INM", what)


@claim_in_readings(
    "c4.without-inm",
    "An isolated cell with [A] or [B] leaves more often basally and less often apically without INM.",
    source="section 4.2.1",
    quote="Stopped INM leads to more basal and less apical extrusion.",
    needs=(RATIOS,),
)
def _without_inm(tables: Tables, preset: str) -> list[Sized]:
    found = []
    for event in ("[A]", "[B]"):
        for what, order, sign in (("basal", "without minus with INM", 1), ("apical", "with minus without INM", -1)):
            sides = (of_still(tables, preset, event, what), of_event(tables, preset, event, what))
            found.append(more(f"{what} extrusion, {event}, {order}", minus(sides[::sign])))
    return found


@claim_in_readings(
    "c4.inm-swaps",
    "Without INM [B] extrudes more cells basally than [A], with INM fewer.",
    source="Figure 12",
    quote="Suddenly, [B] leads to much more basal extrusion compared to [A]. With INM it was the other way around.",
    needs=(RATIOS,),
)
def _swapped(tables: Tables, preset: str) -> list[Sized]:
    still = minus(of_still(tables, preset, event, "basal") for event in ("[B]", "[A]"))
    moving = minus(of_event(tables, preset, event, "basal") for event in ("[A]", "[B]"))
    return [
        more("basal extrusion without INM, [B] minus [A]", still),
        more("basal extrusion with INM, [A] minus [B]", moving),
    ]


@claim_in_readings(
    "c4.drift",
    "A cell that stops INM comes to lie below all others more often, without an event and with [S].",
    source="Figure 12, section 4.2.1",
    quote="the basal positioning increases even for EMT cells which only stop INM … or only perform [S]",
    needs=(RATIOS,),
)
def _drift(tables: Tables, preset: str) -> list[Sized]:
    """A cell without any event, and one with [S] alone."""
    with_inm = {
        "no EMT": ratio_of(tables, preset, "figure15", "no EMT", "below"),
        "[S]": of_event(tables, preset, "[S]", "below"),
    }
    return [
        more(
            f"below all control cells, {event}, without minus with INM",
            minus((of_still(tables, preset, event, "below"), ratio)),
        )
        for event, ratio in with_inm.items()
    ]


def by_straightness(tables: Tables, preset: str) -> list[Sized]:
    """Compare [S] with a cell without any event, with INM and without it."""
    found = []
    for what in ("basal", "apical"):
        for inm, loose, none in (("", "figure10", "figure15"), (" no INM", "figure12", "figure12")):
            sides = ((loose, f"[S]{inm}"), (none, f"no EMT{inm}"))
            change = minus(ratio_of(tables, preset, *side, what) for side in sides)
            found.append(alike(f"{what} extrusion{inm}, [S] minus no EMT", change, LITTLE))
    return found


@claim_in_readings(
    "c4.straightness",
    "A cell with [S] leaves hardly more often than one without any event.",
    source="section 4.2.2",
    quote="[S] is mostly irrelevant … cells which lose straightness [S] still behave essentially like epithelial cells",
    needs=(RATIOS,),
    chosen=f"mostly irrelevant: a change of less than {LITTLE:.0%} of the cells; [S] sets α^axb to 0 with the printed "
    "and with the corrected energies, to 1 of 15 in the published program",
)
def _straightness(tables: Tables, preset: str) -> list[Sized]:
    return by_straightness(tables, preset)


@claim_in_readings(
    "c4.straightness-rule",
    "[S] sets the stiffness of the bending spring to zero, and cells still behave like those without any event.",
    source="sections 2.2.3, 4.2.2",
    quote="we set the stiffness of the bending spring to zero, e.g. α^axb(t⁺) := 0 … [S] is mostly irrelevant",
    correction=Correction(
        (
            "[S] decreases α^axb, as section 2.1 says, to 1 of 15 in the published runs, not to 0 as in 2.2.3: with 1 "
            "it is mostly irrelevant"
        ),
        Effect.MODEL,
        "2.2.3 and Figures 10, 12; that [S] is left out from 4.3 on",
        why=(
            "section 2.1 says that [S] decreases α^axb; without bending stiffness nothing holds the nucleus between "
            "its two points, and a fifth to two fifths of the cells with INM leave apically"
        ),
        place=2821,
    ),
    needs=(RATIOS,),
    rests_on=("c4.straightness",),
    chosen=f"a change of less than {LITTLE:.0%} of the cells; corrected: the published program, whose energies differ "
    "from the printed ones, too",
    decides=MODEL,
)
def _straightness_rule(tables: Tables, preset: str) -> Evidence:
    kept = by_straightness(tables, OUTCOMES)
    return evidence(by_straightness(tables, preset), kept)


# Runs with one cell each; how long after [B] they end [h].
SEEDS, AFTER = range(60, 120), 3


def positions(preset: str, seeds: Sequence[int], b: str) -> Floats:
    """Return y_AB of isolated EMT cells at 24 h and after some hours, for [A] at 6 h and [B] at ``b``: (2, seeds)."""
    emt = {"emt.cells": 1, "emt.a": "6 h", "emt.b": b}
    parameters = named(preset).changed(emt | {"numerics.t_end": f"{24 + AFTER} h", "numerics.keep": f"{AFTER} h"})
    runs = simulate_many(parameters, seeds)
    return np.array([[ab_positions(run.frames[k])[run.frames[k].cells.emt >= 0][0] for run in runs] for k in (-2, -1)])


@claim(
    "c4.pulled-back",
    "Some cells that left apically after [A] return into the tissue when [B] frees their basal spring.",
    source="Figure 14",
    quote=(
        "In [A⊗B], the amount of apical extrusion increases rapidly in the beginning … at the onset of [B] some cells "
        "are pulled back into the tissue."
    ),
    chosen=f"[A] at 6 h, [B] at 24 h; back: y^AB ≤ 1 within {AFTER} h; the same seeds with [B] and without",
)
def _pulled_back() -> Evidence:
    def compare(preset: str) -> Evidence:
        at, later = positions(preset, SEEDS, "24 h")
        above = [seed for seed, y in zip(SEEDS, at, strict=True) if y > 1]
        _, control = positions(preset, above, "never")
        back = int((later[at > 1] <= 1).sum()) - int((control <= 1).sum())
        return Evidence(
            printed=(
                at_least("isolated cells above the tissue at 24 h", len(above), 1),
                at_least("of these, return with [B] minus return without [B]", back, 1),
            )
        )

    return in_readings(compare)
