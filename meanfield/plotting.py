"""Plots of motions; the only module of this package that imports matplotlib, on use."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.extras import needs

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

# No number of a table depends on this module.
MAKES_NO_NUMBERS = True
PANEL = (4.6, 3.4)  # inches
COLOURS = ("#2f6db0", "#b8443c", "#4f9a5f", "#7b52a1", "#c9a227", "#5b5b66")
FAINT, LIGHT, GREY = 0.35, "#c9c9c9", "#8a8a8a"
# Area of a marker and width of a line, in points; largest number of paths drawn, and of times with markers.
MARKER_AREA, LINE_WIDTH, MAX_LINES = 9.0, 0.7, 60


def draw(panels: Sequence[Callable[[Any], None]], ax: Any = None) -> Any:
    """Draw panels side by side on a new figure, or the first panel on given axes; return the first panel's axes."""
    if ax is None:
        with needs("A plot", "meanfield"):
            import matplotlib.pyplot as plt

        figure = plt.figure(figsize=(PANEL[0] * len(panels), PANEL[1]), layout="constrained")
        axes = [figure.add_subplot(1, len(panels), k + 1) for k in range(len(panels))]
    else:
        axes = [ax]
    for panel, panel_axes in zip(panels, axes, strict=False):
        panel(panel_axes)
    return axes[0]


def draw_components(ax: Any, t: NDArray[np.float64], y: NDArray[np.float64], v: NDArray[np.float64]) -> None:
    """Draw the components of y as solid lines and of v as dashed lines, with markers if the times are few."""
    for k in range(y.shape[1]):
        number = f"_{k + 1}" if y.shape[1] > 1 else ""
        style = {"color": COLOURS[k % len(COLOURS)], "marker": "o" if len(t) < MAX_LINES else "", "markersize": 3.0}
        ax.plot(t, y[:, k], "-", label=f"$y{number}$", **style)
        ax.plot(t, v[:, k], "--", label=f"$v{number}$", alpha=0.7, **style)
    ax.set(xlabel="t", title="Macroscopic state y and velocity v")
    ax.legend(framealpha=0.85, edgecolor="none", ncols=2)


def draw_drifts(ax: Any, t: NDArray[np.float64], drifts: Mapping[str, NDArray[np.float64]]) -> None:
    """Draw magnitudes on a logarithmic scale; list quantities that are zero at all times in a text."""
    zero = []
    for k, (name, values) in enumerate(drifts.items()):
        size = np.abs(values)
        if (size > 0).any():
            positive = size > 0
            ax.semilogy(t[positive], size[positive], "o-", color=COLOURS[k % len(COLOURS)], markersize=3.0, label=name)
        else:
            zero.append(name)
    if zero:
        ax.text(0.02, 0.02, f"zero: {', '.join(zero)}", transform=ax.transAxes, color=GREY)
    ax.set(xlabel="t", title="Quantities that should stay zero")
    if ax.lines:
        ax.legend(frameon=False)


def draw_levels(
    ax: Any,
    plane: tuple[NDArray[np.float64], NDArray[np.float64]],
    levels: Sequence[NDArray[np.float64]],
    names: tuple[str, str],
) -> None:
    """Draw level lines of functions, the zero level thick: values ``levels`` (n1, n0) on ``plane``, (n0,) and (n1,)."""
    from matplotlib.lines import Line2D

    handles = []
    for k, values in enumerate(levels):
        colour = COLOURS[(k + 3) % len(COLOURS)]
        finite = np.ma.masked_invalid(values)
        if finite.count() == 0 or finite.min() == finite.max():
            continue
        ax.contour(*plane, finite, 12, colors=colour, linewidths=LINE_WIDTH, alpha=FAINT, linestyles="-")
        if finite.min() < 0 < finite.max():
            ax.contour(*plane, finite, [0.0], colors=colour, linewidths=2.0)
        name = f"$g_{k + 1}$" if len(levels) > 1 else "$g$"
        handles.append(Line2D([], [], color=colour, linewidth=2.0, label=f"{name} = 0, thin: = const"))
    ax.set(xlabel=names[0], ylabel=names[1])
    ax.legend(handles=[*handles, *ax.get_legend_handles_labels()[0]], framealpha=0.85, fontsize="small")


def draw_paths(ax: Any, x: NDArray[np.float64], y: NDArray[np.float64], title: str) -> None:
    """Draw the paths of particles, x and y (K, N), with a ring at the start and a dot at the end."""
    subset = slice(None, None, max(1, x.shape[1] // MAX_LINES))
    ax.plot(x[:, subset], y[:, subset], color="#333333", linewidth=LINE_WIDTH, alpha=0.6)
    if len(x):
        ax.scatter(x[0], y[0], s=MARKER_AREA, facecolors="none", edgecolors=GREY, zorder=3, label="start")
        ax.scatter(x[-1], y[-1], s=MARKER_AREA, color=COLOURS[1], zorder=4, label="end")
    ax.set_title(title)


def draw_densities(ax: Any, lines: Mapping[float, tuple[NDArray[np.float64], NDArray[np.float64]]]) -> None:
    """Draw a density on a line at several times, given at points (n,) or constant on cells with edges (n + 1,)."""
    for k, (time, (x, f)) in enumerate(lines.items()):
        style = {"color": COLOURS[0], "alpha": (k + 1) / len(lines), "label": f"t = {time:.3g}"}
        ax.plot(x, f, **style) if len(x) == len(f) else ax.stairs(f, x, **style)
    ax.set(xlabel="x", ylabel="f", title="Density")
    ax.set_ylim(bottom=0.0)
    ax.legend(frameon=False)


def draw_density_map(
    ax: Any, edges: tuple[NDArray[np.float64], ...], f: NDArray[np.float64], begin: NDArray[np.float64], times: str
) -> None:
    """Draw a density on a plane in colours, and the level of half the largest value of ``begin`` as a dashed line."""
    mesh = ax.pcolormesh(*edges, f.T, cmap="Blues", vmin=0.0)
    ax.figure.colorbar(mesh, ax=ax, label="f")
    centres = [(e[1:] + e[:-1]) / 2 for e in edges]
    ax.contour(*centres, begin.T, [float(begin.max()) / 2], colors=GREY, linestyles="--")
    ax.set(xlabel="$x_1$", ylabel="$x_2$", title=f"Density at t = {times}", aspect="equal")


def draw_nodes(ax: Any, x: NDArray[np.float64], f: NDArray[np.float64], title: str) -> None:
    """Draw points of a plane (Q, 2) in the colours of a density (Q,)."""
    markers = ax.scatter(*x.T, c=f, s=MARKER_AREA / 3, cmap="Blues", vmin=0.0)
    ax.figure.colorbar(markers, ax=ax, label="f")
    ax.set(xlabel="$x_1$", ylabel="$x_2$", title=title, aspect="equal")


def draw_bands(ax: Any, t: NDArray[np.float64], mean: NDArray[np.float64], deviation: NDArray[np.float64]) -> None:
    """Draw means (K, nx) with a band of one standard deviation (K, nx) on each side."""
    for k in range(mean.shape[1]):
        name = f"$x_{k + 1}$" if mean.shape[1] > 1 else "x"
        colour = COLOURS[k % len(COLOURS)]
        ax.plot(t, mean[:, k], color=colour, label=f"mean of {name}")
        ax.fill_between(t, mean[:, k] - deviation[:, k], mean[:, k] + deviation[:, k], color=colour, alpha=0.2)
    ax.set(xlabel="t", title="Particles: mean and standard deviation")
    ax.legend(frameon=False)
