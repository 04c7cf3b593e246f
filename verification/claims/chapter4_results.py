"""Chapter 4: what it concludes from its runs, beside the complete studies."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

from tissue.study.comparisons import ALIKE, CLAIM_LEVEL, Difference
from tissue.study.questions import QUESTIONS
from tissue.study.ratios import Ratio, as_ratio
from verification.claim import Claim, Kind, Tables, Verdict, corrected_if, holds_if
from verification.emt.studies import PRESETS


def _partition(tables: Tables) -> Verdict:
    """Positions at the onset outside (0, 1]: in no D_k."""
    found = tables["emt_complete_outside"].iloc[0]
    share = float(found["outside"]) / float(found["of"])
    return corrected_if(
        share == 0,
        share < 1,
        f"{found['outside']} of {found['of']} cells ({100 * share:.2f} %) begin outside of (0, 1], where no D_k is: "
        "two unbounded intervals more make it a partition",
    )


def _printed(tables: Tables) -> Verdict:
    table = tables["emt_complete_printed"]
    counts = table.groupby(["preset", "time_h"], sort=False)["agrees"].agg(["sum", "size"])
    agreeing = counts["sum"] == counts["size"]
    told = "; ".join(
        f"{preset} preset at {t:g} h: {row['sum']} of {row['size']}" for (preset, t), row in counts.iterrows()
    )
    return corrected_if(
        bool(agreeing["thesis"].any()),
        bool(agreeing["published"].any()),
        f"within the joint 99 % interval: {told}. They are those of the published runs; the model as printed extrudes "
        "fewer cells basally",
    )


def _ratio(tables: Tables, study: str, scenario: str, what: str) -> Ratio:
    table = tables["emt_complete_ratios"].set_index(["study", "scenario", "what"])
    return as_ratio(table.loc[(study, scenario, what)])


def _mostly_basally(tables: Tables) -> Verdict:
    """More cells with [A] leave apically than basally; but of those that stay most come to lie below all others."""
    out, below, told = [], [], []
    for preset, suffix in PRESETS.items():
        basal, apical, low = (_ratio(tables, f"figure10{suffix}", "[A]", what) for what in ("basal", "apical", "below"))
        out.append(Difference(basal, apical).interval(CLAIM_LEVEL)[0] > 0)
        below.append(Difference(low, apical).interval(CLAIM_LEVEL)[0] > 0)
        told.append(f"{preset} preset: basally {basal}, apically {apical}, below all control cells {low}")
    return corrected_if(all(out), all(below), "; ".join(told))


def _without_inm(tables: Tables) -> Verdict:
    found, told = [], []
    for preset, suffix in PRESETS.items():
        for event in ("[A]", "[B]"):
            changes = {
                what: Difference(
                    _ratio(tables, f"figure12{suffix}", f"{event} no INM", what),
                    _ratio(tables, f"figure10{suffix}", event, what),
                )
                for what in ("basal", "apical")
            }
            found.append(changes["basal"].interval(CLAIM_LEVEL)[0] > 0 > changes["apical"].interval(CLAIM_LEVEL)[1])
            told.append(f"{preset} preset, {event}: basal {changes['basal']}, apical {changes['apical']}")
    return holds_if(all(found), "; ".join(told))


def _straightness(tables: Tables) -> Verdict:
    """[S] beside a cell without any event, with INM, in the model as printed and in the published one."""
    alike, told = [], []
    for preset, suffix in PRESETS.items():
        change = Difference(
            _ratio(tables, f"figure10{suffix}", "[S]", "apical"),
            _ratio(tables, f"figure15{suffix}", "no EMT", "apical"),
        )
        low, high = change.interval(CLAIM_LEVEL)
        alike.append(low > -ALIKE and high < ALIKE)
        told.append(f"{preset} preset: apical extrusion changes by {change}")
    return holds_if(all(alike), "; ".join(told))


def _answer(question: str) -> Callable[[Tables], Verdict]:
    """What the heterogeneous and the isolated studies say of an answer of section 4.7, by the published model, too."""

    def check(tables: Tables) -> Verdict:
        table = tables["emt_complete_answers"]
        mine = table[table["id"] == question].set_index("preset")["verdict"]
        told = ", ".join(f"{preset} preset: {verdict}" for preset, verdict in mine.items())
        kinds = {"holds": Kind.HOLDS, "does not hold": Kind.FAILS, "not decided": Kind.OPEN}
        same = len(set(mine)) == 1
        return Verdict(kinds[mine.iloc[0]] if same else Kind.OPEN, f"{told}; the numbers are in the chapter on EMT")

    return check


CLAIMS = (
    Claim(
        "c4.partition",
        "Section 3.3.4 of chapter 4",
        "(0, 1/n^D] ∪ … ∪ ((n^D−1)/n^D, 1] = [0, 1], a partition of the positions at the onset.",
        _partition,
        needs=("emt_complete_outside",),
    ),
    Claim(
        "c4.isolated",
        "Figures 10, 12 and section 4.2.1 of chapter 4",
        "[A] 30 % apically, 10 % basally, without INM 20 %; [B] 0 %, without INM 70 %.",
        _printed,
        needs=("emt_complete_printed",),
    ),
    Claim(
        "c4.mostly-basally",
        "Section 4.1.2 of chapter 4",
        "[A] drives cells out of the tissue, mostly basally.",
        _mostly_basally,
        needs=("emt_complete_ratios",),
    ),
    Claim(
        "c4.without-inm",
        "Section 4.2.1 of chapter 4",
        "Stopped INM leads to more basal and less apical extrusion.",
        _without_inm,
        needs=("emt_complete_ratios",),
    ),
    Claim(
        "c4.straightness",
        "Section 4.2.2 of chapter 4",
        "[S] is mostly irrelevant.",
        _straightness,
        needs=("emt_complete_ratios",),
    ),
    *(
        Claim(
            f"c4.{name.lower()}",
            f"Section 4.7, ({name})",
            f"{question.text} {question.thesis}",
            _answer(name),
            needs=("emt_complete_answers",),
        )
        for name, question in QUESTIONS.items()
    ),
)
