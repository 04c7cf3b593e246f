"""The command ``tissue simplify``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tissue.cli.messages import messages, table
from tissue.cli.studies import File

OUTCOMES = (
    "A share: basal, apical, below, controls_apical, controls_basal; or a number of a run: height_um, "
    "nucleus_height_um, apical_width_um, basal_width_um, nuclei_width_um, or an observable of your own."
)


def simplify(
    file: File,
    tolerance: Annotated[float, typer.Option(help="Difference that does not matter; 0.03: 3 points.")],
    outcome: Annotated[str, typer.Option(help=OUTCOMES)] = "basal",
    scenario: Annotated[list[str] | None, typer.Option(help="One of the study, or two: first minus second.")] = None,
    at: Annotated[str | None, typer.Option(metavar="TIME", help='When, such as "48 h"; else at the end.')] = None,
    runs: Annotated[int, typer.Option(help="Of each model.")] = 256,
    out: Annotated[Path | None, typer.Option(help="Folder to write to.", show_default="results/simplify_FILE")] = None,
) -> None:
    """Find the simplest model that answers a question of a study as the full one does, within a tolerance.

    Fewer substeps, no noise, fewer cells and others run beside the full model with the same seeds; equivalence tests
    decide. Writes answer.csv. After any interruption the same command goes on.
    """
    from dincl.study.table import write_csv
    from tissue.study.simplify import simplify as find

    folder = out or Path("results") / f"simplify_{Path(file).stem}"
    with messages(resumes=True):
        found = find(file, tolerance, outcome=outcome, scenarios=scenario or (), at=at, runs=runs, out=folder)
        write_csv(found.table, folder / "answer.csv")
    heads = ("model", "verdict", "difference", "work", "runs")
    rows = (
        (
            row.model,
            row.verdict,
            row.reason or f"{row.difference:+.3g} [{row.low:+.3g}, {row.high:+.3g}]",
            f"{row.work:.2f}",
            row.runs,
        )
        for row in found.table.itertuples()
    )
    print(table(f"Simpler minus full model, within {tolerance:g}; work over that of the full model", heads, rows))
    print(table("Left out", ("model", "why"), found.left_out.items()))
    if found.answer:
        print(f"Enough: {', '.join(found.answer)}. A run takes {found.saving:.1f} times less work.")
    else:
        print("No simplification is shown to be enough: take the full model.")
    print(f"{folder}: answer.csv")
