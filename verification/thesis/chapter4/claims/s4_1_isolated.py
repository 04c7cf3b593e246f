"""Chapter 4, sections 4.1 to 4.3: isolated cells with INM and without, by the kept tables of the complete studies."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio, as_ratio
from verification.claims import Comparison, Evidence, Tables, Verdict, at_most
from verification.thesis.chapter4.frequencies import (
    ALIKE,
    CLAIM_LEVEL,
    MODEL,
    OUTCOMES,
    PERCENT,
    RATIOS,
    Sized,
    alike,
    evidence,
    exclusive,
    in_readings,
    minus,
    more,
    ratio_of,
    share,
)
from verification.thesis.chapter4.studies import PRESETS
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
    rests_on=("c3.dimensions",),
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
        f"Printed ratios that agree with the measured ones: {'; '.join(lines)}.",
        printed=(at_most(f"{what}, model as printed", int(off["thesis"]), 0),),
        corrected=(at_most(f"{what}, published runs", int(off["published"]), 0),),
    )


def of_event(tables: Tables, preset: str, event: str, what: str) -> Ratio:
    """Return how often an isolated cell with INM and one event ends so, Figure 10."""
    return ratio_of(tables, preset, "figure10", event, what)


@claim(
    "c4.protrusions",
    "Far more isolated cells leave basally with protrusions than by any other single event.",
    "section 4.1.1, Figure 10",
    needs=(RATIOS,),
    chosen="far more: by at least half of all cells",
)
def _protrusions(tables: Tables) -> Evidence:
    def lead(preset: str, event: str) -> Difference:
        return minus(of_event(tables, preset, each, "basal") for each in ("[BP]", event))

    return in_readings(
        lambda preset: evidence(
            [more(f"basal extrusion, [BP] minus {event}", lead(preset, event), HALF) for event in ("[A]", "[B]", "[S]")]
        )
    )


@claim(
    "c4.remain",
    "More than half of the cells with [B], and of those with [S], are not above or below the others.",
    "Figure 10",
    needs=(RATIOS,),
)
def _remain(tables: Tables) -> Evidence:
    def remain(preset: str, event: str) -> Sized:
        out, below = (of_event(tables, preset, event, what) for what in ("apical", "below"))
        left = Ratio(out.of - out.count - below.count, out.of)
        return share(f"cells with {event} neither above the tissue nor below all control cells", left, HALF)

    return in_readings(lambda preset: evidence([remain(preset, event) for event in ("[B]", "[S]")]))


@claim(
    "c4.mostly-basally",
    "Of the cells that [A] drives out of the tissue most leave basally.",
    "sections 4.1, 4.1.2",
    Verdict.CORRECTED,
    needs=(RATIOS,),
    rests_on=("c4.contained",),
)
def _mostly_basally(tables: Tables) -> Evidence:
    """The ratios are of the same cells."""

    def compare(preset: str) -> Evidence:
        basal, apical, below = (of_event(tables, preset, "[A]", what) for what in ("basal", "apical", "below"))
        return evidence(
            [more("cells with [A], basal minus apical extrusion", exclusive(basal, apical))],
            [
                more("cells with [A], below all control cells minus apically extruded", exclusive(below, apical)),
                more("cells with [A], apical minus basal extrusion", exclusive(apical, basal)),
            ],
        )

    return in_readings(compare)


@claim(
    "c4.apical",
    "Isolated cells with [A], [B] or [BP] leave apically, too, those with [BP] rarely.",
    "sections 4.1.1, 4.1.3",
    needs=(RATIOS,),
    chosen=f"too: {SOME:.0%} of the cells, at least; a small number: up to {FEW:.0%}",
)
def _apical(tables: Tables) -> Evidence:
    most = {"[A]": math.inf, "[B]": math.inf, "[BP]": FEW}
    return in_readings(
        lambda preset: evidence(
            [
                share(f"apical extrusion, {event}", of_event(tables, preset, event, "apical"), SOME, high)
                for event, high in most.items()
            ]
        )
    )


@claim(
    "c4.timing-isolated",
    "An isolated cell leaves basally as often whether [A] is early and [B] late, or the other way round.",
    "section 4.3, Table 3",
    Verdict.CORRECTED,
    needs=(RATIOS, SINCE),
    chosen=f"the programs of Table 3 with the longest delays; alike: within {ALIKE:.0%} of the cells; "
    "the end of the runs, and 24 h after [A]",
)
def _timing(tables: Tables) -> Evidence:
    """Whether the end shows a difference, and whether counting from [A] on makes it smaller."""
    rows = tables[SINCE].set_index(["study", "scenario"])

    def compare(preset: str) -> Evidence:
        at_end = minus(ratio_of(tables, preset, "figure14", name, "basal") for name in PROGRAMS)
        since = minus(as_ratio(rows.loc[("figure14" + PRESETS[preset], name)]) for name in PROGRAMS)
        (least, most), (low, high) = (each.interval(CLAIM_LEVEL) for each in (at_end, since))
        less = (PERCENT * (least - high), PERCENT * (most - low))
        smaller = Comparison("the same, end minus 24 h after [A] [points]", sum(less) / 2, 0.0, math.inf, less)
        what = "basal extrusion at the end, [A☒B] minus [B☒A]"
        return evidence([alike(what, at_end)], [more(what, at_end), Sized(smaller, None)])

    return in_readings(compare)


# By so much [S] may change a ratio if it is 'mostly irrelevant'.
LITTLE = 0.2


def of_still(tables: Tables, preset: str, event: str, what: str) -> Ratio:
    """Return how often an isolated cell without INM ends so, Figure 12."""
    return ratio_of(tables, preset, "figure12", f"{event} no INM", what)


@claim(
    "c4.without-inm",
    "An isolated cell with [A] or [B] leaves more often basally and less often apically without INM.",
    "section 4.2.1",
    needs=(RATIOS,),
)
def _without_inm(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        found = []
        for event in ("[A]", "[B]"):
            for what, order, sign in (("basal", "without minus with INM", 1), ("apical", "with minus without INM", -1)):
                sides = (of_still(tables, preset, event, what), of_event(tables, preset, event, what))
                found.append(more(f"{what} extrusion, {event}, {order}", minus(sides[::sign])))
        return evidence(found)

    return in_readings(compare)


@claim(
    "c4.inm-swaps",
    "Without INM [B] extrudes more cells basally than [A], with INM fewer.",
    "Figure 12",
    needs=(RATIOS,),
)
def _swapped(tables: Tables) -> Evidence:
    def compare(preset: str) -> Evidence:
        still = minus(of_still(tables, preset, event, "basal") for event in ("[B]", "[A]"))
        moving = minus(of_event(tables, preset, event, "basal") for event in ("[A]", "[B]"))
        return evidence(
            [
                more("basal extrusion without INM, [B] minus [A]", still),
                more("basal extrusion with INM, [A] minus [B]", moving),
            ]
        )

    return in_readings(compare)


@claim(
    "c4.drift",
    "A cell that stops INM comes to lie below all others more often, without an event and with [S].",
    "Figure 12, section 4.2.1",
    needs=(RATIOS,),
)
def _drift(tables: Tables) -> Evidence:
    """A cell without any event, and one with [S] alone."""

    def compare(preset: str) -> Evidence:
        with_inm = {
            "no EMT": ratio_of(tables, preset, "figure15", "no EMT", "below"),
            "[S]": of_event(tables, preset, "[S]", "below"),
        }
        return evidence(
            [
                more(
                    f"below all control cells, {event}, without minus with INM",
                    Difference(of_still(tables, preset, event, "below"), ratio),
                )
                for event, ratio in with_inm.items()
            ]
        )

    return in_readings(compare)


def by_straightness(tables: Tables, preset: str) -> list[Sized]:
    """Compare [S] with a cell without any event, with INM and without it."""
    found = []
    for what in ("basal", "apical"):
        for inm, loose, none in (("", "figure10", "figure15"), (" no INM", "figure12", "figure12")):
            sides = ((loose, f"[S]{inm}"), (none, f"no EMT{inm}"))
            change = minus(ratio_of(tables, preset, *side, what) for side in sides)
            found.append(alike(f"{what} extrusion{inm}, [S] minus no EMT", change, LITTLE))
    return found


@claim(
    "c4.straightness",
    "A cell with [S] leaves hardly more often than one without any event.",
    "section 4.2.2",
    needs=(RATIOS,),
    chosen=f"mostly irrelevant: a change of less than {LITTLE:.0%} of the cells; [S] sets α^axb to 0 with the printed "
    "and with the corrected energies, to 1 of 15 in the published program",
)
def _straightness(tables: Tables) -> Evidence:
    return in_readings(lambda preset: evidence(by_straightness(tables, preset)))


@claim(
    "c4.straightness-rule",
    "[S] sets the stiffness of the bending spring to zero, and cells still behave like those without any event.",
    "sections 2.2.3, 4.2.2",
    Verdict.CORRECTED,
    needs=(RATIOS,),
    rests_on=("c4.straightness",),
    chosen=f"a change of less than {LITTLE:.0%} of the cells; corrected: the published program, whose energies differ "
    "from the printed ones, too",
)
def _straightness_rule(tables: Tables) -> Evidence:
    kept = by_straightness(tables, OUTCOMES)
    return in_readings(lambda preset: evidence(by_straightness(tables, preset), kept), MODEL)
