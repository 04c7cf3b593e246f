"""Pictures and movies of a trajectory; the one file of this package that imports matplotlib, on use."""

from __future__ import annotations

import base64
import html
import io
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.checks import describe, number
from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.files import replacing
from dincl.region import region, values_on_grid
from dincl.shapes import Ball, Bonds, Curve, Wall, radii, shapes_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from dincl.problem import Problem

__all__ = ["MAKES_NO_NUMBERS", "Axes", "Film", "animate", "plot", "plot_problem", "problem_to_html", "to_html"]

# No table depends on how things are drawn.
MAKES_NO_NUMBERS = True

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
SIZE = (4.6, 4.2)  # inches
DPI = 110
FILL, EDGE, OBSTACLE, GREY = "#9ec3e6", "#2b5b8a", "#cfcfcf", "#8a8a8a"
# Paths are drawn of this many particles, balls as surfaces of so many; beyond that they hide each other.
MOST_TRACES = 300
MOST_SURFACES = 120
# Points along each axis at which the level of a curve is looked for.
LEVEL_POINTS = 80


class View(NamedTuple):
    """Contents shared by all pictures of one run: the problem, and the corners of what is shown (d,), (d,)."""

    problem: Problem
    low: Floats
    high: Floats


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
    with _style():
        ax = ax or _new_axes(view)
        _draw(ax, view, film)
    return ax


def plot_problem(problem: Problem, times: Floats, ax: Axes | None) -> Axes:
    """See ``Problem.plot``."""
    film = _film_of_start(problem, times)
    view = _view(film._replace(t=times))
    with _style():
        ax = ax or _new_axes(view)
        _draw(ax, view, film)
        for t in times[1:] if len(view.low) == 2 else ():
            for shape in shapes_at(problem, float(t)):
                _draw_outline(ax, view, shape)
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
    view, writer = _view(film), _writer(target, number("fps", fps, positive=True))
    with _style():
        figure = _figure()
        ax = figure.add_subplot(**_projection(view))
        with replacing(target) as partial, writer.saving(figure, str(partial), DPI):
            for k, t in enumerate(film.t):
                ax.clear()
                _draw_until(ax, view, film.t[: k + 1], film.x[: k + 1])
                ax.set_title(f"t = {t:.3g}")
                writer.grab_frame()
    return target


def to_html(film: Film) -> str:
    """See ``Trajectory._repr_html_``."""
    words = html.escape(film.words)
    if film.x.shape[2] > 3 or find_spec("matplotlib") is None:
        return f"<p>{words}</p>"
    picture = io.BytesIO()
    with _style():
        figure, view = _figure(), _view(film)
        _draw(figure.add_subplot(**_projection(view)), view, film)
        figure.savefig(picture, dpi=DPI)
    data = base64.b64encode(picture.getvalue()).decode()
    return f'<figure><img alt="{words}" src="data:image/png;base64,{data}"><figcaption>{words}</figcaption></figure>'


def _style() -> Any:
    with needs("A picture", "report"):
        from matplotlib import rc_context

    return rc_context(STYLE)


