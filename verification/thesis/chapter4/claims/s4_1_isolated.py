"""Chapter 4, section 4.1: what becomes of an isolated cell, by the kept tables of the complete studies."""

from __future__ import annotations

import math
from functools import partial

from tissue.study.comparisons import ALIKE, CLAIM_LEVEL, Difference
from tissue.study.ratios import Ratio
from verification.claims import Correction, Effect, Tables, claim
from verification.evidence import Evidence, Kind, at_most
from verification.thesis.chapter4.frequencies import (
    RATIOS,
    alike,
    exclusive,
    hull,
    in_both,
    more,
    most_runs,
    of_event,
    ratio_of,
    runs_for_bound,
    runs_for_margin,
    told,
)
from verification.thesis.chapter4.studies import PRESETS

PRINTED = "emt_complete_printed"
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
    needs=(PRINTED,),
    recorded=Kind.CORRECTED,
    correction=Correction(
        "they come out with the energies of the published runs (denominators squared, see c3.dimensions), not with "
        "those printed in chapter 3",
        Effect.MODEL,
        "all numbers of section 4; Tables 1 to 3 need not change: the model as printed with those energies, and no "
        "other change, gives [A] 26, 16 and 64 %, without INM 31 %, [B] 0 %, without INM 66 % of 400 runs at 48 h",
    ),
    chosen="both ends of the runs, 48 h and 54 h; what chapter 3 leaves open as in the published runs",
)
def _printed(tables: Tables) -> Evidence:
    """The ratios that agree, at the time at which most do: the thesis does not say when it counts."""
    table = tables[PRINTED]
    counts = table.groupby(["preset", "time_h"], sort=False)["agrees"].agg(["sum", "size"])
    off = (counts["size"] - counts["sum"]).groupby("preset").min()
    lines = (f"{name} preset at {t:g} h {row['sum']} of {row['size']}" for (name, t), row in counts.iterrows())
    what = "printed ratios outside of the joint 99 % interval"
    return Evidence(
        f"Of the six printed ratios these agree with the measured ones: {'; '.join(lines)}. They are those of the "
        "published runs; with the printed energies fewer cells leave basally.",
        printed=(at_most(f"{what}, model as printed", int(off["thesis"]), 0),),
        corrected=(at_most(f"{what}, published energies and rules", int(off["published"]), 0),),
    )


def lead(tables: Tables, suffix: str, event: str) -> Difference:
    """Basal extrusion with protrusions minus that by another event."""
    return Difference(of_event(tables, suffix, "[BP]", "basal"), of_event(tables, suffix, event, "basal"))


@claim(
    "c4.protrusions",
    "Far more isolated cells leave basally with protrusions than by any other single event.",
    source="section 4.1.1, Figure 10",
    quote="This makes [P] extremely effective compared to all other EMT events.",
    needs=(RATIOS,),
    chosen="far more: at least half of all cells",
)
def _protrusions(tables: Tables) -> Evidence:
    found = {event: in_both(partial(lead, tables, event=event)) for event in ("[A]", "[B]", "[S]")}
    return Evidence(
        "Basal extrusion by [BP], model as printed and published one, minus that by "
        f"{'; '.join(f'{event} {told(each)}' for event, each in found.items())}.",
        printed=tuple(
            hull(f"[BP] minus {event}", [each[p].interval(CLAIM_LEVEL) for p in PRESETS], HALF, math.inf)
            for event, each in found.items()
        ),
        runs_needed=most_runs(runs_for_margin(each, HALF) for both in found.values() for each in both.values()),
    )


@claim(
    "c4.remain",
    "More than half of the cells with [B], and of those with [S], are not above or below the others.",
    source="Figure 10",
    quote="For loss of basal adhesion [B] and loss of straightness [S], cells remain mostly between the control cells.",
    needs=(RATIOS,),
    recorded=Kind.OPEN,
)
def _remain(tables: Tables) -> Evidence:
    parts: dict[str, list[Ratio]] = {"[B]": [], "[S]": []}
    lines = []
    for event, both in parts.items():
        for preset, suffix in PRESETS.items():
            out, below = (of_event(tables, suffix, event, what) for what in ("apical", "below"))
            both.append(Ratio(out.of - out.count - below.count, out.of))
            lines.append(f"{event}, {preset} preset: {both[-1]}")
    return Evidence(
        f"Neither above the tissue nor below all control cells are: {'; '.join(lines)}.",
        printed=tuple(
            hull(f"share of {event} that remains", [each.interval(CLAIM_LEVEL) for each in both], HALF, math.inf)
            for event, both in parts.items()
        ),
        runs_needed=most_runs(runs_for_bound(each.value, HALF) for both in parts.values() for each in both),
    )


