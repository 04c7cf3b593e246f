"""Chapter 4, section 4.2: isolated cells without INM, and with [S], by the kept tables of the complete studies."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from tissue.statistics.comparisons import Difference
from tissue.statistics.ratios import Ratio
from verification.claims import Comparison, Evidence, Tables, Verdict
from verification.thesis.chapter4.frequencies import (
    DECIDES,
    RATIOS,
    hull,
    in_models,
    more,
    most_runs,
    needed,
    of_event,
    ratio_of,
    runs_for_margin,
    told,
)
from verification.thesis.chapter4.ratio_claims import CLAIM_LEVEL
from verification.thesis.chapter4.studies import PRESETS
from verification.thesis.text.quoted import claim

# By so much [S] may change a ratio if it is 'mostly irrelevant'; the evidence says which limits decide alike.
LITTLE = 0.2


def of_still(tables: Tables, suffix: str, event: str, what: str) -> Ratio:
    """An isolated cell without INM, Figure 12."""
    return ratio_of(tables, f"figure12{suffix}", f"{event} no INM", what)


def stopped(tables: Tables, suffix: str, event: str, what: str) -> Difference:
    """What stopping INM adds to basal extrusion, or takes from apical extrusion."""
    still, moving = of_still(tables, suffix, event, what), of_event(tables, suffix, event, what)
    return Difference(still, moving) if what == "basal" else Difference(moving, still)


@claim(
    "c4.without-inm",
    "An isolated cell with [A] or [B] leaves more often basally and less often apically without INM.",
    "section 4.2.1",
    needs=(RATIOS,),
)
def _without_inm(tables: Tables) -> Evidence:
    found = {
        f"{event} {what}": in_models(partial(stopped, tables, event=event, what=what))
        for event in ("[A]", "[B]")
        for what in ("basal", "apical")
    }
    return Evidence(
        "More basal and less apical extrusion without INM: "
        f"{'; '.join(f'{name} {told(each)}' for name, each in found.items())}.",
        printed=tuple(more(f"{name} extrusion", each) for name, each in found.items()),
        runs_needed=needed(*found.values()),
    )


@claim(
    "c4.inm-swaps",
    "Without INM [B] extrudes more cells basally than [A], with INM fewer.",
    "Figure 12",
    needs=(RATIOS,),
)
def _swapped(tables: Tables) -> Evidence:
    still = in_models(lambda s: Difference(of_still(tables, s, "[B]", "basal"), of_still(tables, s, "[A]", "basal")))
    moving = in_models(lambda s: Difference(of_event(tables, s, "[A]", "basal"), of_event(tables, s, "[B]", "basal")))
    return Evidence(
        f"Basal extrusion: without INM [B] minus [A] {told(still)}; with INM [A] minus [B] {told(moving)}.",
        printed=(more("[B] minus [A], without INM", still), more("[A] minus [B], with INM", moving)),
        runs_needed=needed(still, moving),
    )


@claim(
    "c4.drift",
    "A cell that stops INM comes to lie below all others more often, without an event and with [S].",
    "Figure 12, section 4.2.1",
    needs=(RATIOS,),
)
def _drift(tables: Tables) -> Evidence:
    """A cell without any event, and one with [S] alone."""
    none = in_models(
        lambda s: Difference(
            ratio_of(tables, f"figure12{s}", "no EMT no INM", "below"),
            ratio_of(tables, f"figure15{s}", "no EMT", "below"),
        )
    )
    loose = in_models(lambda s: Difference(of_still(tables, s, "[S]", "below"), of_event(tables, s, "[S]", "below")))
    return Evidence(
        f"Cells below all control cells without INM minus with it: no event {told(none)}; [S] {told(loose)}.",
        printed=(more("no event", none), more("[S]", loose)),
        runs_needed=needed(none, loose),
    )


def by_straightness(tables: Tables, suffix: str) -> dict[str, Difference]:
    """[S] beside a cell without any event, with INM and without it; the two models differ in what [S] does."""
    without = {"": f"figure15{suffix}", " no INM": f"figure12{suffix}"}
    loose = {"": f"figure10{suffix}", " no INM": f"figure12{suffix}"}
    return {
        f"{what}{inm}": Difference(
            ratio_of(tables, loose[inm], f"[S]{inm}", what), ratio_of(tables, without[inm], f"no EMT{inm}", what)
        )
        for what in ("basal", "apical")
        for inm in loose
    }


def largest(found: dict[str, Difference], end: Callable[[float, float], float]) -> float:
    """The largest change, by the near end (min) or the far end (max) of its interval."""
    ends = (tuple(map(abs, each.interval(CLAIM_LEVEL))) for each in found.values())
    return max(end(*each) for each in ends)


@claim(
    "c4.straightness",
    "A cell whose bending spring is set to no stiffness leaves hardly more often than one without event.",
    "sections 4.2.2, 2.2.3",
    Verdict.CORRECTED,
    needs=(RATIOS,),
    chosen=f"mostly irrelevant: a change of less than {100 * LITTLE:.0f} points",
)
def _straightness(tables: Tables) -> Evidence:
    straight, kept = (by_straightness(tables, PRESETS[preset]) for preset in (DECIDES, "published"))

    def changes(found: dict[str, Difference], alpha: int) -> tuple[Comparison, ...]:
        return tuple(
            hull(f"change of {what} extrusion, α^axb := {alpha}", [each.interval(CLAIM_LEVEL)], -LITTLE, LITTLE)
            for what, each in found.items()
        )

    def points(found: dict[str, Difference]) -> str:
        return ", ".join(f"{what} {100 * each.value:+.0f}" for what, each in found.items())

    return Evidence(
        f"By [S] extrusion changes, if α^axb := 0, by {points(straight)} points; in the published runs, "
        f"which set it to 1 of 15, by {points(kept)}. Every limit between {100 * largest(kept, max):.0f} and "
        f"{100 * largest(straight, min):.0f} points decides alike.",
        printed=changes(straight, 0),
        corrected=changes(kept, 1),
        runs_needed=most_runs(runs_for_margin(each, LITTLE) for each in kept.values()),
    )
