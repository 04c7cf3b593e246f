"""The page of the tissue: accuracy, speed and stability of its substeps, its growth, DAHA."""
# ruff: noqa: RUF001 - labels for readers are written with Greek letters

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from tissue.study.outcomes import outcomes
from verification.claims import Table
from verification.site.context import Context
from verification.site.sheet import GREY, NOTE, Axes, legend_below, sheet
from verification.thesis.chapter3 import accuracy, daha, growth, stability, substeps
from verification.thesis.chapter3.daha import DOUBLED_CASE, TERMINATING
from verification.thesis.chapter3.growing import until
from verification.thesis.chapter3.growth import DOUBLED
from verification.thesis.chapter3.substeps import ENOUGH
from verification.thesis.quasi_steady.daha import simulate_quasi_steady

# The tables that claims of chapter 3 read, and what makes each.
PAGE = "verification.thesis.chapter3.page"
DAHA, ITERATIONS, DISTANCES, SPEED, FITS, SHARES = (
    Table(name, f"{PAGE}:compare")
    for name in (
        "tissue_daha",
        *(f"tissue_daha_{one}" for one in ("iterations", "distances", "speed", "fits", "shares")),
    )
)
RATIOS, DOUBLING = (Table(name, f"{PAGE}:grow") for name in ("tissue_ratios", "tissue_doubling"))
JUDGED_STEPS = Table("tissue_judged_steps", f"{PAGE}:judge")
SPACE_HEIGHTS = Table("space_heights", "verification.tissues.space.page:grow")


# Figures, from tables only.
Floats = NDArray[np.float64]
PRESETS = {"thesis": "Thesis", "published": "Published"}
# Dark to light along something that increases: times, dampings.
SHADES = ("#0b2f5b", "#0072b2", "#009e73", "#b8a200", "#e07b39", "#b8443c")
# The last time of the errors of nuclei [h]; ticks of times [ms] and of deviations of the height [%].
LAST = 10.0
MILLISECONDS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000)
PERCENT = (-1, 0, 1, 2, 5, 10, 20)
CASES = {TERMINATING: ("#0072b2", "α of Table 4"), DOUBLED_CASE: ("#d55e00", "α doubled, as (3.26) has it")}
# The range of iterations that Figure 11 is about.
ITERATION_BINS = np.geomspace(1e2, 1e5, 60)


def draw_substeps(made: pd.DataFrame, path: Path) -> Path:
    """Draw median errors of nuclei, a panel for each preset against the time, and errors of heights."""
    with sheet(path, 3.9) as figure:
        *panels, last = figure.subplots(1, len(PRESETS) + 1)
        for panel, (name, label), colour in zip(panels, PRESETS.items(), (SHADES[4], SHADES[1]), strict=True):
            mine = made[made["preset"] == name].sort_values("substeps")
            lost = mine[(mine["t"] <= LAST) & (mine["lost"] > 0)]["substeps"]
            mine = mine[~mine["substeps"].isin(lost)].assign(x=1e3 * mine["seconds"])
            for (t, rows), shade in zip(mine[mine["t"] <= LAST].groupby("t"), SHADES, strict=False):
                _resolved(panel, rows, shade, f"t = {t:g} h")
            for row in mine[mine["t"] == mine["t"].min()].itertuples():
                place: tuple[float, float] = (row.x, row.rms)
                shift: dict[str, Any] = {"xytext": (0, -11), "textcoords": "offset points"}
                panel.annotate(str(row.substeps), place, ha="center", fontsize=NOTE, **shift)
            panel.set(title=label, xlabel="ms for 10 h, with the substeps", xscale="log", yscale="log")
            low, high = panel.get_xlim()
            _plain(panel, [tick for tick in MILLISECONDS if low <= tick <= high])
            _heights(last, made[made["preset"] == name], label, colour)
        panels[0].set(ylabel="error of the nuclei [R_soft]")
        last.axhspan(-100 * ENOUGH, 100 * ENOUGH, color="#e7f0e4", zorder=0)
        last.set(title=f"Heights at {made['t'].max():g} h", xlabel="substeps in dt", ylabel="height off by [%]")
        last.set_xscale("log")
        last.set_yscale("symlog", linthresh=2, linscale=1.5)
        last.set_yticks(PERCENT, [f"{value:g}" for value in PERCENT])
        legend_below(figure, [*panels, last], 8)
    return path


