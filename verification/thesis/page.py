"""What holds: every statement of the thesis with its verdict and evidence, and the corrections that change results."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from verification.claim import Effect
from verification.decide import decide_all, differing
from verification.evidence import Kind
from verification.page.report import Chapter, Context, Grid, Search, Section, Statements, Text
from verification.thesis.errata import errata
from verification.thesis.register import chapter_of, register

TITLES = {
    0: "Introduction",
    1: "Differential inclusions (chapter 1)",
    2: "First-order PBD (chapter 2)",
    3: "Growing tissue and its minimisers (chapter 3 and appendix 1)",
    4: "Epithelial-to-mesenchymal transitions (chapter 4)",
    5: "The mean-field limit of constrained particles (chapter 5 and appendix 2)",
    6: "Conclusions",
}
CORRECTIONS = {
    "id": "Statement",
    "source": "Source",
    "quote": "As printed",
    "correction": "To be read",
    "effect": "Changes",
    "depends": "What depends on it",
}
ERRATA = {"id": "Remark", "source": "Source", "printed": "As printed", "corrected": "To be read"}
ERRATA |= {"depends": "What depends on it"}
# The most serious first; what only concerns notation changes no result.
SERIOUS = [effect.value for effect in Effect if effect is not Effect.NOTATION]


def run(context: Context) -> None:
    """Decide every claim, those about studies from the tables of the other chapters."""
    claims = register()
    table = decide_all(claims, context.tables, context.folder, context.executor)
    table.insert(1, "chapter", [chapter_of(claim) for claim in claims])
    context.keep("claims", table)
    context.keep("claims_errata", errata())


def sections(context: Context) -> Sequence[Section]:
    """Counts, the corrections that change results, and all statements in the order of the thesis, to be searched."""
    table = context.tables["claims"]
    found = [_counts(table), _corrections(table), _errata(context.tables["claims_errata"])]
    found.append(Section("All statements, to be searched", [Search()]))
    for number, title in TITLES.items():
        rows = table[table["chapter"] == number]
        if not rows.empty:
            found.append(Section(title, [Statements(rows)]))
    return found


def _counts(table: pd.DataFrame) -> Section:
    counts = pd.crosstab(table["chapter"], table["verdict"])
    counts = counts.reindex(columns=[kind.value for kind in Kind], fill_value=0)
    counts.insert(0, "Chapter", [TITLES[number] for number in counts.index])
    total = table["verdict"].value_counts()
    told = ", ".join(f"{total.get(kind.value, 0)} {kind.value}" for kind in Kind)
    text = (
        f"{len(table)} statements of the thesis were decided by computation: {told}. “Holds after the correction” "
        "means that the statement is false as printed, and that what is to be read instead was confirmed by the same "
        "check; “inconclusive”, that an interval is too wide or a solver failed. Of each check stand what was measured "
        "and the range that the statement wants."
    )
    other = differing(table)
    if not other.empty:
        text += f" The verdicts of {', '.join(other['id'])} are not the recorded ones."
    return Section(
        "How the statements came out", [Text(text), Grid(counts, "Statements by chapter and verdict.", "claims")]
    )


def _corrections(table: pd.DataFrame) -> Section:
    wrong = corrections(table)
    steps = wrong["effect"] == Effect.PROOF.value
    counted = ", ".join(f"{count} {effect}" for effect, count in wrong["effect"].value_counts(sort=False).items())
    shown = wrong[list(CORRECTIONS)].rename(columns=CORRECTIONS)
    return Section(
        "Corrections that change results",
        [
            Text(
                f"{len(wrong)} statements are wrong as printed and something else follows if they are put right, the "
                f"most serious first: {counted}. Corrections of notation only are among the statements below."
            ),
            Grid(shown[~steps], "Corrections of conclusions, of the model or method, and of numbers.", "claims"),
            Grid(shown[steps], "Corrections of steps of proofs whose result stands", "claims", folded=True),
        ],
    )


def _errata(table: pd.DataFrame) -> Section:
    text = (
        f"{len(table)} slips of notation, a dot, an index, a bracket, a label or a type, change no result, and no "
        "measurement decides them."
    )
    shown = table[list(ERRATA)].rename(columns=ERRATA)
    return Section("Errata of notation", [Text(text), Grid(shown, "Errata of notation.", "claims_errata")])


def corrections(table: pd.DataFrame) -> pd.DataFrame:
    """The statements that do not hold as printed and whose correction changes a result, the most serious first."""
    wrong = table[table["verdict"].isin([Kind.CORRECTED.value, Kind.FAILS.value]) & table["effect"].isin(SERIOUS)]
    return wrong.sort_values("effect", key=lambda column: column.map(SERIOUS.index), kind="stable")


# It reads the tables of all other chapters.
CHAPTER = Chapter("What holds", run, sections, place=8)
