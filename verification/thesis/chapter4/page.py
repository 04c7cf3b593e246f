"""EMT: what makes cells leave the tissue, by the studies of chapter 4, beside what the thesis says."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import pandas as pd

from verification.site import cards
from verification.site.context import Context
from verification.site.parts import Follows, Grid, Picture, Section, Text
from verification.site.prose import percent, percents
from verification.site.report import Card, Chapter, Finding
from verification.site.store import shipped
from verification.thesis.chapter4 import swapped
from verification.thesis.chapter4.ensembles import POPULATIONS, PRESETS, preset_of, without_ending
from verification.thesis.chapter4.figures import CAPTIONS, TITLES, draw
from verification.thesis.chapter4.frequencies import READINGS, RULE
from verification.thesis.chapter4.groups import EVENTS
from verification.thesis.chapter4.printed import compared
from verification.thesis.chapter4.questions import ANSWERS, answered
from verification.thesis.studies import STUDIES

# Tables of which a part can be rerun; a part of the others has fewer runs, and other numbers.
IN_PARTS = ("emt_in_time", "emt_ratios", "emt_changed")
LABELS = {preset: READINGS[preset].capitalize() for preset in PRESETS}
ISOLATED, GROUPS, MIXED, POSITIONS, QUESTIONS = (
    "Do isolated cells leave as often as the thesis prints?",
    "Does a group of cells with the same events help them to leave?",
    "Does a heterogeneous group help them to leave?",
    "What matters most: where EMT begins, when, or which events?",
    "Which answers to the eight questions hold?",
)
TEXTS = {
    ISOLATED: "All ratios that the thesis prints come out of the published runs, and some of them out of the model as "
    "printed. The thesis gives no time for them: its runs end at 48 h, those that were published at 54 h.",
    GROUPS: "In the published runs, and with corrected energies, by no program more cells leave in a group of ten than "
    "alone; without INM and without protrusions fewer do. With the energies as printed a group helps cells that lose "
    "both adhesions.",
    MIXED: "In the published runs, and with corrected energies, cells of heterogeneous groups leave less often than "
    "cells alone with the same events, at any share of protrusions. Without INM they leave more often than in a "
    "homogeneous group.",
    POSITIONS: "Beside protrusions the place at the onset tells most. The time of loss of apical adhesion tells "
    "something, the times of the other events hardly anything.",
    QUESTIONS: f"{RULE} Each answer is taken apart into comparisons of basal extrusion, at a level of 99 % each. Two "
    "kinds of cells of which none leaves, or all do, say nothing and are left out.",
}
EFFECTIVE = "Ten cells of one tissue are fewer than ten independent observations: effective is how many they are worth."
FOLLOWS = {
    ISOLATED: "Apical extrusion of control cells, the thin grey line, stays below one in a hundred: that of "
    "EMT cells means something above it.",
    POSITIONS: "An answer about a program of events needs the places at which cells begin it.",
    QUESTIONS: "An answer that gets another verdict in another reading is one about the energies, not about EMT.",
}
# The factors by short names.
SHORT = {"A": "[A]", "B": "[B]", "S": "[S]", "P": "protrusions", "inm": "INM", "onset": "place at the onset"}
SHORT |= {f"{event} time": f"time of [{event}]" for event in "ABSP"}
CARD = 5  # factors on the first page


def read(context: Context) -> None:
    """Fill in the tables: as they ship, a part of some made again beside them, or all made anew."""
    for name in (name for name in STUDIES if name.startswith("emt_")):
        if context.full or (name in IN_PARTS and context.complete is not None):
            context.rows(name)
        else:
            context.keep(name, shipped(name))


def run(context: Context) -> None:
    """Read the tables, and derive the printed ratios beside the measured ones, and the answers."""
    read(context)
    context.keep("emt_printed", compared(context.tables))
    context.keep(ANSWERS, answered(context.tables))


def beside(table: pd.DataFrame, keys: list[str], shown: Sequence[str]) -> pd.DataFrame:
    """Return a row for each value of the keys, with the texts ``shown`` of the readings beside each other."""
    preset = table["preset"] if "preset" in table else table["study"].map(preset_of)
    table = table.assign(reading=preset.map(LABELS), text=list(shown))
    if "study" in keys:
        table = table.assign(study=table["study"].map(without_ending))
    wide = table.pivot_table("text", keys, "reading", aggfunc="first", sort=False)
    shown_labels = [label for label in LABELS.values() if label in wide]
    return wide[shown_labels].fillna("").reset_index().rename_axis(columns=None)


def _percents(table: pd.DataFrame) -> list[str]:
    return [percents((row.value, row.low, row.high), 1) for row in table.itertuples()]


def isolated(tables: dict[str, pd.DataFrame]) -> Iterator[Grid]:
    """Tabulate printed and measured ratios, with how far off those are that do not agree."""
    table = tables["emt_printed"]
    texts = []
    for row in table.itertuples():
        off = percents((row.difference, row.low, row.high), 0, "+").replace(" %", " points")
        texts.append(f"{row.time_h:g} h: {percent(row.measured, 1)}{'' if row.agrees else f', off by {off}'}")
    keys = {"scenario": "Scenario", "what": "Outcome", "printed": "Printed"}
    ends = table.assign(text=texts).groupby(["preset", *keys], sort=False)["text"].agg("; ".join).reset_index()
    rows = beside(ends, list(keys), ends["text"]).assign(printed=lambda wide: wide["printed"].map(percent))
    text = "Measured ratios; off by: measured minus printed with its 99 % interval, where that does not contain 0."
    yield Grid(rows.rename(columns=keys), text, "emt_printed")


def programs(tables: dict[str, pd.DataFrame]) -> Iterator[Grid]:
    """Tabulate basal extrusion in the 44 cases of Table 4."""
    table = tables["emt_ratios"]
    table = table[table["study"].str.startswith("figure15") & (table["what"] == "basal")]
    texts = [f"{text}, {size:.0f} effective" for text, size in zip(_percents(table), table["effective"], strict=True)]
    rows = beside(table, ["scenario"], texts).rename(columns={"scenario": "Scenario"})
    yield Grid(rows, f"Basal extrusion in the 44 cases of Table 4, 95 % intervals. {EFFECTIVE}", "emt_ratios", True)


def categories(tables: dict[str, pd.DataFrame]) -> Iterator[Grid]:
    """Tabulate basal extrusion in heterogeneous groups by events."""
    table = tables["emt_groups"]
    table = table[table["given"] == EVENTS]
    texts = [f"{text} of {of}" for text, of in zip(_percents(table), table["of"], strict=True)]
    rows = beside(table, ["study", "kind"], texts).replace({"study": POPULATIONS})
    rows = rows.rename(columns={"study": "Group", "kind": "Cells with"})
    yield Grid(rows, "Basal extrusion by the events of a cell in their order, 95 % intervals.", "emt_groups", True)


def factors(tables: dict[str, pd.DataFrame]) -> Iterator[Grid]:
    """Tabulate the importance of factors."""
    table = tables["emt_ranking"]
    texts = [f"{row.value:.4f} [{row.low:.4f}, {row.high:.4f}]" for row in table.itertuples()]
    rows = beside(table, ["factor"], texts).rename(columns={"factor": "Factor"})
    text = (
        "Factors of basal extrusion in the group with 35 % [P]: by how much the log loss of boosted trees grows if a "
        "factor is shuffled among the cells [nats], 95 % intervals over replicates."
    )
    yield Grid(rows, text, "emt_ranking")


def questions(tables: dict[str, pd.DataFrame]) -> Iterator[Grid]:
    """Tabulate the verdicts on the answers of section 4.7, and the comparisons that they rest on."""
    table = tables[ANSWERS]
    whole = table.drop_duplicates(["preset", "id"])
    needed = ["" if pd.isna(runs) else f", {runs:.0f} runs needed" for runs in whole["needed"]]
    keys = {"id": "", "question": "Question", "thesis": "Answer of the thesis"}
    rows = beside(whole, list(keys), [*map("".join, zip(whole["verdict"], needed, strict=True))])
    text = "The answers under the three readings; runs needed: of each kind, to decide what is open."
    yield Grid(rows.rename(columns=keys), text, ANSWERS)
    parts = beside(table, ["id", "compared"], table["found"])
    parts = parts.rename(columns={"id": "", "compared": "Compared, basal extrusion"})
    yield Grid(parts, "In points or nats, with 99 % intervals and the required range.", ANSWERS, folded=True)


Tabulate = Callable[[dict[str, pd.DataFrame]], Iterator[Grid]]
# By title: figures and tables.
SECTIONS: dict[str, tuple[tuple[int, ...], Tabulate]] = {
    ISOLATED: ((10, 12, 13, 14), isolated),
    GROUPS: ((15,), programs),
    MIXED: ((17, 18, 19), categories),
    POSITIONS: ((20, 21), factors),
    QUESTIONS: ((), questions),
}


def sections(context: Context) -> Sequence[Section]:
    """From the isolated cell to the heterogeneous group, and the eight questions."""
    found = [_section(context, title, *parts) for title, parts in SECTIONS.items()]
    return [found[0], swapped.section(context.tables), *found[1:]]


def _section(context: Context, title: str, numbers: tuple[int, ...], tabulate: Tabulate) -> Section:
    tables = {name: table for name, table in context.tables.items() if name.startswith("emt_")}
    pictures = []
    for number in numbers:
        path = context.draw(f"emt_figure{number}", draw, number, tables)
        counterpart = f"Counterpart of Figure {number} of chapter 4 of the thesis."
        pictures.append(Picture(path, f"{TITLES[number]}. {counterpart} {CAPTIONS[number]}"))
    follows = [Follows(FOLLOWS[title])] if title in FOLLOWS else []
    return Section(title, [Text(TEXTS[title]), *pictures, *tabulate(tables), *follows])


def findings(context: Context) -> Sequence[Finding]:
    """Say what matters most for cells that leave, by the published program."""
    ranking = context.tables["emt_ranking"]
    most = ranking[ranking["study"].map(preset_of) == "published"].sort_values("value", ascending=False).head(CARD)
    names = [SHORT[factor] for factor in most["factor"]]
    ends = list(zip(most["low"], most["high"], strict=True))
    label = "log loss of a prediction without it [nats]"
    picture = context.draw("card_emt", cards.bars, names, list(most["value"]), ends, label)
    said = (
        f"Whether a cell leaves on the basal side depends most on {names[0]}: a prediction without it loses "
        f"{most['value'].iloc[0]:.2g} nats of log loss. Next come {names[1]} and {names[2]}."
    )
    return [Finding(said, POSITIONS, Card(picture, said, 5))]


CHAPTER = Chapter(
    "emt",
    "EMT",
    "What makes cells leave an epithelium, and do the printed ratios come out again?",
    run,
    sections,
    findings,
    tables=("emt_",),
)
