"""Pictures and movies of a trajectory or of the start of a problem."""

from __future__ import annotations

import base64
import html
import io
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import number
from dincl.drawing import (
    DPI,
    Floats,
    View,
    draw_outlines,
    draw_until,
    movie_writer,
    new_axes,
    own_figure,
    projection,
    style,
)
from dincl.errors import InvalidProblem
from dincl.files import replacing
from dincl.region import region

if TYPE_CHECKING:
    from dincl.drawing import Axes
    from dincl.problem import Problem

__all__ = ["MAKES_NO_NUMBERS", "Axes", "Film", "animate", "plot", "plot_problem", "problem_to_html", "to_html"]

# No table depends on how things are drawn.
MAKES_NO_NUMBERS = True


class Film(NamedTuple):
    """The states (K, N, d) of a run at increasing times (K,), and what is written above and below its picture."""

    problem: Problem
    t: Floats
    x: Floats
    title: str
    words: str


def plot(film: Film, ax: Axes | None = None) -> Axes:
    """See ``Trajectory.plot``."""
    view = _view(film)
    with style():
        ax = ax or new_axes(view)
        _draw(ax, view, film)
    return ax


def plot_problem(problem: Problem, times: Floats, ax: Axes | None) -> Axes:
    """See ``Problem.plot``."""
    film = _film_of_start(problem, times)
    view = _view(film._replace(t=times))
    with style():
        ax = ax or new_axes(view)
        _draw(ax, view, film)
        for t in times[1:] if len(view.low) == 2 else ():
            draw_outlines(ax, view, float(t))
    return ax


def _film_of_start(problem: Problem, times: Floats) -> Film:
    title = str(getattr(problem, "title", "start"))
    return Film(problem, times[:1], problem.x0[None], title, f"{problem!r}.")


def problem_to_html(problem: Problem) -> str:
    """See ``Problem._repr_html_``."""
    return to_html(_film_of_start(problem, np.zeros(1)))


def animate(film: Film, file: str | Path, fps: float) -> Path:
    """See ``Trajectory.animate``; one picture for each time of the film."""
    target = Path(file)
    view, writer = _view(film), movie_writer(target, number("fps", fps, positive=True))
    with style():
        figure = own_figure()
        ax = figure.add_subplot(**projection(view))
        with replacing(target) as partial, writer.saving(figure, str(partial), DPI):
            for k, t in enumerate(film.t):
                ax.clear()
                draw_until(ax, view, film.t[: k + 1], film.x[: k + 1])
                ax.set_title(f"t = {t:.3g}")
                writer.grab_frame()
    return target


def to_html(film: Film) -> str:
    """See ``Trajectory._repr_html_``."""
    words = html.escape(film.words)
    if film.x.shape[2] > 3 or find_spec("matplotlib") is None:
        return f"<p>{words}</p>"
    picture = io.BytesIO()
    with style():
        figure, view = own_figure(), _view(film)
        _draw(figure.add_subplot(**projection(view)), view, film)
        figure.savefig(picture, dpi=DPI)
    data = base64.b64encode(picture.getvalue()).decode()
    return f'<figure><img alt="{words}" src="data:image/png;base64,{data}"><figcaption>{words}</figcaption></figure>'


def _view(film: Film) -> View:
    """Show all states, containers and obstacles, and the nearest part of each wall or curve that is not far away."""
    d = film.x.shape[2]
    if d > 3:
        raise InvalidProblem(f"d = {d}: drawn are trajectories in 1, 2 or 3 dimensions; to_frame() has the numbers")
    places = np.concatenate((film.problem.x0[None], film.x))
    return View(film.problem, *region(film.problem, places, (0.0, float(film.t[-1]))))


def _draw(ax: Axes, view: View, film: Film) -> None:
    """The start, the paths through the states, and the last state."""
    first = 0 if film.t[0] > 0 else 1
    times = np.concatenate(([0.0], film.t[first:]))
    draw_until(ax, view, times, np.concatenate((film.problem.x0[None], film.x[first:])))
    ax.set_title(film.title)
