"""Pictures of a trajectory or of the start of a problem, on a line or in the plane; needs matplotlib.

This is the one file of the package that imports it, on use.
"""

from __future__ import annotations

import base64
import html
import io
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.shapes import Ball, Bonds, Curve, Wall, radii, region, shapes_at, values_on_grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from dincl.problem import Problem

__all__ = ["Axes", "Film", "log_ticks", "plot", "plot_problem", "to_html"]

Floats = NDArray[np.float64]
STYLE: Any = {
    "font.size": 8.5,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#555555",
    "lines.linewidth": 1.0,
    "legend.frameon": False,
}
SIZE = (4.6, 4.2)  # [inches]
DPI = 110
FILL, EDGE, OBSTACLE, GREY = "#9ec3e6", "#2b5b8a", "#cfcfcf", "#8a8a8a"
# Logarithmic axes over a ratio above LONG have ticks at powers of ten alone, below at 1 and 3 times them, below SHORT
# at 1, 2 and 5 times them; below SHORTEST, where these may be a single tick, at equal distances.
LONG, SHORT, SHORTEST = 100.0, 10.0, 5.0
MOST_TICKS = 5
MOST_TRACES = 300  # paths; more would hide each other
LEVEL_POINTS = 80  # points along each axis at which a curve is sampled


class Film(NamedTuple):
    """The states (K, N, d) of a run at increasing times (K,), and the texts above and below its picture."""

    problem: Problem
    t: Floats
    x: Floats
    title: str
    words: str
    start: float = 0.0


class View(NamedTuple):
    """The problem, and the corners of what is shown (d,), (d,), shared by all pictures of one run."""

    problem: Problem
    low: Floats
    high: Floats


def plot(film: Film, ax: Axes | None = None) -> Axes:
    """See ``Trajectory.plot``."""
    view = _view(film)
    with _style():
        ax = ax or _new_axes()
        _draw(ax, view, film)
    return ax


def plot_problem(problem: Problem, times: Floats, ax: Axes | None) -> Axes:
    """See ``Problem.plot``."""
    film = Film(problem, times[:1], problem.x0[None], str(getattr(problem, "title", "start")), "")
    view = _view(film._replace(t=times))
    with _style():
        ax = ax or _new_axes()
        _draw(ax, view, film)
        for t in times[1:] if len(view.low) == 2 else ():
            for shape in shapes_at(problem, float(t)):
                _draw_shape_in_plane(ax, view, shape, None)
    return ax


def to_html(film: Film) -> str:
    """See ``Trajectory._repr_html_``."""
    words = html.escape(film.words)
    if film.x.shape[2] > 2 or find_spec("matplotlib") is None:
        return f"<p>{words}</p>"
    picture = io.BytesIO()
    with _style():
        figure = _own_figure()
        _draw(figure.add_subplot(), _view(film), film)
        figure.savefig(picture, dpi=DPI)
    data = base64.b64encode(picture.getvalue()).decode()
    return f'<figure><img alt="{words}" src="data:image/png;base64,{data}"><figcaption>{words}</figcaption></figure>'


def _view(film: Film) -> View:
    d = film.x.shape[2]
    if d > 2:
        raise InvalidProblem(f"d = {d}: must be 1 or 2 to be drawn")
    places = np.concatenate((film.problem.x0[None], film.x))
    return View(film.problem, *region(film.problem, places, (film.start, float(film.t[-1]))))


def _draw(ax: Axes, view: View, film: Film) -> None:
    """Draw the start, the paths through the states, and the last state."""
    first = 0 if film.t[0] > film.start else 1
    times, states = np.append(film.start, film.t[first:]), np.concatenate((film.problem.x0[None], film.x[first:]))
    (_draw_line if len(view.low) == 1 else _draw_plane)(ax, view, times, states)
    ax.set_title(film.title)


def _style() -> Any:
    """Return a context in which pictures are drawn in the style of this package."""
    with needs("A picture", "report"):
        from matplotlib import rc_context

    return rc_context(STYLE)


