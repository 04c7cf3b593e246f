"""The figures of chapter 4 for the page: both presets beside each other, complete tables before runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import pandas as pd

from tissue.pictures.sheet import write
from tissue.study.figures.catalogue import FIGURES, of_presets
from tissue.study.figures.sources import RUNS, TABLES, by_preset, needed
from tissue.study.plan import TissueStudy
from tissue.study.read import Results
from verification.page.context import Context
from verification.page.parts import Picture
from verification.thesis.chapter4 import kept, studies
from verification.thesis.chapter4.beside import COLUMNS

MAKES_NO_NUMBERS = True

# Figures of single runs, which want every state of some.
EXAMPLES = (11, 16)
CHECKED = (13, 15, 17, 18, 19)  # over these the runs of the page are laid
THESIS = "Plunder's thesis"


@dataclass(frozen=True)
class Pictures:
    """Tables from which the figures of a page are drawn; made once for each page."""

    context: Context
    folder: Path  # of the results

    @cached_property
    def made(self) -> Mapping[str, TissueStudy]:
        """The studies of which there are runs."""
        return studies.chosen(self.context.form(studies.FULL if self.context.full else studies.SHORT))

    @cached_property
    def complete(self) -> Mapping[str, pd.DataFrame]:
        """The tables of complete studies, with the headings that figures read."""
        tables = {name: self.context.tables[f"{kept.COMPLETE_PREFIX}{name}"] for name in TABLES}
        return tables | {"ratios": tables["ratios"].rename(columns={"what": "outcome"})}

    def of(self, *numbers: int) -> Iterator[Picture]:
        """Figures of the thesis, each of the presets whose studies are there; none if they are of neither."""
        for number in numbers:
            if presets := self._presets(number):
                where = self._where(number, presets)
                tables = {} if self.context.full and _is_of_runs(number) else self.complete
                path = self.context.draw(f"emt_figure{number}", drawn, number, presets, where, tables)
                yield Picture(path, self._caption(number, presets, where))

    def _presets(self, number: int) -> list[str]:
        """The presets that a figure can be drawn of."""
        there = {name for name, study in self.made.items() if number not in EXAMPLES or study.trajectories}
        wanted = {preset: source.lacks(FIGURES[number]) for preset, source in by_preset({}, self.complete).items()}
        return [preset for preset, names in wanted.items() if there >= {one + studies.PRESETS[preset] for one in names}]

    def _where(self, number: int, presets: Sequence[str]) -> dict[str, Path]:
        """Folders of the results that a figure reads, or that are laid over."""
        kinds = needed(FIGURES[number])
        names = [
            name + studies.PRESETS[preset]
            for preset in presets
            for name, kind in kinds.items()
            if kind == RUNS or (number in CHECKED and not self.context.full)
        ]
        return {name: studies.place(name, self.made[name], self.folder) for name in names if name in self.made}

    def _caption(self, number: int, presets: Sequence[str], where: Mapping[str, Path]) -> str:
        runs, source = sum(self.made[name].runs for name in where), "from the complete studies"
        if number in EXAMPLES:
            source = "single runs of this page"
        elif _is_of_runs(number):
            source = f"from {runs} runs of this page"
        elif where and number in CHECKED:
            here = " and ".join(preset for preset in presets if preset in map(studies.preset_of, where))
            counted = "the" if "categories" in needed(FIGURES[number]).values() else runs  # not all are in the figure
            source += f", with {counted} runs of this page ({here} preset) laid over them"
        which = " and ".join(presets) + (" presets beside each other" if len(presets) > 1 else " preset")
        what = COLUMNS["figures"][str(number)]
        return f"{what}: {which}, {source}. Counterpart of Figure {number} of chapter 4 of {THESIS}."


def _is_of_runs(number: int) -> bool:
    return RUNS in needed(FIGURES[number]).values()


def drawn(
    number: int, presets: Sequence[str], where: Mapping[str, Path], complete: Mapping[str, pd.DataFrame], path: Path
) -> Path:
    """Draw Figure ``number`` of the studies in these folders and of complete tables, and give the path back."""
    path.parent.mkdir(parents=True, exist_ok=True)
    sources = by_preset({name: Results(folder) for name, folder in where.items()}, complete)
    figure = of_presets(FIGURES[number], {preset: sources[preset] for preset in presets})
    write(figure, path)
    return path
