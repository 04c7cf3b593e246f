"""Chapter 4, section 4.2: isolated cells without INM, and with [S], by the kept tables of the complete studies."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio
from verification.claims import Evidence, Tables, Verdict
from verification.thesis.chapter4.claims.s4_1_isolated import of_event
from verification.thesis.chapter4.frequencies import (
    MODEL,
    OUTCOMES,
    RATIOS,
    Sized,
    alike,
    evidence,
    in_readings,
    minus,
    more,
    ratio_of,
)
from verification.thesis.text.quoted import claim

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