def _resolved(panel: Axes, rows: pd.DataFrame, colour: str, label: str) -> None:
    """Draw a line; markers are hollow where the reference itself is no better."""
    hollow = (rows["rms"] <= rows["own"]).to_numpy()
    panel.plot(rows["x"], rows["rms"], color=colour, label=label)
    for some, face in ((rows[hollow], "white"), (rows[~hollow], colour)):
        panel.plot(some["x"], some["rms"], "o", color=colour, markerfacecolor=face)


def _heights(panel: Axes, rows: pd.DataFrame, label: str, colour: str) -> None:
    """Draw the error of the height at the last time with intervals; crosses on the upper edge: lost runs."""
    mine = rows[rows["t"] == rows["t"].max()].sort_values("substeps")
    ends = 100 * np.array([mine["deviation"] - mine["low"], mine["high"] - mine["deviation"]])
    look: dict[str, Any] = {
        "color": colour,
        "marker": "o",
        "elinewidth": 1.0,
        "capsize": 2,
        "label": f"height, {label}",
    }
    panel.errorbar(mine["substeps"], 100 * mine["deviation"], ends, **look)
    lost = mine[mine["lost"] > 0]
    panel.plot(lost["substeps"], np.full(len(lost), PERCENT[-1]), "x", color=colour)


def draw_growth(table: pd.DataFrame, finest: pd.Series, path: Path) -> Path:
    """Draw the height over the first one against time: means with bands from the least to the largest of the seeds."""
    with sheet(path, 6.2) as figure:
        panels = figure.subplots(2, len(PRESETS), sharex=True, sharey=True)
        for column, (name, label) in enumerate(PRESETS.items()):
            mine = table["preset"] == name
            own = int(table[mine]["substeps"].min())
            for row, (rows, word) in enumerate(
                ((table[mine & (table["substeps"] == own)], f"{own} substeps"), (table[mine & finest], "fine substeps"))
            ):
                _bands(panels[row, column], rows)
                panels[row, column].set_title(f"{label}, {word}")
        end = table["t"].max()
        for panel in panels.flat:
            panel.axhline(DOUBLED, color=GREY, linewidth=0.9, linestyle=":", label="doubled")
            panel.set(xlim=(0, end), xticks=np.arange(0, end + 1, 12))
        for panel in panels[:, 0]:
            panel.set_ylabel("height / height at the start")
        for panel in panels[1]:
            panel.set_xlabel("time [h]")
        legend_below(figure, panels.flat, 6)
    return path


def _bands(panel: Axes, rows: pd.DataFrame) -> None:
    """Draw one line for each damping; where seeds are lost it ends."""
    for (mu, mine), colour in zip(rows.groupby("mu"), SHADES, strict=False):
        grouped = mine.groupby("t")["ratio"]
        t, whole = np.array(list(grouped.groups)), (grouped.count() == mine["seed"].nunique()).to_numpy()
        panel.fill_between(t, grouped.min(), grouped.max(), where=whole, color=colour, alpha=0.2, linewidth=0)
        panel.plot(t, grouped.mean().where(whole), color=colour, label=f"μ = {mu:g} h")
        if not whole.all():
            last = np.flatnonzero(whole)[-1]
            panel.plot(t[last], grouped.mean().iloc[last], "x", color=colour, markersize=7, mew=1.6, clip_on=False)


def draw_iterations(table: pd.DataFrame, case: str, path: Path) -> Path:
    """Draw Figure 11: iterations per step, and where the runs ended that did not terminate."""
    rows = table[(table["kind"] == "step") & (table["case"] == case)]
    done = rows["terminated"].astype(bool)
    with sheet(path, 3.0) as figure:
        left, right = figure.subplots(1, 2)
        left.hist(rows.loc[done, "iterations"], ITERATION_BINS, color=SHADES[1])
        right.semilogy(rows.loc[done, "t"], rows.loc[done, "iterations"], ".", color=SHADES[1], markersize=3)
        right.semilogy(rows.loc[~done, "t"], rows.loc[~done, "iterations"], "x", color=SHADES[1])
        left.set(xscale="log", xlabel="iterations in a step", ylabel="steps", title="Steps that terminated")
        right.set(xlabel="time [h]", ylabel="iterations in a step", title="In time; crosses: not terminated")
    return path


