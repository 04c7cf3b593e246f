"""The figures, from tables only."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.scenes import Scene
from verification.page.sheet import GREY, NOTE, WIDTH, Axes, discs, polygon, sheet
from verification.thesis.chapter2.methods import METHODS, PBD, PENALTIES, PENALTY_PRINTED, NamedMethod

Floats = NDArray[np.float64]
DISC, WALL = "#9db8d2", "#d9d5cd"
# Values below these are drawn on the lower edge: they are rounding, or an overlap that nobody sees.
LOWEST = {"error": 1e-8, "infeasibility": 1e-6, "growth": 0.0}
LABELS = {"error": "error, largest over all discs [length]", "infeasibility": "largest overlap [length]"}


def against_step(table: pd.DataFrame, scene: str, quantity: str, path: Path) -> Path:
    """Draw ``quantity`` ("error" or "infeasibility") against dt, a panel for each time, failed runs on top."""
    rows = table[table["scene"] == scene]
    times = sorted(rows["t"].unique())
    with sheet(path, 4.3) as figure:
        panels = np.atleast_1d(figure.subplots(1, len(times), sharex=True, sharey=True))
        for panel, t in zip(panels, times, strict=True):
            now = rows[rows["t"] == t]
            for method in [METHODS[name] for name in METHODS if name in set(now["method"])]:
                error_curve(panel, now[now["method"] == method.name], method, quantity)
            if quantity == "error":
                _reference_band(panel, float(now["reference_error"].iloc[0]))
            slope_one(panel, now, quantity)
            panel.set(title=f"t = {t:g}", xlabel="step dt [time]")
        panels[0].set(ylabel=LABELS[quantity], ylim=(LOWEST[quantity] / 3, 3))
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return path


def error_curve(panel: Axes, rows: pd.DataFrame, method: NamedMethod, quantity: str) -> None:
    """Draw a curve with markers; values too small to matter are markers on the lower edge, without a line to them."""
    rows = rows.sort_values("dt")
    values, lowest = rows[quantity].to_numpy(), LOWEST[quantity]
    look: dict[str, Any] = {"color": method.colour, "marker": method.marker}
    if method.line == "--":
        look |= {"markerfacecolor": "none", "markersize": 7.5}
    elif method.line == ":":
        look |= {"markerfacecolor": "none"}
    panel.loglog(rows["dt"], np.where(values > lowest, values, np.nan), label=method.label, ls=method.line, **look)
    panel.loglog(rows["dt"], np.where(values <= lowest, lowest, np.nan), ls="none", **look)
    for dt in rows.loc[rows[quantity].isna(), "dt"]:
        panel.plot(dt, 0.97, "x", color=method.colour, transform=panel.get_xaxis_transform(), markersize=6, mew=1.6)


def _reference_band(panel: Axes, error: float) -> None:
    lowest = LOWEST["error"]
    panel.axhspan(lowest / 3, max(error, lowest), color="#e9e9e9", zorder=0)
    top = error if error > lowest else 1.7 * lowest  # above the markers on the lower edge
    text = f"error of the reference {error:.0e}"
    panel.text(0.02, top, text, transform=panel.get_yaxis_transform(), va="bottom", color=GREY, fontsize=NOTE)


def slope_one(panel: Axes, rows: pd.DataFrame, quantity: str) -> None:
    """Draw a guide of slope 1 that ends at the coarsest step, below the curve of PBD."""
    mine = rows[(rows["method"] == PBD.name) & (rows["status"] == "SUCCESS")].sort_values("dt")
    steps = np.array([mine["dt"].min(), mine["dt"].max()])
    guide = steps * float(mine[quantity].iloc[0] / mine["dt"].iloc[0]) / 6
    panel.loglog(steps, guide, color=GREY, linewidth=0.9, linestyle=(0, (1, 1.2)), zorder=1)
    panel.text(steps[0] * 1.15, guide[0] * 0.42, "slope 1", color=GREY, fontsize=NOTE)


def infeasibility_in_time(curves: pd.DataFrame, scenes: Sequence[Scene], path: Path) -> Path:
    """Draw Figure 6: largest overlap after every step, PBD solid, the penalty method with its best strength dashed."""
    steps = sorted(curves["dt"].unique(), reverse=True)
    with sheet(path, 2.5 * len(steps) + 0.5) as figure:
        panels = figure.subplots(len(steps), len(scenes), sharex="col", squeeze=False)
        for row, dt in zip(panels, steps, strict=True):
            for panel, scene in zip(row, scenes, strict=True):
                now = curves[(curves["scene"] == scene.name) & (curves["dt"] == dt)]
                for (exponent, strength), one in now.groupby(["exponent", "strength"]):
                    label, look = _contestant(exponent, strength)
                    panel.plot(one["t"], one["infeasibility"], label=label, **look)
                panel.set(title=f"{scene.title}, dt = {dt:g}", xlim=(0, scene.times[-1]))
                panel.set_ylim(0, 1.45 * float(now["infeasibility"].max()))
                panel.legend(loc="upper right", fontsize=NOTE, ncols=1, borderaxespad=0.1)
        for panel in panels[:, 0]:
            panel.set_ylabel("largest overlap [length]")
        for panel in panels[-1]:
            panel.set_xlabel("t [time]")
    return path


def _contestant(exponent: int, strength: float) -> tuple[str, dict[str, Any]]:
    if exponent == 0:
        return "PBD", {"color": PBD.colour, "zorder": 3}
    if exponent == 2:
        return f"penalty, springs, strength {strength:.3g}", {"color": PENALTIES[1].colour, "linestyle": "--"}
    look = {"color": PENALTY_PRINTED.colour, "linestyle": (0, (2, 1)), "linewidth": 0.7}
    return f"penalty as printed of strength {strength:.3g}", look


def strengths(scanned: pd.DataFrame, scenes: Sequence[Scene], path: Path) -> Path:
    """Draw largest infeasibility in time and error of the positions against the penalty strength, at each step."""
    dt = float(scanned["dt"].min())
    with sheet(path, 3.3) as figure:
        panels = figure.subplots(1, len(scenes), sharey=True)
        for panel, scene in zip(panels, scenes, strict=True):
            now = scanned[(scanned["scene"] == scene.name) & (scanned["dt"] == dt)]
            for exponent, name, colour in (
                (2, "springs", PENALTIES[1].colour),
                (1, "as printed", PENALTY_PRINTED.colour),
            ):
                one = now[now["exponent"] == exponent].sort_values("strength")
                panel.loglog(
                    one["strength"], one["largest"].clip(lower=1e-4), color=colour, label=f"{name}: infeasibility"
                )
                panel.loglog(
                    one["strength"], one["error"], color=colour, linestyle=":", label=f"{name}: error of positions"
                )
            pbd = now[now["exponent"] == 0].iloc[0]
            panel.axhline(pbd["largest"], color=PBD.colour, label="PBD: infeasibility")
            panel.axhline(pbd["error"], color=PBD.colour, linestyle=":", label="PBD: error of positions")
            panel.set(title=f"{scene.title}, dt = {dt:g}", xlabel="penalty strength")
        panels[0].set_ylabel("largest over time [length]")
        panels[0].set_ylim(1e-3, 20)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return path


def large_steps(table: pd.DataFrame, far: float, scenes: Sequence[Scene], path: Path) -> Path:
    """Draw how many times farther out than at the start a disc gets, against dt; runs that stopped as crosses."""
    with sheet(path, 3.2) as figure:
        panels = figure.subplots(1, len(scenes), sharey=True)
        for panel, scene in zip(panels, scenes, strict=True):
            now = table[table["scene"] == scene.name]
            now = now.assign(growth=now["growth"].clip(upper=1e3).where(now["status"] == "SUCCESS"))
            for method in [METHODS[name] for name in METHODS if name in set(now["method"])]:
                error_curve(panel, now[now["method"] == method.name], method, "growth")
            panel.axhspan(far, 2e3, color="#f6ece6", zorder=0)
            panel.set(title=scene.title, xlabel="step dt [time]")
            panel.text(0.02, far * 1.1, "unstable", transform=panel.get_yaxis_transform(), color=GREY, fontsize=NOTE)
        panels[0].set_ylabel("largest coordinate / at the start")
        panels[0].set_ylim(0.7, 2e3)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return path


def motion(scene: Scene, t: Sequence[float], x: Floats, path: Path) -> Path:
    """Draw discs to scale and walls, one panel for each time; ``x`` of shape (K, N, 2)."""
    low = (x - scene.radius[:, None]).min(axis=(0, 1)) - 0.2
    high = (x + scene.radius[:, None]).max(axis=(0, 1)) + 0.2
    height = WIDTH / len(t) * float((high - low)[1] / (high - low)[0]) + 0.45
    with sheet(path, height, **{"axes.grid": False}) as figure:
        for panel, time, state in zip(figure.subplots(1, len(t)), t, x, strict=True):
            for constraint in scene.constraints:
                if isinstance(constraint, dincl.HalfSpace):
                    polygon(panel, _wall(constraint), facecolor=WALL, edgecolor="#6b675f", linewidth=1.2)
            discs(panel, state, scene.radius, facecolor=DISC, edgecolor="#2f4b66", linewidth=0.9)
            for number, centre in enumerate(state):
                panel.text(*centre, str(number), ha="center", va="center", fontsize=NOTE, color="#2f4b66")
            panel.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xticks=[], yticks=[])
            panel.set_title(f"t = {time:g}", loc="center")
            panel.spines[:].set_visible(False)
    return path


def _wall(wall: dincl.HalfSpace) -> Floats:
    """Return a long rectangle behind the wall n . x = offset."""
    normal = np.asarray(wall.normal)
    along, foot, far = np.array([-normal[1], normal[0]]), wall.offset * normal, 50.0  # longer than any picture
    return np.array(
        [foot - far * along, foot + far * along, foot + far * (along - normal), foot - far * (along + normal)]
    )