@claim(
    "c4.mostly-basally",
    "After [A] more cells are positioned below all others than leave apically; fewer leave basally.",
    source="sections 4.1, 4.1.2",
    quote=(
        "[A] drives cells out of the tissue, mostly basally. … While there is more apical extrusion than basal "
        "extrusion …, in 60 % of the cases, the loss of apical adhesion pushes cells basally"
    ),
    needs=(RATIOS,),
)
def _mostly_basally(tables: Tables) -> Evidence:
    """Both ratios are of the same cells."""
    below = in_both(lambda suffix: exclusive(*(of_event(tables, suffix, "[A]", what) for what in ("below", "apical"))))
    out = in_both(lambda suffix: exclusive(*(of_event(tables, suffix, "[A]", what) for what in ("apical", "basal"))))
    return Evidence(
        f"Model as printed and published one: cells with [A] below all control cells minus apically extruded ones "
        f"{told(below)}; apically minus basally extruded ones {told(out)}.",
        printed=(more("below all control cells minus apical", below), more("apical minus basal extrusion", out)),
        runs_needed=most_runs(runs_for_margin(each, 0.0) for both in (below, out) for each in both.values()),
    )


@claim(
    "c4.apical",
    "Isolated cells with [A], [B] or [BP] leave apically, too, those with [BP] rarely.",
    source="sections 4.1.1, 4.1.3",
    quote="[A] and [B] also lead to apical extrusion; with [BP], a small number of cells exit apically",
    needs=(RATIOS,),
    chosen=f"a small number: up to {FEW:.0%}",
)
def _apical(tables: Tables) -> Evidence:
    events = ("[A]", "[B]", "[BP]")
    found = {event: [of_event(tables, suffix, event, "apical") for suffix in PRESETS.values()] for event in events}
    ranges = {"[A]": (SOME, math.inf), "[B]": (SOME, math.inf), "[BP]": (SOME, FEW)}
    lines = (f"{event} {' and '.join(map(str, each))}" for event, each in found.items())
    return Evidence(
        f"Apical extrusion, model as printed and published one: {'; '.join(lines)}.",
        printed=tuple(
            hull(f"apical extrusion by {event}", [r.interval(CLAIM_LEVEL) for r in found[event]], *ranges[event])
            for event in events
        ),
        runs_needed=most_runs(
            runs_for_bound(each.value, end) for event in events for each in found[event] for end in ranges[event]
        ),
    )


@claim(
    "c4.timing-isolated",
    "An isolated cell leaves basally as often whether [A] is early and [B] late, or the other way round.",
    source="section 4.3, Table 3",
    quote="we can conclude that the timing of EMT events does not seem to have an impact on basal extrusion",
    needs=(RATIOS,),
    recorded=Kind.OPEN,
    chosen=f"alike: within {ALIKE:.0%} at the end; the right of Figure 14 counts from [A] on, which no table does",
)
def _timing(tables: Tables) -> Evidence:
    """The two programs of Table 3 with the longest delays, at the end of the runs."""

    def find(suffix: str) -> Difference:
        early, late = (ratio_of(tables, f"figure14{suffix}", name, "basal") for name in ("[AxB]", "[BxA]"))
        return Difference(early, late)

    found = in_both(find)
    return Evidence(
        "Basal extrusion by [A☒B] minus that by [B☒A] at the end of the runs, model as printed and published one: "
        f"{told(found)}.",
        printed=(alike("[A☒B] minus [B☒A]", found, ALIKE),),
        runs_needed=most_runs(runs_for_margin(each, ALIKE) for each in found.values()),
    )