def _own_figure() -> Figure:
    """Return a figure that is shown in no window and no notebook."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained", dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def _new_axes() -> Axes:
    """Return axes of a new figure of pyplot."""
    from matplotlib import pyplot as plt

    axes: Axes = plt.figure(figsize=SIZE, layout="constrained").add_subplot()
    return axes


def log_ticks(ax: Axes, plain: float = LONG) -> None:
    """Keep the ticks of logarithmic axes apart: powers of ten on long ones, a few plain numbers on short ones.

    Numbers are plain on axes over a ratio up to ``plain``, else powers. Ticks at fixed places stay. Ticks between the
    powers crowd an axis, and take a third of the time to draw.
    """
    from matplotlib.ticker import FuncFormatter, LogFormatterSciNotation, LogLocator, MaxNLocator, NullLocator

    for axis, limits in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
        if axis.get_scale() != "log":
            continue
        axis.set_minor_locator(NullLocator())
        if not isinstance(axis.get_major_locator(), (LogLocator, MaxNLocator)):
            continue
        ratio = max(limits) / min(limits)
        factors = (1.0,) if ratio > LONG else (1.0, 3.0) if ratio > SHORT else (1.0, 2.0, 5.0)
        even = MaxNLocator(MOST_TICKS - 1, steps=[1, 2, 5, 10])
        axis.set_major_locator(LogLocator(subs=factors) if ratio > SHORTEST else even)
        numbers = FuncFormatter(lambda value, _: f"{value:g}")
        axis.set_major_formatter(numbers if ratio <= plain else LogFormatterSciNotation())


def _draw_line(ax: Axes, view: View, times: Floats, states: Floats) -> None:
    radius = np.array([radii(view.problem, float(t)) for t in times])
    for k in range(states.shape[1]):
        x, r = states[:, k, 0], radius[:, k]
        (line,) = ax.plot(times, x, color=f"C{k % 10}")
        if r.any():
            ax.fill_between(times, x - r, x + r, color=line.get_color(), alpha=0.2, lw=0)
    now = [shapes_at(view.problem, float(t)) for t in times]
    for history in zip(*now, strict=True):
        _draw_obstacle_on_line(ax, view, times, history)
    ax.set(xlabel="t", ylabel="x", ylim=(view.low[0], view.high[0]))


def _draw_obstacle_on_line(ax: Axes, view: View, times: Floats, history: tuple[Any, ...]) -> None:
    """Draw one obstacle at all times."""
    first = history[0]
    if isinstance(first, Wall):
        edge = np.array([wall.offset / wall.normal[0] for wall in history])
        beyond = view.low[0] if first.normal[0] > 0 else view.high[0]
        ax.fill_between(times, edge, np.full_like(edge, beyond), color=OBSTACLE, lw=0, zorder=0)
    if isinstance(first, Ball):
        low, high = (np.array([b.centre[0] + side * b.radius for b in history]) for side in (-1, 1))
        ax.fill_between(times, low, high, color="none" if first.inside else OBSTACLE, ec=GREY, zorder=0)


def _draw_plane(ax: Axes, view: View, times: Floats, states: Floats) -> None:
    for shape in shapes_at(view.problem, float(times[-1])):
        _draw_shape_in_plane(ax, view, shape, states[-1])
    for k in range(min(states.shape[1], MOST_TRACES)):
        ax.plot(*states[:, k].T, color=EDGE, alpha=0.35, lw=0.8, zorder=3)
    first, last = (radii(view.problem, float(t)) for t in (times[0], times[-1]))
    _draw_discs(ax, states[0], first, facecolor="none", edgecolor=EDGE, alpha=0.3, lw=0.6, zorder=1)
    _draw_discs(ax, states[-1], last, facecolor=FILL, edgecolor=EDGE, lw=0.8, zorder=2)
    ax.set(xlim=(view.low[0], view.high[0]), ylim=(view.low[1], view.high[1]), aspect="equal", xlabel="x", ylabel="y")


def _draw_discs(ax: Axes, x: Floats, radius: Floats, **style: Any) -> None:
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Circle

    point = radius == 0
    ax.scatter(x[point, 0], x[point, 1], s=14, **style)
    ax.add_collection(
        PatchCollection([Circle(tuple(c), r) for c, r in zip(x[~point], radius[~point], strict=True)], **style)
    )


def _draw_shape_in_plane(ax: Axes, view: View, shape: Any, x: Floats | None) -> None:
    """Draw a shape, with its bonds between particles x (N, 2); None: the dotted outline of a set at a later time."""
    from matplotlib.patches import Circle, Polygon

    dotted: Any = {"lw": 0.8, "ls": ":", "zorder": 1}
    if isinstance(shape, Wall):
        along, foot = np.array([-shape.normal[1], shape.normal[0]]), shape.offset * shape.normal
        if x is None:
            ax.axline(tuple(foot), tuple(foot + along), color=GREY, **dotted)
            return
        far = 4 * float(np.abs([view.low, view.high]).max())
        corners = [foot - far * along, foot + far * along, foot + far * (along - shape.normal)]
        ax.add_patch(Polygon([*corners, foot - far * (along + shape.normal)], color=OBSTACLE, lw=0, zorder=0))
    elif isinstance(shape, Ball):
        style = {"zorder": 0} if x is not None else dotted
        face = "none" if shape.inside or x is None else OBSTACLE
        ax.add_patch(Circle(tuple(shape.centre), shape.radius, facecolor=face, edgecolor=GREY, **style))
    elif isinstance(shape, Bonds) and x is not None:
        for i, j in shape.pairs:
            ax.plot(*x[[i, j]].T, color=GREY, lw=0.9, zorder=4)
    elif isinstance(shape, Curve):
        axes = [np.linspace(low, high, LEVEL_POINTS) for low, high in zip(view.low, view.high, strict=True)]
        values = values_on_grid(shape, *axes)
        if values.min() < 0 < values.max():
            if x is not None:
                ax.contourf(*axes, values, levels=[-np.inf, 0.0], colors=[OBSTACLE], zorder=0)
            lines: Any = {"linestyles": "dotted", "linewidths": 0.8} if x is None else {"linewidths": 1.0}
            ax.contour(*axes, values, levels=[0.0], colors=[GREY], zorder=0, **lines)
