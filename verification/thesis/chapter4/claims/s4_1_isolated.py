"""Chapter 4, section 4.1: what becomes of an isolated cell, by the kept tables of the complete studies."""

from __future__ import annotations

import math
from functools import partial

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio, as_ratio
from verification.claims import Evidence, Tables, Verdict, at_most
from verification.thesis.chapter4.frequencies import (
    DECIDES,
    RATIOS,
    alike,
    exclusive,
    hull,
    in_models,
    more,
    most_runs,
    needed,
    of_event,
    ratio_of,
    runs_for_bound,
    runs_for_margin,
    shares,
    told,
)
from verification.thesis.chapter4.ratio_claims import ALIKE, CLAIM_LEVEL
from verification.thesis.text.quoted import claim

PRINTED, SINCE = "emt_complete_printed", "emt_complete_since"
# Of Table 3 those with the longest delays.
PROGRAMS = ("[AxB]", "[BxA]")
# 'Almost guarantees': more than half of all cells more than any other event does.
HALF = 0.5
# 'A small number': up to a fifth. 'Lead to apical extrusion': of one cell in a hundred, at least.
FEW, SOME = 0.2, 0.01


@claim(
    "c4.isolated",
    "The ratios of Figures 10 and 12 come out of the model as chapter 3 prints it.",
    "sections 4.1, 4.2.1, Figures 10, 12",
    Verdict.CORRECTED,
    needs=(PRINTED,),
    chosen="the ends of the runs, 48 h and 54 h, for the text gives none; what chapter 3 leaves open as in the "
    "published runs",
)
def _printed(tables: Tables) -> Evidence:
    """The ratios that agree, at the time at which most do: the thesis does not say when it counts."""
    table = tables[PRINTED]
    counts = table.groupby(["preset", "time_h"], sort=False)["agrees"].agg(["sum", "size"])
    off = (counts["size"] - counts["sum"]).groupby("preset").min()
    lines = (f"{name} preset at {t:g} h {row['sum']} of {row['size']}" for (name, t), row in counts.iterrows())
    what = "printed ratios outside of the joint 99 % interval"
    return Evidence(
        f"Of the six printed ratios these agree with the measured ones: {'; '.join(lines)}. With the printed energies "
        "fewer cells leave basally.",
        printed=(at_most(f"{what}, model as printed", int(off["thesis"]), 0),),
        corrected=(at_most(f"{what}, published runs", int(off["published"]), 0),),
    )


def lead(tables: Tables, suffix: str, event: str) -> Difference:
    """Basal extrusion with protrusions minus that by another event."""
    return Difference(of_event(tables, suffix, "[BP]", "basal"), of_event(tables, suffix, event, "basal"))


@claim(
    "c4.protrusions",
    "Far more isolated cells leave basally with protrusions than by any other single event.",
    "section 4.1.1, Figure 10",
    needs=(RATIOS,),
    chosen="far more: by at least half of all cells; the evidence has the largest margin for which it holds",
)
def _protrusions(tables: Tables) -> Evidence:
    found = {event: in_models(partial(lead, tables, event=event)) for event in ("[A]", "[B]", "[S]")}
    return Evidence(
        f"Basal extrusion by [BP] minus that by {'; '.join(f'{event} {told(each)}' for event, each in found.items())}.",
        printed=tuple(
            hull(f"[BP] minus {event}", [each[DECIDES].interval(CLAIM_LEVEL)], HALF, math.inf)
            for event, each in found.items()
        ),
        runs_needed=most_runs(runs_for_margin(each[DECIDES], HALF) for each in found.values()),
    )


@claim(
    "c4.remain",
    "More than half of the cells with [B], and of those with [S], are not above or below the others.",
    "Figure 10",
    needs=(RATIOS,),
)
def _remain(tables: Tables) -> Evidence:

    def remain(suffix: str, event: str) -> Ratio:
        out, below = (of_event(tables, suffix, event, what) for what in ("apical", "below"))
        return Ratio(out.of - out.count - below.count, out.of)

    found = {event: in_models(partial(remain, event=event)) for event in ("[B]", "[S]")}
    return Evidence(
        "Neither above the tissue nor below all control cells are: "
        f"{'; '.join(f'{event} {shares(each)}' for event, each in found.items())}.",
        printed=tuple(
            hull(f"share of {event} that remains", [each[DECIDES].interval(CLAIM_LEVEL)], HALF, math.inf)
            for event, each in found.items()
        ),
        runs_needed=most_runs(runs_for_bound(each[DECIDES].value, HALF) for each in found.values()),
    )


