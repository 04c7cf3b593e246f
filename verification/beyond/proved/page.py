"""Solutions with proved bounds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from verification.beyond.proved import proofs as proved
from verification.beyond.proved import random_scenes
from verification.page import cards
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Section, Text
from verification.page.prose import fill
from verification.page.report import Card, Chapter, Finding

PROSE = Path(__file__).parent / "prose" / "proved.html"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLES = COLUMNS["sections"]


def run(context: Context) -> None:
    """Read the kept tables."""
    context.keep("proved_scenes", proved.table())
    rows = random_scenes.table()
    context.keep("proved_random", rows)
    known = rows[rows["why"] == ""]
    quantiles = (
        known.groupby("tol")["ratio"].quantile([0.5, 0.9, 1.0]).unstack().set_axis(["half", "most", "all"], axis=1)
    )
    context.keep("proved_ratios", quantiles.reset_index())


def _said(context: Context) -> dict[str, str]:
    rows, drawn = context.tables["proved_scenes"], context.tables["proved_random"]
    known, done = drawn[drawn["why"] == ""], rows[rows["why"] == ""]
    largest, above = done.loc[done["exponent"].idxmax()], int((known["ratio"] <= 1).sum())
    return fill(
        PROSE,
        proved=len(done),
        least=done["seconds"].min(),
        longest=done["seconds"].max(),
        four=_row(rows, "Four discs drawn to one point", 1e-12),
        fine=_row(rows, "Four discs drawn to one point", 1e-25),
        ten=_row(rows, "Ten discs in a corner", 1e-12),
        most=largest.to_dict() | {"lost": float(largest["exponent"]) / math.log(10)},
        scenes=drawn["seed"].nunique(),
        runs=len(known),
        above=above,
        stated=cards.share(above, len(known)),
        ratio=known["ratio"].max(),
        asked=random_scenes.BOUND,
        unproved=int(drawn[drawn["why"] != ""]["seed"].nunique()),
    )


def _row(rows: pd.DataFrame, scene: str, asked: float) -> dict[str, Any]:
    return dict(rows[(rows["scene"] == scene) & (rows["asked"] == asked)].iloc[0])


def sections(context: Context) -> Sequence[Section]:
    """Write about the bounds, the exponent and the random scenes."""
    said, rows = _said(context), context.tables["proved_scenes"]
    bounds = headed(rows, COLUMNS["bounds"])
    last = rows[rows["why"] == ""].drop_duplicates("scene", keep="first")
    exponents = headed(last, COLUMNS["exponents"])
    ratios = headed(context.tables["proved_ratios"], COLUMNS["ratios"])
    return [
        Section(TITLES["bounds"], [Text(said["bounds"]), Grid(bounds, said["table"], "proved_scenes")]),
        Section(TITLES["grows"], [Text(said["grows"]), Grid(exponents, said["exponents"], "proved_scenes")]),
        Section(
            TITLES["random"],
            [Text(said["random"]), Grid(ratios, said["random_table"], "proved_ratios"), Follows(said["follows"])],
        ),
    ]


def findings(context: Context) -> Sequence[Finding]:
    """Say what a proof costs, and what the stated errors are worth."""
    done = context.tables["proved_scenes"].query("why == ''").drop_duplicates("scene", keep="last")
    digits = [-math.log10(bound) for bound in done["bound"]]
    ends = [(value, value) for value in digits]
    picture = context.draw("card_proved", cards.bars, list(done["scene"]), digits, ends, "proved digits")
    said = _said(context)
    return [Finding(said["learned"], TITLES["bounds"], Card(picture, said["card"], 3))]


CHAPTER = Chapter(
    "proved",
    "What is proved",
    "Of which solutions can a bound be proved, at which cost, and are stated errors true?",
    run,
    sections,
    findings,
    place=8,
    tables=("proved_",),
)
