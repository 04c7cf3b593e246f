"""All figures that the results in a folder suffice for: those of any study, then those of chapter 4."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.files.parameter_files import read
from tissue.pictures.charts import CHART_STYLE, caption, verbatim
from tissue.pictures.sheet import Figure, style, write
from tissue.study.comparing import answers_or_reason
from tissue.study.figures.at_end import at_end, figure_13, figure_15, figure_17, figure_18, figure_19
from tissue.study.figures.conditional import figure_20, figure_21, figure_22
from tissue.study.figures.effects import effect_figure, outcome_name
from tissue.study.figures.examples import examples, figure_11, figure_16, surface
from tissue.study.figures.in_time import figure_10, figure_12, figure_14, positions, ratios_against_time
from tissue.study.figures.sources import PRESETS, Draw, FigureSource, Sources, by_preset, needed, no_cells
from tissue.study.plan import FOLDER, shipped
from tissue.study.planned import PlannedComparisons
from tissue.study.read import Results
from tissue.study.store import about

MAKES_NO_NUMBERS = True


class Drawable(NamedTuple):
    """A figure of a study; ``draw`` raises InvalidProblem if it cannot be drawn."""

    name: str
    caption: str  # what it shows
    draw: Callable[[], Figure]


def drawables(results: Results) -> Iterator[Drawable]:
    """Give all figures of a study: first a picture of each planned answer."""
    if results.study.compare is not None:
        yield from _of_answers(results, results.study.compare)
    for name, text in (
        ("positions", "positions of EMT cells against time"),
        ("ratios", "ratios of extrusion against time"),
        ("at_end", "ratios of extrusion at the end"),
    ):
        yield Drawable(name, text, partial(_of_cells, results, name))
    scenarios, stored = results.study.scenarios, _stored(results)
    if not results.study.trajectories:
        yield Drawable("examples", "", partial(examples, results, scenarios[0]))
        return
    digits = len(str(len(scenarios)))
    for number, scenario in enumerate(scenarios, 1):
        if scenario in stored:
            text = f"examples of {scenario}"
            yield Drawable(f"examples_{number:0{digits}}", text, partial(_examples, results, scenario))
    if stored and results.parameters(stored[0]).in_space:
        yield Drawable("surface", f"the surface of a run of {stored[0]}", partial(surface, results, stored[0]))


def _of_answers(results: Results, plan: PlannedComparisons) -> Iterator[Drawable]:
    """Give the picture of each answer for which there are runs."""
    rows = [row for row in answers_or_reason(results)[0].to_dict("records") if row["runs"]]
    for number, row in enumerate(rows, 1):
        text = f"{row['question']}: {outcome_name(row['outcome'])}, {row['measure']}"
        draw = partial(effect_figure, results, row, plan.contrasts[row["question"]])
        yield Drawable(f"answer_{number:0{len(str(len(rows)))}}", text, draw)


def _of_cells(results: Results, name: str) -> Figure:
    """Draw one of the figures of all scenarios that have EMT cells; the caption names those that have none."""
    absent = dict.fromkeys(results.study.scenarios, "is not stored yet")
    for scenario in _stored(results):
        empty = results.cells(scenario, ["replicate"]).empty
        absent[scenario] = no_cells(results, scenario) if empty else ""
    shown = [scenario for scenario, why in absent.items() if not why]
    missing = [f"{describe(scenario)} {why}" for scenario, why in absent.items() if why]
    if not shown:
        raise InvalidProblem(f"{results.folder}: {'; '.join(missing)}")
    source = {"": FigureSource({"": results})}
    with style(**CHART_STYLE):
        if name == "positions":
            figure = positions(source, "", shown)
        elif name == "ratios":
            figure = ratios_against_time(source, "", shown, "EMT cells")
        else:
            figure = at_end(source, "", shown)
    if missing:
        caption(figure, f"{figure.get_supxlabel()} Not shown: {verbatim('; '.join(missing))}.")
    return figure


def _examples(results: Results, scenario: str) -> Figure:
    with style(**CHART_STYLE):
        return examples(results, scenario)


def _stored(results: Results) -> list[str]:
    """Return the scenarios of which some runs are stored."""
    summary = results.summary()
    return list(summary.loc[summary["runs"] > 0, "scenario"])


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


class FigureFile(NamedTuple):
    """A figure, or why there is none."""

    name: str
    files: tuple[Path, ...]  # none if it was not drawn
    message: str  # what it shows, and from which studies; or what is missing


def found(folder: str | PathLike[str], *, trust: bool = False) -> dict[str, Results]:
    """Open the results in a folder, or in its folders, by the names of the studies, which their titles tell.

    ``trust``: as of ``Results``.

    Raises
    ------
    InvalidProblem
        If there are none, or twice those of one study.
    """
    top, names = Path(folder), {read(FOLDER / f"{name}.toml")["title"]: name for name in shipped()}
    folders = [top] if _is_study(top) else sorted(path for path in top.glob("*") if path.is_dir() and _is_study(path))
    studies: dict[str, Results] = {}
    for path in folders:
        results = Results(path, trust=trust)
        name = names.get(results.study.title, path.name)
        if name in studies:
            raise InvalidProblem(f"{studies[name].folder} and {path}: must be one of these, both are of {name}")
        studies[name] = results
    if not studies:
        raise InvalidProblem(f"{top}: must be the results of a study, or a folder with such folders in it")
    return studies


def draw_all(folder: str | PathLike[str], *, trust: bool = False) -> Iterator[FigureFile]:
    """Draw what can be drawn, one after the other; and say what cannot, and why.

    Those of a study go into the folder ``figures`` in that of the study, those of chapter 4 into the one in ``folder``.

    Parameters
    ----------
    folder, trust
        As in ``found``.

    Returns
    -------
    Iterator[FigureFile]
        The figures of each study; then those of chapter 4, by number, that are drawn from one of the studies.
    """
    studies, top = found(folder, trust=trust), Path(folder)
    for results in studies.values():
        state = "" if results.complete else ", not complete yet"
        for one in drawables(results):
            yield _drawn(results.folder, one.name, one.draw, one.caption + state)
    yield from _of_thesis(studies, top)


def _of_thesis(studies: dict[str, Results], top: Path) -> Iterator[FigureFile]:
    """Give the figures of chapter 4 that one of the studies is for, both presets side by side where both are there."""
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
            yield FigureFile(name, (), f"is made after: {commands}")


def of_presets(draw: Draw, sources: Sources) -> Figure:
    """Draw a figure of chapter 4; below it stands which model it is of, where that is not the one of the thesis."""
    figure = draw(sources)
    if list(sources) == ["published"]:
        caption(figure, f"In the published model. {figure.get_supxlabel()}")
    return figure


def _drawn(home: Path, name: str, draw: Callable[[], Figure], text: str) -> FigureFile:
    try:
        figure = draw()
    except InvalidProblem as error:
        return FigureFile(name, (), f"cannot be drawn: {error}")
    files = tuple(home / SUBFOLDER / f"{name}{ending}" for ending in ENDINGS)
    try:
        files[0].parent.mkdir(exist_ok=True)
        for file in files:
            write(figure, file)
    except OSError as error:
        raise InvalidProblem(f"{home / SUBFOLDER}: must be a folder that can be written to: {error}") from error
    return FigureFile(name, files, text)


def _is_study(folder: Path) -> bool:
    return about(folder) is not None
