"""EMT: what makes cells leave the tissue, by the studies of chapter 4, beside what the thesis says."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from verification.site.cells import percent, percents
from verification.site.context import Context
from verification.site.store import shipped
from verification.thesis.chapter4.differences import COUNTING, COUNTING_ROW, ROWS
from verification.thesis.chapter4.ensembles import POPULATIONS, PRESETS, preset_of, without_ending
from verification.thesis.chapter4.figures import FIGURES, draw
from verification.thesis.chapter4.frequencies import READINGS
from verification.thesis.chapter4.groups import EVENTS
from verification.thesis.chapter4.printed import compared
from verification.thesis.chapter4.questions import ANSWERS, answered

# Tables of which a part can be rerun; a part of the others has fewer runs, and other numbers.
IN_PARTS = ("emt_in_time", "emt_ratios")
TABLES = (*IN_PARTS, "emt_groups", "emt_ranking", "emt_effects")
LABELS = {preset: READINGS[preset].capitalize() for preset in PRESETS}
# The factors by short names.
SHORT = {"A": "[A]", "B": "[B]", "S": "[S]", "P": "protrusions", "inm": "INM", "onset": "place at the onset"}
SHORT |= {f"{event} time": f"time of [{event}]" for event in "ABSP"}
OUTCOMES = {"apical": "leaves apically", "basal": "leaves basally", "below": "lies below all control cells"}
CLEAR = 2.0  # effects of two rows are shown if one is this far from 0, by the half of its interval


def read(context: Context) -> None:
    """Fill in the tables: as they ship, a part of some made again beside them, or all made anew."""
    for name in TABLES:
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


def isolated(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate printed and measured ratios, with how far off those are that do not agree."""
    table = tables["emt_printed"]
    texts = []
    for row in table.itertuples():
        off = percents((row.difference, row.low, row.high), 0, "+").replace(" %", " points")
        texts.append(f"{row.time_h:g} h: {percent(row.measured, 1)}{'' if row.agrees else f', off by {off}'}")
    keys = {"scenario": "Scenario", "what": "Outcome", "printed": "Printed"}
    ends = table.assign(text=texts).groupby(["preset", *keys], sort=False)["text"].agg("; ".join).reset_index()
    rows = beside(ends, list(keys), ends["text"]).assign(printed=lambda wide: wide["printed"].map(percent))
    return rows.rename(columns=keys), "emt_printed"


def programs(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate basal extrusion in the 44 cases of Table 4."""
    table = tables["emt_ratios"]
    table = table[table["study"].str.startswith("figure15") & (table["what"] == "basal")]
    texts = [f"{text}, {size:.0f} effective" for text, size in zip(_percents(table), table["effective"], strict=True)]
    return beside(table, ["scenario"], texts).rename(columns={"scenario": "Scenario"}), "emt_ratios"


def categories(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate basal extrusion in heterogeneous groups by events."""
    table = tables["emt_groups"]
    table = table[table["given"] == EVENTS]
    texts = [f"{text} of {of}" for text, of in zip(_percents(table), table["of"], strict=True)]
    rows = beside(table, ["study", "kind"], texts).replace({"study": POPULATIONS})
    return rows.rename(columns={"study": "Group", "kind": "Cells with"}), "emt_groups"


def factors(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate the importance of factors."""
    table = tables["emt_ranking"]
    texts = [f"{row.value:.4f} [{row.low:.4f}, {row.high:.4f}]" for row in table.itertuples()]
    return beside(table, ["factor"], texts).rename(columns={"factor": "Factor"}), "emt_ranking"


def questions(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate the verdicts on the answers of section 4.7."""
    table = tables[ANSWERS]
    whole = table.drop_duplicates(["preset", "id"])
    needed = ["" if pd.isna(runs) else f", {runs:.0f} runs needed" for runs in whole["needed"]]
    keys = {"id": "", "question": "Question", "thesis": "Answer of the thesis"}
    rows = beside(whole, list(keys), [*map("".join, zip(whole["verdict"], needed, strict=True))])
    return rows.rename(columns=keys), ANSWERS


def compared_parts(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate the comparisons that the verdicts rest on."""
    table = tables[ANSWERS]
    parts = beside(table, ["id", "compared"], table["found"])
    return parts.rename(columns={"id": "", "compared": "Compared, basal extrusion"}), ANSWERS


def meanings(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate what each difference between the presets says in both models."""
    rows = [(name, row.printed, row.published) for name, row in (ROWS | {COUNTING: COUNTING_ROW}).items()]
    return pd.DataFrame(rows, columns=["Difference", "In the model as printed", "In the published runs"]), "emt_effects"


def effects(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate a line for each difference, and for each two that matter together, a column for each printed ratio."""
    table = tables["emt_effects"]
    clear = table["effect"].abs() > CLEAR * (table["high"] - table["low"]) / 2
    table = table[(table["with"] == "") | clear.groupby([table["row"], table["with"]]).transform("any")]
    table = table.assign(
        Changed=table["row"] + (" with " + table["with"]).where(table["with"] != "", ""),
        ratio=table["scenario"].str.replace("no INM", "without INM") + " " + table["what"].map(OUTCOMES),
        text=[percents((row.effect, row.low, row.high), 0, "+").replace(" %", "") for row in table.itertuples()],
    )
    wide = table.pivot_table("text", "Changed", "ratio", aggfunc="first", sort=False)
    return wide.rename_axis(columns=None).reset_index(), "emt_effects"


def show(context: Context) -> None:
    """Give isolated cells, homogeneous and heterogeneous groups, what matters most, and the eight questions."""
    tables = {name: table for name, table in context.tables.items() if name.startswith("emt_")}
    for number in FIGURES:
        context.draw(f"emt_figure{number}", draw, number, tables)
    for tabulate in (isolated, meanings, effects, programs, categories, factors, questions, compared_parts):
        context.show(f"emt_{tabulate.__name__}", *tabulate(tables))
    ranking = tables["emt_ranking"]
    mine = ranking[ranking["study"].map(preset_of) == "published"].set_index("factor")["value"]
    context.numbers["emt"] = SHORT[mine.idxmax()].capitalize()
