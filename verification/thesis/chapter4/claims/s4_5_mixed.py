"""Chapter 4, section 4.5 and (Q5): mixed groups of EMT cells, by the kept tables of the complete studies."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio
from verification.claims import Evidence, Interval, Tables, Verdict, at_least, at_most
from verification.thesis.chapter4.frequencies import (
    CATEGORIES,
    DECIDES,
    RATIOS,
    category,
    in_models,
    more,
    needed,
    ratio_of,
    told,
)
from verification.thesis.chapter4.ratio_claims import CLAIM_LEVEL
from verification.thesis.text.quoted import claim

# The middle row of Table 5, whose cells Figure 22 shows.
MIDDLE = "table5_35"


def mixed(tables: Tables, study: str, events: str, inm: str) -> Ratio:
    """Cells with these events, in any order, in a group of Table 5."""
    names = ("[AB]", "[BA]") if events == "[A] and [B]" else (events,)
    return category(tables, study, *(f"{name}{inm}" for name in names))


def like(tables: Tables, suffix: str, events: str, inm: str) -> Ratio:
    """Cells with these events at any time in a group in which all have them."""
    return ratio_of(tables, f"questions{suffix}", f"{events} at any time{inm}, 10 cells", "basal")


def against_like(tables: Tables, events: str, inm: str, sign: int) -> dict[str, Difference]:
    """Mixed minus homogeneous groups, or the other way round."""

    def find(suffix: str) -> Difference:
        sides = (mixed(tables, f"{MIDDLE}{suffix}", events, inm), like(tables, suffix, events, inm))
        more_often, less_often = sides[::sign]
        return Difference(more_often, less_often)

    return in_models(find)


def _mixed(tables: Tables, inm: str, sign: int, kinds: tuple[str, ...]) -> Evidence:
    found = {events: against_like(tables, events, inm, sign) for events in kinds}
    what = "mixed minus homogeneous" if sign > 0 else "homogeneous minus mixed"
    lines = "; ".join(f"{events}{inm} {told(each)}" for events, each in found.items())
    return Evidence(
        f"Basal extrusion in groups of ten, {what}, 35 % [P]: {lines}.",
        printed=tuple(more(f"{events}{inm}, {what}", each) for events, each in found.items()),
        runs_needed=needed(*found.values()),
    )


@claim(
    "c4.mixed-with-inm",
    "Cells with INM leave basally less often in a mixed group than among cells with the same events.",
    "section 4.5.1",
    needs=(CATEGORIES, RATIOS),
    chosen="the group '35 % [P]'; homogeneous: the same events, each cell at its own time",
)
def _with_inm(tables: Tables) -> Evidence:
    return _mixed(tables, "", -1, ("[A]", "[A] and [B]"))


@claim(
    "c4.mixed-without-inm",
    "Cells without INM leave basally more often in a mixed group than among cells with the same events.",
    "section 4.5.2",
    Verdict.CORRECTED,
    needs=(CATEGORIES, RATIOS),
    chosen="the group '35 % [P]'; homogeneous: the same events, each cell at its own time",
)
def _no_inm(tables: Tables) -> Evidence:
    every = _mixed(tables, " no INM", 1, ("[A]", "[B]", "[A] and [B]"))
    return replace(every, corrected=_mixed(tables, " no INM", 1, ("[A]",)).printed)


def gains(tables: Tables) -> dict[str, Interval]:
    """Mixed minus homogeneous groups, for the kinds of cells of Figures 17 to 19, in the model that decides."""
    return {
        f"{events}{inm}": against_like(tables, events, inm, 1)[DECIDES].interval(CLAIM_LEVEL)
        for inm in ("", " no INM")
        for events in ("[A]", "[B]", "[A] and [B]")
    }


@claim(
    "c4.q5-mixed",
    "Of the six kinds of cells of Figures 17 to 19 more than half leave basally more often in mixed groups.",
    "section 4.7, (Q5)",
    Verdict.CORRECTED,
    needs=(CATEGORIES, RATIOS),
    chosen="the group '35 % [P]'; most: more than half of [A], [B] and both, with and without INM",
)
def _q5_mixed(tables: Tables) -> Evidence:
    """How many kinds gain: those beyond chance at least, and all but those that lose beyond chance at most."""
    found = gains(tables)
    gain, lose = ([kind for kind, (low, high) in found.items() if sign * low > 0 < sign * high] for sign in (1, -1))
    least, most = len(gain), len(found) - len(lose)
    sizes = (against_like(tables, "[A] and [B]", inm, 1) for inm in ("", " no INM"))
    return Evidence(
        f"Of {len(found)} kinds in groups of ten {', '.join(gain)} leave more often in a mixed group than among their "
        f"like, {', '.join(lose)} less often, beyond chance; so at least {least} and at most {most} gain.",
        printed=(at_least("kinds that gain", (least + most) / 2, len(found) // 2 + 1, interval=(least, most)),),
        corrected=(
            at_least("[A] without INM, mixed minus homogeneous", found["[A] no INM"][0], 0.0),
            *(at_most(f"{kind}, mixed minus homogeneous", found[kind][1], 0.0) for kind in ("[A]", "[A] and [B]")),
        ),
        runs_needed=needed(*sizes),
    )


@claim(
    "c4.almost-double",
    "Cells with [A] and without INM leave basally almost twice as often in a mixed group as alone.",
    "section 4.5.2, Figure 18",
    Verdict.CORRECTED,
    needs=(CATEGORIES, RATIOS),
    chosen="the group '35 % [P]'; alone and in a homogeneous group: [A] at any time, as in the mixed one",
)
def _double(tables: Tables) -> Evidence:
    def beside(suffix: str, cells: str) -> Difference:
        like_them = ratio_of(tables, f"questions{suffix}", f"[A] at any time no INM{cells}", "basal")
        return Difference(mixed(tables, f"{MIDDLE}{suffix}", "[A]", " no INM"), like_them)

    alone, group = (in_models(partial(beside, cells=cells)) for cells in ("", ", 10 cells"))
    less = {preset: Difference(each.second, each.first) for preset, each in alone.items()}
    return Evidence(
        f"Basal extrusion of cells with [A] and without INM, 35 % [P]: mixed minus alone {told(alone)}; mixed minus "
        f"homogeneous {told(group)}.",
        printed=(more("mixed minus alone", alone),),
        corrected=(more("alone minus mixed", less), more("mixed minus homogeneous", group)),
        runs_needed=needed(alone, group),
    )


def crowded_out(tables: Tables, suffix: str, events: str) -> Difference:
    """Basal extrusion of cells without INM, among few cells with [P] minus that among many."""
    few, many = (mixed(tables, f"table5_{percent}{suffix}", events, " no INM") for percent in (7, 63))
    return Difference(few, many)


@claim(
    "c4.competition",
    "The more cells of a group have [P], the fewer of those without [P] and without INM leave basally.",
    "Figure 19",
    needs=(CATEGORIES,),
)
def _competition(tables: Tables) -> Evidence:
    events = ("[A]", "[B]", "[A] and [B]")
    found = {name: in_models(partial(crowded_out, tables, events=name)) for name in events}
    return Evidence(
        "Basal extrusion of cells without INM among 7 % with [P] minus that among 63 %: "
        f"{'; '.join(f'{name} {told(each)}' for name, each in found.items())}.",
        printed=tuple(more(f"{name} no INM, 7 % [P] minus 63 % [P]", each) for name, each in found.items()),
        runs_needed=needed(*found.values()),
    )
