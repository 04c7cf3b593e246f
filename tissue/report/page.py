"""One HTML page of a study that needs nothing else, and its figures as files."""

from __future__ import annotations

import warnings
from base64 import b64encode
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup

from dincl.errors import InvalidProblem
from dincl.files import read_bytes, write_text
from tissue.frames.observables import measurable
from tissue.pictures.emt import event_colours, label_of
from tissue.pictures.movie import small_movie
from tissue.pictures.picture import stills
from tissue.pictures.sheet import COLOURS, Figure, webp, write
from tissue.report.figures import effect_figure, ratios_against_time
from tissue.runs.simulate import simulate
from tissue.state.surface import SPHERE
from tissue.study.answers import (
    NO_ANSWER,
    answer_table,
    answers_shown,
    folded_remarks,
    how_text,
    plan_of,
    scenario_changes,
    shares_shown,
)
from tissue.study.store import COPY

if TYPE_CHECKING:
    from tissue.frames.frame import Frame
    from tissue.study.read import Results


NAME, SUBFOLDER = "page.html", "figures"
DPI = 110
PICTURES, MOVIE_WIDTH = 25, 4.8  # of a movie, at most; inches
MOST_MOVIES = 12


class Drawable(NamedTuple):
    """A figure of a study."""

    name: str  # of its file
    title: str
    draw: Callable[[], Figure]
    caption: str = ""


class Answer(NamedTuple):
    """An answer of a study, in words."""

    heading: str
    text: str
    scenarios: list[str]  # whose movies are shown
    figure: Drawable | None  # None without runs


class Movie(NamedTuple):
    """A run of a scenario, for the page."""

    data: str  # a WebP in base64
    ratio: float  # of its sides
    run: str  # which one it is
    events: dict[str, str]  # the colours of EMT cells


def figures(results: Results) -> Iterator[Drawable]:
    """Give the figures of a study that can be drawn: its answers, and all scenarios together."""
    yield from (one.figure for one in _answers(results) if one.figure is not None)
    yield from _of_scenarios(results)


def write_figures(results: Results, kind: str) -> Iterator[Path]:
    """Write each figure of a study into the folder ``figures`` in its own, and give the files; ``kind``: png, svg, pdf.

    Raises
    ------
    InvalidProblem
        If the folder cannot be written to.
    """
    home = results.folder / SUBFOLDER
    for one in figures(results):
        path = home / f"{one.name}.{kind}"
        try:
            home.mkdir(exist_ok=True)
            write(one.draw(), path)
        except OSError as error:
            raise InvalidProblem(f"{home}: must be a folder that can be written to: {error}") from error
        yield path


def write_page(results: Results) -> Path:
    """Write page.html into the folder of a study, complete or not; it has all of its pictures and movies inside.

    Raises InvalidProblem if a file of the study is damaged.
    """
    file = results.folder / NAME
    study, stored, plan = results.study, results.summary(), plan_of(results)
    shown = (study.scenarios if study.compare is None else study.compare.scenarios)[:MOST_MOVIES]
    movies = {name: movie for name in shown if (movie := _movie(results, name)) is not None}
    events = {name: colour for movie in movies.values() for name, colour in movie.events.items()}
    copy = results.folder / COPY
    text = template("page.html.j2").render(
        study=study,
        runs=int(stored["runs"].sum()),
        failed=int(stored["failed"].sum()),
        complete=results.complete,
        folded=folded_remarks(results),
        note="" if plan is None else how_text(results, plan),
        answers=_answers(results),
        differences="" if study.compare else html_table(answers_shown(results)),
        movies=movies,
        colours=COLOURS | {label_of(name): one for name, one in events.items()},
        ends=html_table(shares_shown(results)),
        figures=list(_of_scenarios(results)),
        changes=html_table(scenario_changes(results).replace("nan", "not set")),
        parameters={name: results.parameters(name).as_toml() for name in study.scenarios},
        # A link could lead to any file of the user, and pages are sent to others.
        copy=read_bytes(copy).decode() if copy.is_file() and not copy.is_symlink() else "",
        origin=results.origin,
        image=image,
    )
    write_text(file, text)
    return file


