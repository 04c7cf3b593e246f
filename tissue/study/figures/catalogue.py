"""All figures that the results in a folder suffice for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from dincl.errors import InvalidProblem
from tissue.files.parameter_files import read
from tissue.pictures.sheet import Figure, write
from tissue.study.figures.any_study import drawables
from tissue.study.figures.at_end import figure_13, figure_15
from tissue.study.figures.conditional import figure_20, figure_21
from tissue.study.figures.environments import figure_17, figure_18, figure_19
from tissue.study.figures.examples import figure_11, figure_16
from tissue.study.figures.in_time import figure_10, figure_12, figure_14
from tissue.study.figures.needs import PRESETS, Draw, Sources, by_preset, needed
from tissue.study.figures.scatter import figure_22
from tissue.study.figures.style import caption
from tissue.study.plan import FOLDER, shipped
from tissue.study.read import Results
from tissue.study.store import about

MAKES_NO_NUMBERS = True

# By their numbers in chapter 4.
FIGURES: dict[int, Draw] = {
    10: figure_10,
    11: figure_11,
    12: figure_12,
    13: figure_13,
    14: figure_14,
    15: figure_15,
    16: figure_16,
    17: figure_17,
    18: figure_18,
    19: figure_19,
    20: figure_20,
    21: figure_21,
    22: figure_22,
}
SUBFOLDER = "figures"
ENDINGS = (".png", ".svg")


class Drawn(NamedTuple):
    """A figure, or why there is none."""

    name: str
    files: tuple[Path, ...]  # none if it was not drawn
    told: str  # what it shows, and from which studies; or what is missing


def found(folder: str | PathLike[str]) -> dict[str, Results]:
    """The results in a folder, or in the folders in it, by the name of the study, which is known by its title.

    Raises
    ------
    InvalidProblem
        If there are none, or twice those of one study.
    """
    top, names = Path(folder), {read(FOLDER / f"{name}.toml")["title"]: name for name in shipped()}
    folders = [top] if _is_study(top) else sorted(path for path in top.glob("*") if path.is_dir() and _is_study(path))
    studies: dict[str, Results] = {}
    for path in folders:
        results = Results(path)
        name = names.get(results.study.title, path.name)
        if name in studies:
            raise InvalidProblem(f"{studies[name].folder} and {path}: must be one of these, both are of {name}")
        studies[name] = results
    if not studies:
        raise InvalidProblem(f"{top}: must be the results of a study, or a folder with such folders in it")
    return studies


def draw_all(folder: str | PathLike[str]) -> Iterator[Drawn]:
    """Draw what can be drawn, one after the other; and say what cannot, and why.

    Those of a study go into the folder ``figures`` in that of the study, those of chapter 4 into the one in ``folder``.

    Parameters
    ----------
    folder
        As in ``found``.

    Returns
    -------
    Iterator[Drawn]
        The figures of each study; then those of chapter 4, by number, that are drawn from one of the studies.
    """
    studies, top = found(folder), Path(folder)
    for results in studies.values():
        state = "" if results.complete else ", not complete yet"
        for one in drawables(results):
            yield _drawn(results.folder, one.name, one.draw, one.told + state)
    yield from _of_thesis(studies, top)


def _of_thesis(studies: dict[str, Results], top: Path) -> Iterator[Drawn]:
    """The figures of chapter 4 that one of the studies is for, both presets beside each other where both are there."""
    home, sources = top.parent if _is_study(top) else top, by_preset(studies)
    for number, draw in FIGURES.items():
        name = f"figure{number}"
        whole = {preset: source for preset, source in sources.items() if not source.lacks(draw)}
        used = {preset: [one for one in needed(draw) if one in source.studies] for preset, source in sources.items()}
        if whole:
            folders = [str(source.studies[one].folder) for preset, source in whole.items() for one in used[preset]]
            yield _drawn(top, name, partial(of_presets, draw, whole), f"from {', '.join(folders)}")
        elif any(used.values()):
            preset = max(used, key=lambda one: len(used[one]))
            absent = [study + PRESETS[preset] for study in sources[preset].lacks(draw)]
            commands = ", ".join(f"tissue study {study} --out {home / study}" for study in absent)
            yield Drawn(name, (), f"is made after: {commands}")


def of_presets(draw: Draw, sources: Sources) -> Figure:
    """A figure of chapter 4; below it stands which model it is of, where that is not the one of the thesis."""
    figure = draw(sources)
    if list(sources) == ["published"]:
        caption(figure, f"In the published model. {figure.get_supxlabel()}")
    return figure


def _drawn(home: Path, name: str, draw: Callable[[], Figure], told: str) -> Drawn:
    try:
        figure = draw()
    except InvalidProblem as error:
        return Drawn(name, (), f"cannot be drawn: {error}")
    files = tuple(home / SUBFOLDER / f"{name}{ending}" for ending in ENDINGS)
    try:
        files[0].parent.mkdir(exist_ok=True)
        for file in files:
            write(figure, file)
    except OSError as error:
        raise InvalidProblem(f"{home / SUBFOLDER}: must be a folder that can be written to: {error}") from error
    return Drawn(name, files, told)


def _is_study(folder: Path) -> bool:
    return about(folder) is not None
