"""States of a problem with its paths and sets, drawn in one, two or three dimensions; imports matplotlib, on use.

This is the one file of the package that does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.region import values_on_grid
from dincl.shapes import Ball, Bonds, Curve, Wall, radii, shapes_at

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from dincl.problem import Problem

MAKES_NO_NUMBERS = True

__all__ = [
    "DPI",
    "Axes",
    "Floats",
    "View",
    "draw_outlines",
    "draw_until",
    "log_ticks",
    "movie_writer",
    "new_axes",
    "own_figure",
    "projection",
    "style",
]

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
# Logarithmic axes over a ratio above LONG have ticks at powers of ten alone, below at 1 and 3 times them, below SHORT
# at 1, 2 and 5 times them; below SHORTEST, where these may be a single tick, at equal distances.
LONG, SHORT, SHORTEST = 100.0, 10.0, 5.0
MOST_TICKS = 5
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


def style() -> Any:
    """Return a context in which pictures are drawn in the style of this package."""
    with needs("A picture", "report"):
        from matplotlib import rc_context

    return rc_context(STYLE)


def own_figure() -> Figure:
    """Return a figure that no window and no notebook knows of."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained", dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def new_axes(view: View) -> Axes:
    """Return axes of a new figure of pyplot."""
    from matplotlib import pyplot as plt

    axes: Axes = plt.figure(figsize=SIZE, layout="constrained").add_subplot(**projection(view))
    return axes


def projection(view: View) -> dict[str, str]:
    """Return the keywords that make axes have the dimension of a view."""
    return {"projection": "3d"} if len(view.low) == 3 else {}


def movie_writer(file: Path, fps: float) -> Any:
    """Return the writer of matplotlib for the ending of a file; InvalidProblem for another ending."""
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


def draw_until(ax: Axes, view: View, times: Floats, states: Floats) -> None:
    """Draw states (K, N, d) at ``times`` (K,), the last one is now."""
    draw = (_draw_line, _draw_plane, _draw_space)[len(view.low) - 1]
    draw(ax, view, times, states)


def draw_outlines(ax: Axes, view: View, t: float) -> None:
    """Draw the boundaries of the sets in the plane at a later time."""
    from matplotlib.patches import Circle

    for shape in shapes_at(view.problem, t):
        if isinstance(shape, Wall):
            along, foot = np.array([-shape.normal[1], shape.normal[0]]), shape.offset * shape.normal
            ax.axline(tuple(foot), tuple(foot + along), color=GREY, lw=0.8, ls=":", zorder=1)
        elif isinstance(shape, Ball):
            ax.add_patch(Circle(tuple(shape.centre), shape.radius, fill=False, ec=GREY, lw=0.8, ls=":", zorder=1))
        elif isinstance(shape, Curve):
            _draw_level(ax, view, shape, filled=False)


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