def draw_damping(table: pd.DataFrame, fits: pd.DataFrame, path: Path) -> Path:
    """Draw the distance of nuclei and the heights of PBD against mu, means with intervals; dashed: the best fit."""
    shown = table[table["kind"] == "pbd"]
    with sheet(path, 3.3) as figure:
        left, right = figure.subplots(1, 2)
        for case, (colour, label) in CASES.items():
            mine = shown[shown["case"] == case].sort_values("mu")
            for panel, names in (
                (left, ("relative", "low", "high")),
                (right, ("height", "height_low", "height_high")),
            ):
                mean, low, high = (100 * mine[name].to_numpy() for name in names)
                ends = np.array([mean - low, high - mean])
                panel.errorbar(mine["mu"], mean, ends, color=colour, marker="o", label=label, elinewidth=1, capsize=2)
            for mu in fits.loc[fits["case"] == case, "mu"]:
                left.axvline(mu, color=colour, linestyle="--", linewidth=0.9)
        right.axhline(0.0, color=GREY, linewidth=0.9)
        for panel in (left, right):
            panel.set(xscale="log", xlabel="μ of PBD [h]")
            _plain(panel, set(shown["mu"]) - {0.1333, 0.15})
        left.set(title="Nuclei: distance to DAHA [%]", ylim=(0, None))
        right.set_title("Height above that of DAHA [%]")
        legend_below(figure, [right], 2)
    return path


def _plain(panel: Axes, values: Iterable[float]) -> None:
    """Draw ticks at these values, written out."""
    ticks = sorted(set(values))
    panel.set_xticks(ticks, [f"{value:g}" for value in ticks])
    panel.minorticks_off()


def prepare() -> None:
    """Let numba compile and keep what takes it longest, by the shortest runs there are; those of EMT, too."""
    brief = preset("thesis").changed(until(0.1))
    simulate(brief, 0)
    simulate_quasi_steady(brief, 0)
    outcomes(brief, [0], [0])


def grow(context: Context) -> None:
    """Take over the study of growth."""
    table = context.rows("tissue_growth")
    context.keep("tissue_ratios", growth.ratios(table))
    context.keep("tissue_doubling", growth.doubling(table))


def compare(context: Context) -> None:
    """Take over the study of DAHA."""
    table = context.rows("tissue_daha")
    failed = daha.failures(table)
    for name, made in (
        ("iterations", daha.iterations(table)),
        ("failures", failed),
        ("shares", daha.shares(failed)),
        ("distances", daha.distances(table)),
        ("speed", daha.speed(table)),
        ("fits", daha.fitted(table)),
    ):
        context.keep(f"tissue_daha_{name}", made)


def judge(context: Context) -> None:
    """Take over the study of single steps."""
    context.keep("tissue_judged_steps", accuracy.summary(context.rows("tissue_judged")))


def run(context: Context) -> None:
    """Take over all studies of the tissue."""
    made = substeps.accuracy(context.rows("tissue_substeps"))
    context.keep("tissue_accuracy", made)
    context.keep("tissue_orders", substeps.orders(made))
    context.rows("tissue_motion")
    context.keep("tissue_losses", stability.losses(context.rows(stability.NAME)))
    for part in (grow, compare, judge):
        part(context)


# Study -> the tables that have its headings.
SHOWN = {
    "tissue_substeps": ("tissue_orders", "tissue_accuracy"),
    "tissue_motion": ("tissue_motion",),
    "tissue_growth": ("tissue_doubling", "tissue_ratios"),
    "tissue_map_steps": ("tissue_losses",),
    "tissue_daha": tuple(f"tissue_daha_{name}" for name in ("iterations", "failures", "fits", "speed", "distances")),
    "tissue_judged": ("tissue_judged_steps",),
}


def show(context: Context) -> None:
    """Give accuracy, motion, growth, stability, DAHA, and single steps."""
    tables = context.tables
    for study, names in SHOWN.items():
        for name in names:
            # Presets by their titles.
            table = tables[name].replace({"preset": PRESETS})
            context.show(name, context.headed(study, table))
    context.draw("tissue_accuracy", draw_substeps, tables["tissue_accuracy"])
    context.draw("tissue_motion", accuracy.MOTION.result(tables["tissue_motion"]).draw)
    context.draw("tissue_growth", draw_growth, tables["tissue_growth"], growth.fine(tables["tissue_growth"]))
    context.draw(stability.NAME, stability.map_of(tables[stability.NAME]).draw)
    context.draw("tissue_daha_iterations", draw_iterations, tables["tissue_daha"], daha.PRINTED)
    context.draw("tissue_daha_damping", draw_damping, tables["tissue_daha_distances"], tables["tissue_daha_fits"])
    orders = tables["tissue_orders"]
    last = orders[orders["t"] == orders["t"].max()].set_index("preset")["enough"]
    context.numbers["tissue"] = f"{last['published']} substeps"
