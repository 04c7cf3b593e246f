"""The claims of the thesis: verdicts and evidence, counts, readings of the model, errata."""

from __future__ import annotations

import pandas as pd

from dincl.study import write
from verification.claims import Effect, Verdict
from verification.claims.decide import READING, decide_all, readings
from verification.claims.graph import corrected_below
from verification.site.context import Context
from verification.thesis.register import chapter_of, errata, register

ERRATA = {
    "id": "Erratum",
    "source": "Place",
    "printed": "As printed",
    "corrected": "Corrected",
    "effect": "Changes",
    "depends": "What depends on it",
    "why": "Why",
}
WRONG = (Verdict.CORRECTED.value, Verdict.REFUTED.value)  # as printed


def run(context: Context) -> None:
    """Decide every claim, those about studies from the tables of the other pages."""
    claims = register()
    wrong = corrected_below(claims)
    table = decide_all(claims, context.tables, context.executor)
    table.insert(1, "chapter", [chapter_of(claim) for claim in claims])
    table["runs"] = [", ".join(name for name in claim.needs if name in context.tables) for claim in claims]
    table["wrong"] = [", ".join(wrong[claim.id]) for claim in claims]
    context.tables["claims"] = table
    write(table, context.folder / "claims.parquet")


def show(context: Context) -> None:
    """Give the counts, the claims that the readings of the model decide differently, and the errata."""
    table, others = context.tables["claims"], errata()
    counts = pd.crosstab(table["chapter"], table["verdict"])
    counts = counts[[verdict.value for verdict in Verdict if verdict.value in counts]].rename_axis(index="Chapter")
    context.show("claims", counts.reset_index())
    columns = readings(table)
    if columns:
        differ = table[(table[columns] != "").all(axis=1) & (table[columns].nunique(axis=1) > 1)]
        names = {column: column.removeprefix(READING).capitalize() for column in columns}
        shown = {"id": "Claim", "statement": "Statement", "verdict": "Verdict"} | names
        context.show("readings", differ[list(shown)].rename(columns=shown), "claims")
    context.keep("errata", others)
    context.show("errata", others[list(ERRATA)].rename(columns=ERRATA))
    wrong = pd.concat([table.loc[table["verdict"].isin(WRONG), "effect"], others["effect"]])
    context.numbers["claims"] = str((wrong == Effect.CONCLUSION.value).sum())
