"""Curved basal layers: whether curvature matters for cells that leave, and what a large circle becomes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from verification.beyond.curved import curved
from verification.beyond.curved import figures as figures_curved
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Chapter, Finding

ARC = 400  # um, of the arcs that the study of ways out has
PARTS = ["value", "low", "high"]
QUESTION = "Does curvature matter?"
PROSE = Path(__file__).parent / "prose"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TABLES = ("ways_out", "limit", "tubes", "lumen")


def run(context: Context) -> None:
    """Take over the kept tables."""
    for name in TABLES:
        context.keep(f"curved_{name}", curved.table(name))


def sections(context: Context) -> Sequence[Section]:
    """Return the answer with its figure, closed tubes, and the limit of large circles."""
    ways_out, limit = context.tables["curved_ways_out"], context.tables["curved_limit"]
    basal = ways_out[ways_out["side"] == "basal"].set_index(["events", "layer"])
    largest = limit["perimeter_um"].max()
    said = fill(
        PROSE / "curved.html",
        of=int(ways_out["of"].iloc[0]),
        a={layer: tuple(basal.loc[("[A]", layer), PARTS]) for layer in curved.LAYERS},
        bp={layer: tuple(basal.loc[("[BP]", layer), PARTS]) for layer in curved.LAYERS},
        rates=[(side, rate(limit[limit["side"] == side])) for side in ("inside", "outside")],
        largest=int(largest),
        last=list(limit[limit["perimeter_um"] == largest].itertuples()),
    )
    chart = context.draw("curved_ways_out", figures_curved.draw_ways_out, ways_out)
    tissues = context.draw("curved_tissues", figures_curved.draw_tissues)
    return [
        Section(
            QUESTION,
            [
                Text(said["answer"]),
                Picture(chart, said["chart"]),
                Picture(tissues, said["tissues"]),
                Grid(_named(ways_out, "ways_out"), said["table"], "curved_ways_out", folded=True),
                Follows(said["follows"]),
            ],
        ),
        _closed(context),
        Section(
            "A large circle becomes the line",
            [
                Text(said["limit"]),
                Grid(_named(limit, "limit"), said["heights"], "curved_limit"),
                Follows(said["line_follows"]),
            ],
        ),
    ]


def _closed(context: Context) -> Section:
    """Compare tubes with arcs, and say when lumina close."""
    ways_out, tubes, lumen = (context.tables[f"curved_{name}"] for name in ("ways_out", "tubes", "lumen"))
    said = fill(PROSE / "tubes.html", ratio=partial(ratio, ways_out, tubes), **_facts(tubes, lumen))
    chart = context.draw("curved_tubes", figures_curved.draw_tubes, ways_out, tubes)
    return Section(
        "Does it matter that a tube is closed?",
        [
            Text(said["answer"]),
            Picture(chart, said["chart"]),
            Text(said["lumen"]),
            Grid(_named(lumen, "lumen"), said["times"], "curved_lumen"),
            Grid(_named(tubes, "tubes"), said["table"], "curved_tubes", folded=True),
            Follows(said["follows"]),
        ],
    )


def ratio(
    ways_out: pd.DataFrame, tubes: pd.DataFrame, events: str, layer: str, perimeter: int, every: int = 0
) -> tuple[float, ...]:
    """Return the ratio of basal extrusion with its interval; one of ``every`` cells is an EMT cell, 0: on an arc."""
    if every == 0 and perimeter == ARC:
        rows = ways_out[ways_out["layer"] == layer]
    else:
        here = tubes[(tubes["layer"] == layer) & (tubes["perimeter_um"] == perimeter)]
        rows = here[here["every"] == every] if every else here[~here["closed"]]
    (row,) = rows[(rows["events"] == events) & (rows["side"] == "basal")][PARTS].itertuples(index=False)
    return tuple(row)


def _facts(tubes: pd.DataFrame, lumen: pd.DataFrame) -> dict[str, object]:
    """Return the basal distances on closed and open layers with the tissue inside, and the rows of lumina."""
    inside = tubes[tubes["layer"] == "inside"].groupby("closed")["basal_spacing_um"].mean()
    return {"spacing": inside.to_dict(), "lumen": list(lumen.itertuples()), "failed": int(tubes["failed"].sum())}


def rate(rows: pd.DataFrame) -> float:
    """Return the factor by which the distance from the line falls when the perimeter doubles for the last time."""
    away = rows.sort_values("perimeter_um")["away_um"].abs().to_numpy()
    return float(away[-2] / away[-1])


def _named(rows: pd.DataFrame, table: str) -> pd.DataFrame:
    return headed(rows.replace({"events": {r", no": " without"}}, regex=True), COLUMNS[table])


def findings(context: Context) -> Sequence[Finding]:
    """State how many cells leave on the basal side of each layer."""
    ways_out = context.tables["curved_ways_out"]
    basal = ways_out[(ways_out["side"] == "basal") & (ways_out["events"] == "[A]")].set_index("layer")
    parts = {layer: tuple(basal.loc[layer, PARTS]) for layer in curved.LAYERS}
    return [Finding(fill(PROSE / "learned_curved.html", parts=parts)["basal"], QUESTION)]


CHAPTER = Chapter(
    "curved",
    "Curved layers",
    "Does it matter for cells that leave whether the basal layer bends?",
    run,
    sections,
    findings,
    place=11,
    tables=("curved_",),
)
