"""EMT: what makes cells leave the tissue, by the studies of chapter 4, beside what the thesis says."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from verification.page import cards
from verification.page.context import Context
from verification.page.parts import Section
from verification.page.prose import fill
from verification.page.report import Card, Chapter, Finding
from verification.thesis.chapter4 import kept, studies
from verification.thesis.chapter4 import sections as page
from verification.thesis.chapter4.questions import ANSWERS, answered

PROSE = Path(__file__).parent / "prose"
# The first page shows so many factors, by short names.
CARD = 5
SHORT = {"A": "[A]", "B": "[B]", "S": "[S]", "P": "protrusions", "inm": "INM", "onset": "place at the onset"}
SHORT |= {f"{event} time": f"time of [{event}]" for event in "ABSP"}
# The factors of the ranking in words.
FACTORS = {
    "A": "the loss of apical adhesion [A]",
    "B": "the loss of basal adhesion [B]",
    "S": "the loss of straightness [S]",
    "P": "protrusions [P]",
    "inm": "interkinetic nuclear movement",
    "onset": "the place of the nucleus at the onset",
} | {f"{event} time": f"the time of [{event}]" for event in "ABSP"}


def run(context: Context) -> None:
    """Complete the studies of the form, and sum them up; beside a short form stand the kept tables."""
    form = context.form(studies.FULL if context.full else studies.SHORT)
    results = studies.watched(studies.chosen(form), page.folder(context), context.executor)
    for name, table in (kept.COMPLETE if context.full else kept.TABLES).items():
        context.keep(f"emt_{name}", table(results))
    complete = kept.tables()
    if context.full:
        complete = {f"{kept.COMPLETE_PREFIX}{name}": context.tables[f"emt_{name}"] for name in kept.COMPLETE}
    for name, table in complete.items():
        context.keep(name, table)
    context.keep(ANSWERS, answered(context.tables))


def sections(context: Context) -> Sequence[Section]:
    """From the isolated cell to the heterogeneous group, the eight questions, and what the short form says."""
    return page.sections(context)


def findings(context: Context) -> Sequence[Finding]:
    """What matters most for cells that leave, by the complete studies, which ship."""
    ranking = context.tables[f"{kept.COMPLETE_PREFIX}ranking"]
    mine = ranking[ranking["preset"] == "published"].sort_values("value", ascending=False)
    first, second, third, *_ = mine.itertuples()
    said = fill(PROSE / "learned_emt.html", names=FACTORS, first=first, second=second, third=third)
    most = mine.head(CARD)
    names = [SHORT[factor] for factor in most["factor"]]
    ends = list(zip(most["low"], most["high"], strict=True))
    label = "log loss of a prediction without it [nats]"
    picture = context.draw("card_emt", cards.bars, names, list(most["value"]), ends, label)
    return [Finding(said["factors"], page.TITLES["positions"], Card(picture, said["card"], 5))]


CHAPTER = Chapter(
    "emt",
    "EMT",
    "What makes cells leave an epithelium, and do the printed ratios come out again?",
    run,
    sections,
    findings,
    place=10,
    tables=("emt_",),
)