@claim(
    "c4.mostly-basally",
    "Of the cells that [A] drives out of the tissue most leave basally.",
    "sections 4.1, 4.1.2",
    Verdict.CORRECTED,
    needs=(RATIOS,),
)
def _mostly_basally(tables: Tables) -> Evidence:
    """The ratios are of the same cells."""

    def apart(suffix: str, first: str, second: str) -> Difference:
        return exclusive(*(of_event(tables, suffix, "[A]", what) for what in (first, second)))

    below = in_models(partial(apart, first="below", second="apical"))
    out = in_models(partial(apart, first="apical", second="basal"))
    basal = in_models(partial(apart, first="basal", second="apical"))
    return Evidence(
        f"Cells with [A] below all control cells minus apically extruded ones {told(below)}; apically minus basally "
        f"extruded ones {told(out)}.",
        printed=(more("basal minus apical extrusion", basal),),
        corrected=(more("below all control cells minus apical", below), more("apical minus basal extrusion", out)),
        runs_needed=most_runs(runs_for_margin(each[DECIDES], 0.0) for each in (below, out)),
    )


@claim(
    "c4.apical",
    "Isolated cells with [A], [B] or [BP] leave apically, too, those with [BP] rarely.",
    "sections 4.1.1, 4.1.3",
    needs=(RATIOS,),
    chosen=f"a small number: up to {FEW:.0%}; it holds for each limit above the interval",
)
def _apical(tables: Tables) -> Evidence:
    events = ("[A]", "[B]", "[BP]")
    found = {event: in_models(partial(of_event, tables, event=event, what="apical")) for event in events}
    ranges = {"[A]": (SOME, math.inf), "[B]": (SOME, math.inf), "[BP]": (SOME, FEW)}
    return Evidence(
        f"Apical extrusion: {'; '.join(f'{event} {shares(each)}' for event, each in found.items())}.",
        printed=tuple(
            hull(f"apical extrusion by {event}", [found[event][DECIDES].interval(CLAIM_LEVEL)], *ranges[event])
            for event in events
        ),
        runs_needed=most_runs(
            runs_for_bound(found[event][DECIDES].value, end) for event in events for end in ranges[event]
        ),
    )


def early_minus_late(tables: Tables, suffix: str) -> Difference:
    """Basal extrusion by [A☒B] minus that by [B☒A], at the end of the runs."""
    early, late = (ratio_of(tables, f"figure14{suffix}", name, "basal") for name in PROGRAMS)
    return Difference(early, late)


def since_a(tables: Tables, suffix: str) -> Difference:
    """The same difference, of each program so many hours after its [A]."""
    rows = tables[SINCE].set_index(["study", "scenario"])
    early, late = (as_ratio(rows.loc[(f"figure14{suffix}", name)]) for name in PROGRAMS)
    return Difference(early, late)


@claim(
    "c4.timing-isolated",
    "An isolated cell leaves basally as often whether [A] is early and [B] late, or the other way round.",
    "section 4.3, Table 3",
    Verdict.CORRECTED,
    needs=(RATIOS, SINCE),
    chosen="the programs of Table 3 with the longest delays; the end of the runs, and 24 h after [A]",
)
def _timing(tables: Tables) -> Evidence:
    """Whether the end shows a difference, and whether counting from [A] on makes it smaller."""
    end, relative = in_models(partial(early_minus_late, tables)), in_models(partial(since_a, tables))
    (least, most), (low, high) = (each[DECIDES].interval(CLAIM_LEVEL) for each in (end, relative))
    return Evidence(
        f"Basal extrusion by [A☒B] minus that by [B☒A]: at the end of the runs {told(end)}; 24 h after [A] "
        f"{told(relative)}. At the end they are alike for no margin below {100 * least:.0f} points.",
        printed=(alike("[A☒B] minus [B☒A] at the end", end, margin=ALIKE),),
        corrected=(
            more("[A☒B] minus [B☒A] at the end", end),
            hull("by how much less 24 h after [A]", [(least - high, most - low)], 0.0, math.inf),
        ),
        runs_needed=most_runs((runs_for_margin(end[DECIDES], ALIKE), needed(end))),
    )
