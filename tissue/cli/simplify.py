"""The command ``tissue simplify``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tissue.cli.messages import GOES_ON, INTERRUPTED, messages, table
from tissue.cli.studies import File

if TYPE_CHECKING:
    from tissue.study.simplify import Simplified

MAKES_NO_NUMBERS = True
OUTCOMES = (
    "A share: basal, apical, below, controls_apical, controls_basal; or a number of a run: height_um, "
    "nucleus_height_um, apical_width_um, basal_width_um, nuclei_width_um, or an observable of your own."
)


def simplify(
    file: File,
    outcome: Annotated[str | None, typer.Option(help=OUTCOMES)] = None,
    scenario: Annotated[list[str] | None, typer.Option(help="One of the study, or two: first minus second.")] = None,
    tolerance: Annotated[float | None, typer.Option(help="Bias that does not matter; 0.03: 3 points.")] = None,
    at: Annotated[str | None, typer.Option(metavar="TIME", help='When, such as "48 h".')] = None,
    runs: Annotated[int | None, typer.Option(help="The most runs of a model: 64, 128, ..., 8192.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder to write to.", show_default="results/simplify_FILE")] = None,
) -> None:
    """Find the simplest model that answers a question of a study as the full one does, within a tolerance.

    Fewer substeps, no noise, fewer cells and others run beside the full model with the same seeds; equivalence tests
    decide. Writes answer.csv and bias.png. What is not given, the section simplify of the study says, or is basal
    extrusion in the first scenario at the end. After any interruption the same command goes on.
    """
    from dincl.study.table import write_csv
    from tissue.pictures.bias import draw_bias
    from tissue.study.simplify import simplify as find

    folder = out or Path("results") / f"simplify_{Path(file).stem}"
    with messages():
        try:
            found = find(file, tolerance, outcome=outcome, scenarios=scenario or None, at=at, runs=runs, out=folder)
        except KeyboardInterrupt:
            typer.echo(f"Interrupted: {GOES_ON}", err=True)
            raise typer.Exit(INTERRUPTED) from None
        write_csv(found.table, folder / "answer.csv")
        draw_bias(found.table, found.question.tolerance, _unit(found), found.model, folder / "bias.png")
    print(_said(found))
    print(f"{folder}: answer.csv, bias.png")


def _said(found: Simplified) -> str:
    """Return the table and the answer."""
    rows = found.table[found.table["verdict"] != "left out"]
    heads = ("model", "verdict", f"bias [{_unit(found)}]", "CPU time", "counted work", "runs", "runs missing")
    said = [table(_title(found), heads, (_row(found, row) for row in rows.to_dict("records")))]
    left = found.table[found.table["verdict"] == "left out"]
    said.append(table("Left out", ("model", "why"), left[["model", "reason"]].itertuples(index=False)))
    if not found.answer:
        return "\n".join([*said, "No simplification is shown to be enough: take the full model."])
    cpu, work = found.saving
    saved = f"{cpu:.1f} times less CPU time, {work:.1f} times less counted work"
    said.append(f"Enough: {', '.join(found.answer)}. A run takes {saved}.")
    alone = rows[(rows["verdict"] == "enough") & (rows["cpu"] < 1 / cpu)].sort_values("cpu")
    if len(alone):  # elimination drops by bias, not by cost
        said.append(
            f"Alone, {alone['model'].iloc[0]} is enough and cheaper: {1 / alone['cpu'].iloc[0]:.1f} times less."
        )
    return "\n".join(said)


def _title(found: Simplified) -> str:
    asked = found.question
    tolerance = 100 * asked.tolerance if asked.shares else asked.tolerance
    when = "at the end" if asked.at is None else f"at {asked.at:g} h"
    return f"{asked.name} of {' - '.join(asked.scenarios)} {when}, within {tolerance:g} {_unit(found)}"


def _row(found: Simplified, row: dict[str, Any]) -> tuple[str, ...]:
    verdict = f"{row['verdict']}: {row['reason']}" if row["reason"] else row["verdict"]
    # Runs that fail end early, so their cost says nothing.
    cost = ("", "") if row["reason"] else (f"{row['cpu']:.2f}", f"{row['work']:.2f}")
    return row["model"], verdict, _bias(found, row), *cost, str(row["runs"]), _missing(row)


def _bias(found: Simplified, row: dict[str, Any]) -> str:
    scale = 100.0 if found.question.shares else 1.0
    value, low, high = (scale * row[key] for key in ("bias", "low", "high"))
    return "" if row["reason"] else f"{value:+.2f} [{low:+.2f}, {high:+.2f}]"


def _missing(row: dict[str, Any]) -> str:
    import pandas as pd

    return "" if pd.isna(row["missing"]) else str(row["missing"])


def _unit(found: Simplified) -> str:
    if found.question.shares:
        return "points"
    return "um" if found.question.name.endswith("_um") else "its unit"
