"""The chapter on EMT as sections of the page: it reads tables, and draws figures from the stored results."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pandas as pd

from tissue.study.comparisons import PRINTED_LEVEL, Difference, corrected
from tissue.study.ratios import as_ratio
from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3.maps import LABELS
from verification.thesis.chapter4 import figures, headings, sensitivity, studies

# Figures of single runs, which want every state of some.
EXAMPLES = (11, 16)
MARKED = {"INM": "with INM", "no INM": "without INM"}


def folder(context: Context) -> Path:
    """Where the results of the studies are."""
    return context.out / "emt"


def sections(context: Context) -> list[Section]:
    """All sections, in their order."""
    return [
        _isolated(context),
        _groups(context),
        _heterogeneous(context),
        _positions(context),
        _questions(context),
        _sensitivity(context),
        _controls(context),
        *([] if context.full else [_short(context)]),
    ]


def _complete(context: Context, name: str) -> pd.DataFrame:
    return context.tables[f"emt_complete_{name}"]


def _named(table: pd.DataFrame, headings: dict[str, str]) -> pd.DataFrame:
    table = table[list(headings)]
    if "preset" in table:
        table = table.assign(preset=table["preset"].map(LABELS))
    return table.rename(columns=headings)


def _pictures(context: Context, *numbers: int) -> Iterator[Picture]:
    """Figures of the thesis, of the runs of this page, for each preset whose studies are among them."""
    made = studies.chosen(context.full)
    for one in numbers:
        for preset, suffix in studies.PRESETS.items():
            wanted = {study: study + suffix for study in figures.needs(one)}
            if all(name in made and (one not in EXAMPLES or made[name].trajectories) for name in wanted.values()):
                where = {study: studies.place(name, made[name], folder(context)) for study, name in wanted.items()}
                path = context.draw(f"emt_figure{one}{suffix}", figures.drawn, one, where)
                yield Picture(path, f"Counterpart of Figure {one}, {preset} preset, from the runs of this page.")


def _isolated(context: Context) -> Section:
    table = _complete(context, "printed")
    agreeing = table.groupby(["preset", "time_h"], sort=False)["agrees"].agg(["sum", "size"])
    told = "; ".join(
        f"{preset} preset at {t:g} h {row['sum']} of {row['size']}" for (preset, t), row in agreeing.iterrows()
    )
    return Section(
        "Isolated cells",
        [
            Text(
                f"Printed for 400 runs, and within the joint {100 * PRINTED_LEVEL:g} % interval of both: {told}. "
                f"{_off(table)}"
            ),
            Grid(
                _named(table, headings.PRINTED),
                "Ratios of the complete studies; the interval is that of measured minus printed. The thesis gives no "
                "time for them: its runs end at 48 h, those that were published at 54 h.",
                "emt_complete_printed",
            ),
            *_pictures(context, 10, 11, 12, 13, 14),
        ],
    )


def _off(table: pd.DataFrame) -> str:
    """By how much the others miss."""
    missed = table[~table["agrees"]]
    gaps = "; ".join(
        f"{row.preset} at {row.time_h:g} h, {row.scenario} {row.what}: {100 * row.difference:+.0f} points "
        f"[{100 * row.low:+.0f}, {100 * row.high:+.0f}]"
        for row in missed.itertuples()
    )
    return f"Off by: {gaps}." if gaps else "None is off."


def _groups(context: Context) -> Section:
    table = _complete(context, "ratios")
    shown = table[table["study"].str.startswith("figure15") & (table["what"] == "basal")]
    return Section(
        "Groups of cells with the same events",
        [
            Text(
                "Ten cells of a tissue are not ten observations: <i>Effective</i> is the number of independent cells "
                "that tell as much."
            ),
            *_pictures(context, 15, 16),
            Grid(
                _named(shown, headings.RATIOS),
                "Basal extrusion in the 44 cases of Table 4, complete studies, 95 % intervals.",
                "emt_complete_ratios",
                folded=True,
            ),
        ],
    )


def _heterogeneous(context: Context) -> Section:
    table = _complete(context, "categories")
    return Section(
        "Heterogeneous groups",
        [
            *_pictures(context, 17, 18, 19),
            Grid(
                _named(table, headings.CATEGORIES),
                "Basal extrusion by the events of a cell in their order, complete studies, 95 % intervals.",
                "emt_complete_categories",
                folded=True,
            ),
        ],
    )


def _positions(context: Context) -> Section:
    ranking, outside = _complete(context, "ranking"), _complete(context, "outside")[["outside", "of"]].sum()
    share = 100 * outside["outside"] / outside["of"]
    return Section(
        "Position at the onset, timing, and what matters most",
        [
            Text(_first_fifth(_complete(context, "conditional"))),
            Text(
                f"Of {outside['of']} cells {outside['outside']} ({share:.2f} %) begin EMT outside of 0 &lt; "
                "y<sub>AB</sub> ≤ 1, where the thesis has no category."
            ),
            *_pictures(context, 20, 21, 22),
            Grid(
                _named(ranking, headings.RANKING),
                "Factors of basal extrusion in the group with 35 % [P]: by how much the log loss of boosted trees "
                "grows if a factor is shuffled among the cells, 95 % intervals over replicates.",
                "emt_complete_ranking",
            ),
        ],
    )


def _first_fifth(conditional: pd.DataFrame) -> str:
    """The ratios of the most basal cells, which the thesis has at 70 % to 80 %."""
    table = conditional[(conditional["given"] == "onset_ab") & (conditional["high_edge"] < 0.25)]
    told = "; ".join(
        f"{study}, {MARKED[str(inm)]}: {number(100 * part['count'].sum() / part['of'].sum())} % of {part['of'].sum()}"
        for (study, inm), part in table.groupby(["study", "inm"], sort=False)
    )
    return f"Extruded basally of the cells without [P] in the most basal 20 % (thesis: 70 % to 80 %): {told}."


def _questions(context: Context) -> Section:
    table = _complete(context, "answers")
    verdicts = "; ".join(f"{row.id}, {LABELS[row.preset]} preset: {row.verdict}" for row in table.itertuples())
    sentences = table.assign(measured=table["measured"].str.split("\n")).explode("measured")
    return Section(
        "The eight questions",
        [
            Text(f"{verdicts}. Each answer of the thesis is taken apart into comparisons, at a level of 99 % each."),
            Grid(
                _named(table, headings.ANSWERS),
                "Section 4.7 beside the complete studies; “Runs needed”: of each kind, to decide what is open.",
                "emt_complete_answers",
            ),
            Grid(
                _named(sentences[sentences["measured"] != ""], headings.COMPARISONS),
                "The comparisons: ratios with their 95 % intervals.",
                "emt_complete_answers",
                folded=True,
            ),
        ],
    )


def _sensitivity(context: Context) -> Section:
    table = _complete(context, "sensitivity").sort_values("ST", ascending=False)
    noise, deviation = table["noise"].iloc[0], table["deviation"].iloc[0]
    return Section(
        "Sensitivity to the mechanics",
        [
            Text(
                "The ratio of basal extrusion of ten cells with [B] at 6 h, without INM, thesis preset, each parameter "
                "between half and one and a half times its value (μ: 0.1 to 0.2 h). It has a standard deviation of "
                f"{100 * deviation:.1f} points; of the variance of the measured ratios {100 * noise:.0f} % is noise of "
                "a finite number of runs, which is taken out."
            ),
            Grid(
                _named(table, headings.SENSITIVITY),
                f"Shares of the variance, {sensitivity.BASE_POINTS} base points, {sensitivity.HEAD['replicates']} runs "
                "of each point, 95 % intervals.",
                "emt_complete_sensitivity",
            ),
        ],
    )


def _controls(context: Context) -> Section:
    return Section(
        "Control cells",
        [
            Text(
                "By (4.3) ordinary cells at the upper rim are above the apical layer, too: below this rate the apical "
                "extrusion of EMT cells says nothing."
            ),
            Grid(
                _named(_complete(context, "controls"), headings.CONTROLS),
                "Part of the control cells outside of the tissue at the end, means over runs with 95 % intervals; runs "
                "that left the finite numbers.",
                "emt_complete_controls",
            ),
        ],
    )


def _short(context: Context) -> Section:
    """Whether the runs of this page agree with the complete studies."""
    both = context.tables["emt_ratios"].merge(
        _complete(context, "ratios"), on=["study", "scenario", "what"], suffixes=("", "_complete")
    )
    differences = [_difference(row) for _, row in both.iterrows()]
    p = corrected(pd.Series([one.p_value() for one in differences]))
    apart = both[(p < 1 - PRINTED_LEVEL).to_numpy()]
    told = "; ".join(f"{row.study} {row.scenario} {row.what}" for row in apart.itertuples()) or "none"
    runs = sum(study.runs for study in studies.chosen(full=False).values())
    return Section(
        "The runs of this page beside the complete studies",
        [
            Text(
                f"The figures are drawn from {runs} runs that were made for this page. The tables above come from the "
                "complete studies, 50,000 runs of each heterogeneous group (4,000 in the published model), which "
                "<code>python -m verification.thesis.chapter4.kept FOLDER</code> makes again. Ratios that differ "
                "between the two, "
                f"by Holm's correction for {len(both)} comparisons at {100 * PRINTED_LEVEL:g} %: {told}."
            ),
            Grid(
                _named(context.tables["emt_ratios"], headings.RATIOS),
                "Ratios of this page's runs.",
                "emt_ratios",
                folded=True,
            ),
        ],
    )


def _difference(row: pd.Series) -> Difference:
    complete = row[["count_complete", "of_complete", "effective_complete"]].set_axis(["count", "of", "effective"])
    return Difference(as_ratio(row), as_ratio(complete))
