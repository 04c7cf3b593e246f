"""Page of all claims of the thesis: verdicts, evidence, corrections that change results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from verification.claims import Effect, Verdict
from verification.claims.decide import READING, decide_all, differing, readings
from verification.claims.graph import corrected_below
from verification.site import cards
from verification.site.context import Context
from verification.site.parts import Grid, SearchField, Section, Statements, Text
from verification.site.prose import fill
from verification.site.report import Card, Chapter, Finding
from verification.site.sources import write_source
from verification.thesis.chapter4.frequencies import READINGS, RULE
from verification.thesis.register import chapter_of, register
from verification.thesis.text.errata import errata

PROSE = Path(__file__).parent / "prose"
TITLES = {
    0: "Introduction",
    1: "Differential inclusions (chapter 1)",
    2: "First-order PBD (chapter 2)",
    3: "Growing tissue and its minimisers (chapter 3 and appendix 1)",
    4: "Epithelial-to-mesenchymal transitions (chapter 4)",
    5: "The mean-field limit of constrained particles (chapter 5 and appendix 2)",
    6: "Conclusions",
}
COLUMNS = {
    "corrections": {
        "id": "Claim",
        "source": "Place",
        "quote": "As printed",
        "correction": "Corrected",
        "effect": "Changes",
        "depends": "What depends on it",
    },
    "errata": {
        "id": "Erratum",
        "source": "Place",
        "printed": "As printed",
        "corrected": "Corrected",
        "depends": "What depends on it",
        "why": "Why",
    },
    "readings": {"id": "Claim", "statement": "Statement", "verdict": "Verdict"},
}
COUNTS = "How many claims hold"
BEFORE = "corrected"  # the reading that decided until now
WRONG = (Verdict.CORRECTED.value, Verdict.REFUTED.value)  # as printed
PROVED = (Verdict.PROVED.value, Verdict.PROVED_INSTANCE.value)
# The most serious first; what only concerns notation changes no result.
SERIOUS = [effect.value for effect in Effect if effect is not Effect.NOTATION]


def run(context: Context) -> None:
    """Decide every claim, those about studies from the tables of the other chapters; write the source of the checks."""
    claims = register()
    table = decide_all(claims, context.tables, context.executor)
    table.insert(1, "chapter", [chapter_of(claim) for claim in claims])
    table["runs"] = [", ".join(context.files_of(claim.needs)) for claim in claims]
    context.keep("claims", table)
    context.keep("claims_errata", errata())
    for module in dict.fromkeys(claim.module for claim in claims):
        write_source(module, context.out)


def sections(context: Context) -> Sequence[Section]:
    """Return the corrections that change results, counts, and all claims in the order of the thesis, to be searched."""
    table = context.tables["claims"]
    others = context.tables["claims_errata"]
    slips = others[others["effect"] == Effect.NOTATION.value]
    said = fill(PROSE / "statements.html", **_values(table, others), errata=len(slips))
    found = [_corrections(table, others, said), _counts(table, said), *_readings(table), _errata(slips, said)]
    found.append(Section("All claims", [SearchField()]))
    wrong = corrected_below(register())
    for number, title in TITLES.items():
        rows = table[table["chapter"] == number]
        if not rows.empty:
            found.append(Section(title, [Statements(rows, wrong)]))
    return found


def _values(table: pd.DataFrame, others: pd.DataFrame) -> dict[str, Any]:
    total, wrong = table["verdict"].value_counts(), corrections(table, others)
    return {
        "count": len(table),
        **{verdict.name.lower(): int(total.get(verdict.value, 0)) for verdict in Verdict},
        "other": list(differing(table)["id"]),
        "wrong": len(wrong),
        "conclusions": [
            f"{row['id']} ({row['source'].split(';')[0]})" for _, row in of_effect(wrong, Effect.CONCLUSION).iterrows()
        ],
        **{effect.name.lower(): len(of_effect(wrong, effect)) for effect in Effect},
        "proofs": int(table["verdict"].isin(PROVED).sum()),
    }


def _counts(table: pd.DataFrame, said: Mapping[str, str]) -> Section:
    counts = pd.crosstab(table["chapter"], table["verdict"])
    counts = counts[[verdict.value for verdict in Verdict if verdict.value in counts]]
    counts.insert(0, "Chapter", [TITLES[number] for number in counts.index])
    return Section(COUNTS, [Text(said["counts"]), Grid(counts, said["by_chapter"], "claims")])


def headed(rows: pd.DataFrame, columns: Mapping[str, str]) -> pd.DataFrame:
    """Return the named columns, in the order of ``columns``, under their headings."""
    return rows[list(columns)].rename(columns=columns)


def _corrections(table: pd.DataFrame, others: pd.DataFrame, said: Mapping[str, str]) -> Section:
    wrong = corrections(table, others)
    steps = wrong["effect"] == Effect.PROOF.value
    shown = headed(wrong, COLUMNS["corrections"])
    return Section(
        "Corrections that change results",
        [
            Text(said["corrections"]),
            Grid(shown[~steps], said["results"], "claims"),
            Grid(shown[steps], said["proofs"], "claims", folded=True),
        ],
    )


def _readings(table: pd.DataFrame) -> list[Section]:
    """Return the rule by which a reading of the model decides, and the claims that the readings decide differently."""
    columns = readings(table)
    if not columns:
        return []
    of_model = table[(table[columns] != "").all(axis=1)]
    differ = of_model[of_model[columns].nunique(axis=1) > 1]
    before = f"{READING}{READINGS[BEFORE]}"
    changed = [
        (row["id"], row[before], row["verdict"]) for _, row in differ[differ[before] != differ["verdict"]].iterrows()
    ]
    names = {column: column.removeprefix(READING).capitalize() for column in columns}
    said = fill(PROSE / "readings.html", rule=RULE, count=len(of_model), changed=changed, before=READINGS[BEFORE])
    grid = Grid(headed(differ, {**COLUMNS["readings"], **names}), said["table"], "claims")
    return [Section("How verdicts depend on the reading of the model", [Text(said["rule"]), grid])]


def _errata(table: pd.DataFrame, said: Mapping[str, str]) -> Section:
    shown = headed(table, COLUMNS["errata"])
    return Section("Errata of notation", [Text(said["errata"]), Grid(shown, said["slips"], "claims_errata")])


def corrections(table: pd.DataFrame, others: pd.DataFrame) -> pd.DataFrame:
    """Return what is wrong as printed and whose correction changes a result, claims and errata, most serious first."""
    slips = others.rename(columns={"printed": "quote", "corrected": "correction"})
    slips["id"] += slips["claim"].map(lambda name: f" (by {name})" if name else "")
    wrong = pd.concat([table[table["verdict"].isin(WRONG)], slips], ignore_index=True)
    wrong = wrong[wrong["effect"].isin(SERIOUS)]
    return wrong.sort_values("effect", key=lambda column: column.map(SERIOUS.index), kind="stable")


def of_effect(table: pd.DataFrame, effect: Effect) -> pd.DataFrame:
    """Return the corrections that change such a thing."""
    return table[table["effect"] == effect.value]


# It reads the tables of all other chapters.
def findings(context: Context) -> Sequence[Finding]:
    """Say what corrections change, and count the claims that hold."""
    table = context.tables["claims"]
    values = _values(table, context.tables["claims_errata"])
    said = fill(PROSE / "learned.html", **values)
    counts = {verdict: values[verdict.name.lower()] for verdict in Verdict}
    card = Card(context.draw("card_claims", cards.verdicts, counts), said["card"], 4)
    return [Finding(said["counts"], COUNTS, card)]


CHAPTER = Chapter(
    "statements",
    "Claims of the thesis",
    "Which claims of the thesis hold, which do not, and what depends on them?",
    run,
    sections,
    findings,
)