def template(name: str) -> Template:
    """Return a template of this folder."""
    environment = Environment(loader=PackageLoader("tissue.report", ""), autoescape=True, undefined=StrictUndefined)
    environment.trim_blocks = environment.lstrip_blocks = True
    return environment.get_template(name)


def _answers(results: Results) -> list[Answer]:
    """Return the answers to the planned comparisons."""
    plan, found = results.study.compare, []
    if plan is None:
        return []
    for number, row in enumerate(answer_table(results).to_dict("records"), 1):
        weights, figure, text = plan.contrasts[row["question"]], None, ""
        if row["answer"] != NO_ANSWER:
            text = f"p = {row['p']:.2g}, {row['runs']} runs of each."
            figure = Drawable(f"answer_{number}", row["finding"], partial(effect_figure, results, row, weights))
        if not pd.isna(row["needed"]):
            text += f" About {row['needed']} of each would show an effect of this size."
        shown = list(weights) if row["measure"] == "difference" else []
        found.append(Answer(row["finding"], text, shown, figure))
    return found


def _of_scenarios(results: Results) -> Iterator[Drawable]:
    """Give the figures of all scenarios that have EMT cells together."""
    if names := [name for name in _stored(results) if not results.cells(name, ["replicate"]).empty]:
        yield Drawable("ratios", "Shares of EMT cells outside in time", partial(ratios_against_time, results, names))


def _stored(results: Results) -> list[str]:
    """Return the scenarios with runs that did not fail."""
    return list(results.summary().query("runs > failed")["scenario"])


def _movie(results: Results, scenario: str) -> Movie | None:
    """Return a movie of the first run that did not fail, which is made again; None without one.

    In three dimensions it is a section through the first EMT cell.
    """
    if scenario not in _stored(results):
        return None
    runs, parameters = results.runs(scenario, ["replicate", "seed", "status"]), results.parameters(scenario)
    first = runs[runs["status"] == "SUCCESS"].iloc[0]
    dt = parameters.numerics.dt.value
    keep = max(1, round(parameters.t_end / dt / (PICTURES - 1))) * dt
    often = parameters.changed({"numerics.keep": f"{keep:.12g} h"})
    with warnings.catch_warnings(action="ignore"):  # of folded layers the page says so
        states = measurable(simulate(often, int(first["seed"]), throw=False).frames)
    chosen = [_through_emt(states[k]) for k in np.unique(np.linspace(0, len(states) - 1, PICTURES).round().astype(int))]
    images = list(stills(chosen, parameters, MOVIE_WIDTH, with_legend=False))
    ratio = images[0].shape[1] / images[0].shape[0]
    return Movie(
        b64encode(small_movie(images)).decode(), ratio, f"replicate {first['replicate']}", event_colours(chosen)
    )


def _through_emt(frame: Frame) -> Frame:
    """Move a sheet or cylinder along z, where all is the same, so that z = 0 is at its first EMT cell."""
    cells, emt = frame.cells, np.flatnonzero(frame.cells.emt >= 0)
    if frame.sheets is None or frame.sheets.surface.bends == SPHERE or not len(emt):
        return frame
    z = cells.z[emt[0]]
    return frame._replace(cells=cells._replace(z=cells.z - z, az=cells.az - z, bz=cells.bz - z))


def image(figure: Drawable) -> str:
    """Return a WebP image of a figure in base64."""
    return b64encode(webp(figure.draw(), DPI)).decode()


def html_table(table: pd.DataFrame) -> Markup:
    """Return a table of texts in HTML; none without rows."""
    return Markup(table.to_html(index=False, border=0)) if len(table) else Markup()
