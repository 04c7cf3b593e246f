"""The register of claims."""

from __future__ import annotations

from collections.abc import Sequence

from verification.claim import Kind
from verification.register import decided
from verification.report import Chapter, Context, Grid, Section, Text

HEADINGS = {"source": "Source", "quote": "As printed", "measured": "Measured", "verdict": "Verdict"}

TITLES = {
    1: "Differential inclusions (chapter 1)",
    2: "First-order PBD (chapter 2)",
    3: "Growing tissue and its minimisers (chapter 3 and appendix 1)",
    4: "Epithelial-to-mesenchymal transitions (chapter 4)",
    5: "The mean-field limit of constrained particles (chapter 5 and appendix 2)",
}


def run(context: Context) -> None:
    """Decide every claim from the tables of the other chapters."""
    context.keep("claims", decided(context.tables))


def sections(context: Context) -> Sequence[Section]:
    """A count, and one table for each chapter of the thesis."""
    table = context.tables["claims"]
    counts = table["verdict"].value_counts()
    counted = ", ".join(f"{counts.get(kind.value, 0)} {kind.value}" for kind in Kind)
    found = [
        Section(
            "How the statements came out",
            [
                Text(
                    f"{len(table)} statements of the thesis were checked by machine: {counted}. “Holds with "
                    "correction” means that the sentence as printed is false and the correction beside it is what "
                    "was confirmed."
                )
            ],
        )
    ]
    for number, title in TITLES.items():
        rows = table[table["id"].str.startswith(f"c{number}.")][list(HEADINGS)].rename(columns=HEADINGS)
        found.append(Section(title, [Grid(rows, "Statements, in the order of the thesis.", "claims")]))
    return found


CHAPTER = Chapter("Statements of the thesis", run, sections)