def _figure() -> Figure:
    """A figure that no window and no notebook knows of."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained", dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def _new_axes(view: View) -> Axes:
    from matplotlib import pyplot as plt

    axes: Axes = plt.figure(figsize=SIZE, layout="constrained").add_subplot(**_projection(view))
    return axes


def _projection(view: View) -> dict[str, str]:
    return {"projection": "3d"} if len(view.low) == 3 else {}


def _writer(file: Path, fps: float) -> Any:
    with needs("A movie", "report"):
        from matplotlib.animation import FFMpegWriter, PillowWriter

    kinds: dict[str, Any] = {".gif": PillowWriter, ".mp4": FFMpegWriter}
    kind = kinds.get(file.suffix.lower())
    if kind is None:
        raise InvalidProblem(f"file = {describe(str(file))}: must end in .gif or .mp4")
    if not kind.isAvailable():
        raise InvalidProblem(
            f"file = {describe(str(file))}: .mp4 needs the program ffmpeg, which is missing; take .gif"
        )
    return kind(fps=fps)


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
    _draw_until(ax, view, times, np.concatenate((film.problem.x0[None], film.x[first:])))
    ax.set_title(film.title)


def _draw_until(ax: Axes, view: View, times: Floats, states: Floats) -> None:
    """States (K, N, d) at ``times`` (K,), the last one is now."""
    draw = (_draw_line, _draw_plane, _draw_space)[len(view.low) - 1]
    draw(ax, view, times, states)


# One dimension: places over time.


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
    """One obstacle at all times."""
    first = history[0]
    if isinstance(first, Wall):
        edge = np.array([wall.offset / wall.normal[0] for wall in history])
        beyond = view.low[0] if first.normal[0] > 0 else view.high[0]
        ax.fill_between(times, edge, np.full_like(edge, beyond), color=OBSTACLE, lw=0, zorder=0)
    if isinstance(first, Ball):
        low, high = (np.array([b.centre[0] + side * b.radius for b in history]) for side in (-1, 1))
        ax.fill_between(times, low, high, color="none" if first.inside else OBSTACLE, ec=GREY, zorder=0)


# Two dimensions.


def _draw_plane(ax: Axes, view: View, times: Floats, states: Floats) -> None:
    for shape in shapes_at(view.problem, float(times[-1])):
        _draw_shape_in_plane(ax, view, shape, states[-1])
    for k in range(min(states.shape[1], MOST_TRACES)):
        ax.plot(*states[:, k].T, color=EDGE, alpha=0.35, lw=0.8, zorder=3)
    first, last = (radii(view.problem, float(t)) for t in (times[0], times[-1]))
    _draw_discs(ax, states[0], first, facecolor="none", edgecolor=EDGE, alpha=0.3, lw=0.6, zorder=1)
    _draw_discs(ax, states[-1], last, facecolor=FILL, edgecolor=EDGE, lw=0.8, zorder=2)
    ax.set(xlim=(view.low[0], view.high[0]), ylim=(view.low[1], view.high[1]), aspect="equal", xlabel="x", ylabel="y")


def _draw_discs(ax: Axes, x: Floats, radius: Floats, **look: Any) -> None:
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Circle

    point = radius == 0
    ax.scatter(x[point, 0], x[point, 1], s=14, **look)
    ax.add_collection(
        PatchCollection([Circle(tuple(c), r) for c, r in zip(x[~point], radius[~point], strict=True)], **look)
    )


def _draw_shape_in_plane(ax: Axes, view: View, shape: Any, x: Floats) -> None:
    from matplotlib.patches import Circle, Polygon

    if isinstance(shape, Wall):
        along, far = np.array([-shape.normal[1], shape.normal[0]]), 4 * float(np.abs([view.low, view.high]).max())
        foot = shape.offset * shape.normal
        corners = [foot - far * along, foot + far * along, foot + far * (along - shape.normal)]
        ax.add_patch(Polygon([*corners, foot - far * (along + shape.normal)], color=OBSTACLE, lw=0, zorder=0))
    elif isinstance(shape, Ball):
        face = "none" if shape.inside else OBSTACLE
        ax.add_patch(Circle(tuple(shape.centre), shape.radius, facecolor=face, edgecolor=GREY, zorder=0))
    elif isinstance(shape, Bonds):
        for i, j in shape.pairs:
            ax.plot(*x[[i, j]].T, color=GREY, lw=0.9, zorder=4)
    elif isinstance(shape, Curve):
        _draw_level(ax, view, shape)


def _draw_level(ax: Axes, view: View, curve: Curve, *, filled: bool = True) -> None:
    axes = [np.linspace(low, high, LEVEL_POINTS) for low, high in zip(view.low, view.high, strict=True)]
    values = values_on_grid(curve, *axes)
    if values.min() < 0 < values.max():
        if filled:
            ax.contourf(*axes, values, levels=[-np.inf, 0.0], colors=[OBSTACLE], zorder=0)
        lines: Any = {"linestyles": "solid" if filled else "dotted", "linewidths": 1.0 if filled else 0.8}
        ax.contour(*axes, values, levels=[0.0], colors=[GREY], zorder=0, **lines)


def _draw_outline(ax: Axes, view: View, shape: Any) -> None:
    """Draw the boundary of a set in the plane, at a later time."""
    from matplotlib.patches import Circle

    if isinstance(shape, Wall):
        along, foot = np.array([-shape.normal[1], shape.normal[0]]), shape.offset * shape.normal
        ax.axline(tuple(foot), tuple(foot + along), color=GREY, lw=0.8, ls=":", zorder=1)
    elif isinstance(shape, Ball):
        ax.add_patch(Circle(tuple(shape.centre), shape.radius, fill=False, ec=GREY, lw=0.8, ls=":", zorder=1))
    elif isinstance(shape, Curve):
        _draw_level(ax, view, shape, filled=False)


# Three dimensions.


def _draw_space(ax: Any, view: View, times: Floats, states: Floats) -> None:
    ax.computed_zorder = True
    for shape in shapes_at(view.problem, float(times[-1])):
        _draw_shape_in_space(ax, view, shape, states[-1])
    radius = radii(view.problem, float(times[-1]))
    for k in range(min(len(radius), MOST_TRACES)):
        ax.plot(*states[:, k].T, color=EDGE, alpha=0.35, lw=0.8)
    many = len(radius) > MOST_SURFACES
    for centre, r in zip(states[-1], radius, strict=True):
        if r and not many:
            _draw_ball(ax, centre, r, color=FILL, edgecolor="none", shade=True)
    dots = states[-1] if many else states[-1][radius == 0]
    ax.scatter(*dots.T, s=14, color=FILL, edgecolor=EDGE)
    limits = dict(zip(("xlim", "ylim", "zlim"), zip(view.low, view.high, strict=True), strict=True))
    ax.set(**limits, xlabel="x", ylabel="y", zlabel="z")
    ax.set_box_aspect(view.high - view.low)


def _draw_ball(ax: Any, centre: Floats, radius: float, **look: Any) -> None:
    around, up = np.meshgrid(np.linspace(0, 2 * np.pi, 17), np.linspace(0, np.pi, 10))
    sphere = np.array([np.sin(up) * np.cos(around), np.sin(up) * np.sin(around), np.cos(up)])
    ax.plot_surface(*(centre[:, None, None] + radius * sphere), rstride=1, cstride=1, **look)


def _draw_shape_in_space(ax: Any, view: View, shape: Any, x: Floats) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    if isinstance(shape, Wall):
        corners = shape.cut(view.low, view.high)
        if len(corners) >= 3:
            ax.add_collection3d(Poly3DCollection([corners], facecolor=OBSTACLE, edgecolor=GREY, alpha=0.12))
    elif isinstance(shape, Ball):
        look = {"color": GREY, "alpha": 0.08} if shape.inside else {"color": OBSTACLE, "alpha": 0.9}
        _draw_ball(ax, shape.centre, shape.radius, **look)
    elif isinstance(shape, Bonds):
        for i, j in shape.pairs:
            ax.plot(*x[[i, j]].T, color=GREY, lw=0.9)
