"""What a figure is drawn from: the results of studies, or complete tables that are kept in their place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import wraps
from typing import TYPE_CHECKING

from dincl.errors import InvalidProblem
from tissue.pictures.sheet import Figure, style
from tissue.study.figures.style import LOOK
from tissue.study.figures.tables import TABLES

if TYPE_CHECKING:
    import pandas as pd

    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

# The ending of studies that change a preset.
PRESETS = {"thesis": "", "published": "_published"}


@dataclass(frozen=True)
class FigureSource:
    """What the figures of one preset are drawn from.

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
        """The rows of a study: kept ones, or else those of its results."""
        return self._kept(table, study) if self.is_kept(table, study) else self._made(table, study)

    def check(self, table: str, study: str) -> pd.DataFrame | None:
        """Of kept rows those of the results, which are fewer runs, if there are any."""
        there = self.is_kept(table, study) and study in self.studies
        return self._made(table, study) if there else None

    def is_kept(self, table: str, study: str) -> bool:
        """Whether there are kept rows of this study."""
        return table in self.kept and not self._kept(table, study).empty

    def _kept(self, table: str, study: str) -> pd.DataFrame:
        whole = self.kept[table]
        return whole[whole["study"] == study]

    def _made(self, table: str, study: str) -> pd.DataFrame:
        """Once, for all figures that want it."""
        if (table, study) not in self.made:
            self.made[table, study] = TABLES[table](self.studies[study])
        return self.made[table, study]

    def lacks(self, draw: Draw) -> list[str]:
        """The studies that a figure needs and that are not here."""
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
    """Results and kept tables of both presets, told apart by the endings of their studies."""
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
    """The preset that a study changes, by its name."""
    return next(preset for preset, ending in reversed(PRESETS.items()) if study.endswith(ending))


def needs(**studies: str) -> Callable[[Draw], Draw]:
    """Declare what a figure is drawn from: of each study its "runs" or one of ``TABLES``; without it it is refused."""

    def declared(draw: Draw) -> Draw:
        @wraps(draw)
        def checked(sources: Sources) -> Figure:
            for source in sources.values():
                if absent := source.lacks(checked):
                    raise InvalidProblem(f"results lack {', '.join(absent)}: must have {', '.join(studies)}")
            with style(**LOOK):
                return draw(sources)

        checked.__dict__["needs"] = studies
        return checked

    return declared


def needed(draw: Draw) -> dict[str, str]:
    """The studies that a figure is drawn from, and what of each."""
    studies: dict[str, str] = draw.__dict__["needs"]
    return studies
