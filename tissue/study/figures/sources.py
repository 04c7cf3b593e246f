"""Sources of figures: cells and tables of studies, or complete tables that are kept in their place."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import wraps
from typing import TYPE_CHECKING

import pandas as pd

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.pictures.charts import CHART_STYLE
from tissue.pictures.sheet import Figure, style
from tissue.statistics.categories import by_order, happened, kept_times, outcome
from tissue.statistics.ratios import given, ratios
from tissue.study.answers import scenario_ratios

if TYPE_CHECKING:
    import pandas as pd

    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

# The studies of Table 5 of chapter 4, and the scenario of each.
POPULATIONS = {"table5_63": "63 % [P]", "table5_35": "35 % [P]", "table5_7": "7 % [P]"}


def cells_of(results: Results, scenario: str, *, last_only: bool = False) -> pd.DataFrame:
    """Read the EMT cells of a scenario; ``last_only``: of their positions only the last ones.

    Raises
    ------
    InvalidProblem
        If the scenario is not there, nothing of it is stored yet, or no run of it has EMT cells.
    """
    columns = None
    if last_only:
        end = results.parameters(scenario).t_end
        times = [f"t_{event}_h" for event in "absp"]
        columns = ["replicate", "inm", *times, "onset_ab", f"ab_{end:g}h", f"below_{end:g}h"]
    cells = results.cells(scenario, columns)
    if cells.empty:
        raise InvalidProblem(f"{results.folder}, {describe(scenario)} {no_cells(results, scenario)}")
    return cells


def no_cells(results: Results, scenario: str) -> str:
    """Return why a scenario has no rows of EMT cells."""
    failed = (results.runs(scenario, ["status"])["status"] != "SUCCESS").all()
    return (
        "has no run that did not fail" if failed else "has no EMT cells; emt.cells, or an event of a type, gives some"
    )


def population(results: Results, study: str) -> pd.DataFrame:
    """Return the cells of a heterogeneous population of Table 5 of chapter 4, with their positions at the end."""
    return cells_of(results, POPULATIONS[study], last_only=True)


# Edges of the position at the onset, and of event times [h], for Figures 21 and 20 of chapter 4.
ONSETS, TIMES = tuple(k / 10 for k in range(11)), tuple(range(6, 25, 3))
INM = {True: "INM", False: "no INM"}


def categories(results: Results) -> pd.DataFrame:
    """Tabulate basal extrusion at the end by the events of a cell in their order, with and without INM."""
    parts = []
    for scenario, cells, end in _at_end(results):
        table = ratios(outcome(cells, "basal", end), cells["replicate"], by_order(cells, end, inm=True))
        parts.append(table.rename_axis("category").reset_index().assign(scenario=scenario))
    return pd.concat(parts, ignore_index=True)


def conditional(results: Results) -> pd.DataFrame:
    """Tabulate basal extrusion at the end given the position at the onset, and given the times of [A], [B], [P].

    Of the cells without [P], and given the time of [P] of those with it; ``given``, ``inm`` say which rows are which.
    """
    parts = []
    for _, cells, end in _at_end(results):
        hits, calm = outcome(cells, "basal", end), ~happened(cells, end)["P"]
        for moves, inm in INM.items():
            for column, edges in {"onset_ab": ONSETS, "t_a_h": TIMES, "t_b_h": TIMES, "t_p_h": TIMES}.items():
                kind = (~calm if column == "t_p_h" else calm) & (cells["inm"] == moves)
                table = given(hits[kind], cells["replicate"][kind], cells[column][kind], edges)
                parts.append(table.assign(given=column, inm=inm))
    return pd.concat(parts, ignore_index=True)


def _at_end(results: Results) -> Iterator[tuple[str, pd.DataFrame, float]]:
    """Give each scenario with its cells, of their positions those at the end, and when that is [h]."""
    for scenario in results.study.scenarios:
        cells = cells_of(results, scenario, last_only=True)
        yield scenario, cells, kept_times(cells)[-1]


TABLES: dict[str, Callable[[Results], pd.DataFrame]] = {
    "ratios": scenario_ratios,
    "categories": categories,
    "conditional": conditional,
}


# The ending of studies that change a preset.
PRESETS = {"thesis": "", "published": "_published"}


@dataclass(frozen=True)
class FigureSource:
    """Source of the figures of one preset.

    Attributes
    ----------
    studies
        Results, by the name of the study, without the ending of the preset.
    kept
        Tables of complete studies, by their names in ``TABLES``, with the study in a column. They stand before the
        results, which are then laid over them.
    """

    studies: Mapping[str, Results]
    kept: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    made: dict[tuple[str, str], pd.DataFrame] = field(default_factory=dict, init=False, repr=False, compare=False)

    def rows(self, table: str, study: str) -> pd.DataFrame:
        """Return the rows of a study: kept ones, or else those of its results."""
        return self._kept(table, study) if self.is_kept(table, study) else self._made(table, study)

    def check(self, table: str, study: str) -> pd.DataFrame | None:
        """Return the rows of the results, which are fewer runs, where there are kept rows, too."""
        there = self.is_kept(table, study) and study in self.studies
        return self._made(table, study) if there else None

    def is_kept(self, table: str, study: str) -> bool:
        """Return whether there are kept rows of this study."""
        return table in self.kept and not self._kept(table, study).empty

    def _kept(self, table: str, study: str) -> pd.DataFrame:
        whole = self.kept[table]
        return whole[whole["study"] == study]

    def _made(self, table: str, study: str) -> pd.DataFrame:
        """Make a table once, for all figures that need it."""
        if (table, study) not in self.made:
            self.made[table, study] = TABLES[table](self.studies[study])
        return self.made[table, study]

    def lacks(self, draw: Draw) -> list[str]:
        """Return the studies that a figure needs and that are not here."""
        return [
            name for name, kind in needed(draw).items() if name not in self.studies and not self.is_kept(kind, name)
        ]


RUNS = "runs"  # of what a figure needs: the results themselves
# By preset; a figure shows two of them beside each other.
Sources = Mapping[str, FigureSource]
Draw = Callable[[Sources], Figure]


def by_preset(
    studies: Mapping[str, Results], kept: Mapping[str, pd.DataFrame] | None = None
) -> dict[str, FigureSource]:
    """Split results and kept tables by preset, by the endings of their studies."""
    found = {}
    for preset, ending in PRESETS.items():
        mine = {name: preset_of(name) == preset for name in studies}
        tables = {}
        for name, table in (kept or {}).items():
            owned = table[table["study"].map(preset_of) == preset]
            tables[name] = owned.assign(study=owned["study"].str.removesuffix(ending))
        found[preset] = FigureSource(
            {name.removesuffix(ending): studies[name] for name in studies if mine[name]}, tables
        )
    return found


def preset_of(study: str) -> str:
    """Return the preset that a study changes, by its name."""
    return next(preset for preset, ending in reversed(PRESETS.items()) if study.endswith(ending))


def needs(**studies: str) -> Callable[[Draw], Draw]:
    """Declare what a figure is drawn from: of each study its "runs" or one of ``TABLES``; without it it is refused."""

    def declared(draw: Draw) -> Draw:
        @wraps(draw)
        def checked(sources: Sources) -> Figure:
            for source in sources.values():
                if absent := source.lacks(checked):
                    raise InvalidProblem(f"results lack {', '.join(absent)}: must have {', '.join(studies)}")
            with style(**CHART_STYLE):
                return draw(sources)

        checked.__dict__["needs"] = studies
        return checked

    return declared


def needed(draw: Draw) -> dict[str, str]:
    """Return the studies that a figure is drawn from, and what of each."""
    studies: dict[str, str] = draw.__dict__["needs"]
    return studies
