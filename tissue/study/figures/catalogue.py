"""All figures that the results in a folder suffice for."""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from dincl.errors import InvalidProblem
from tissue.files.parameter_files import read
from tissue.pictures.sheet import write
from tissue.study.figures.at_end import figure_13, figure_15
from tissue.study.figures.conditional import figure_20, figure_21, figure_22
from tissue.study.figures.environments import figure_17, figure_18, figure_19
from tissue.study.figures.examples import figure_11, figure_16
from tissue.study.figures.in_time import figure_10, figure_12, figure_14
from tissue.study.figures.needs import Draw, needed
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
PUBLISHED = "_published"  # ending of studies in the published model, and of the figures from them


class Drawn(NamedTuple):
    """A figure, or why there is none."""

    name: str
    files: tuple[Path, ...]  # none if it was not drawn
    told: str  # the studies from which it was drawn; or what is missing


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
    """Draw what can be drawn, into the folder ``figures``, one after the other; and say what cannot, and why.

    Parameters
    ----------
    folder
        As in ``found``.

    Returns
    -------
    Iterator[Drawn]
        All figures of chapter 4, by number; then those of the published model for which the studies are there.
    """
    studies, top = found(folder), Path(folder)
    home = top.parent if _is_study(top) else top
    thesis = {name: results for name, results in studies.items() if not name.endswith(PUBLISHED)}
    for number, draw in FIGURES.items():
        if absent := [name for name in needed(draw) if name not in thesis]:
            commands = ", ".join(f"tissue study {name} --out {home / name}" for name in absent)
            yield Drawn(f"figure{number}", (), f"is made after: {commands}")
        else:
            yield _drawn(f"figure{number}", draw, thesis, top)
    published = {name.removesuffix(PUBLISHED): studies[name] for name in studies if name.endswith(PUBLISHED)}
    for number, draw in FIGURES.items():
        if published.keys() >= set(needed(draw)):
            yield _drawn(f"figure{number}{PUBLISHED}", draw, published, top)


def _drawn(name: str, draw: Draw, results: dict[str, Results], top: Path) -> Drawn:
    try:
        figure = draw(results)
    except InvalidProblem as error:
        return Drawn(name, (), f"cannot be drawn: {error}")
    if name.endswith(PUBLISHED):
        caption(figure, f"In the published model. {figure.get_supxlabel()}")
    files = tuple(top / SUBFOLDER / f"{name}{ending}" for ending in ENDINGS)
    try:
        files[0].parent.mkdir(exist_ok=True)
        for file in files:
            write(figure, file)
    except OSError as error:
        raise InvalidProblem(f"{top / SUBFOLDER}: must be a folder that can be written to: {error}") from error
    used = [results[study] for study in needed(draw)]
    return Drawn(name, files, ", ".join(f"{one.folder}{'' if one.complete else ', not complete yet'}" for one in used))


def _is_study(folder: Path) -> bool:
    return about(folder) is not None
