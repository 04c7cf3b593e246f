"""The experiments of chapter 2 of the thesis, section 4."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pandas as pd

from dincl.scenes import Scene
from verification.page.columns import Columns, headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, HowMeasured, Picture, Section, Text, number
from verification.page.prose import fill
from verification.page.report import Chapter, Finding
from verification.thesis.chapter2 import convergence, exactness, extrapolation, infeasibility, large_steps, reference
from verification.thesis.chapter2 import figures as plots
from verification.thesis.chapter2.methods import CATCH_UP, LINEARISED_DAQP, METHODS, PBD
from verification.thesis.chapter2.runs import scene
from verification.thesis.chapter2.tables import POSITIONS

# Of each scene [time]; all of them are among the output times of the reference.
SHOWN = {"four_disks": (0.0, 0.5, 1.0, 1.5, 2.0), "ten_disks_corner": (0.0, 1.0, 1.5, 2.0, 3.0)}
CROWD = "ten_disks_corner"
# With the two finest steps costly methods would take hours.
COMPARED = replace(convergence.FULL, costly_steps=8)
# Recomputed: runs on this scene, with no finer steps [time], and so many of a study; exactness on all but one scene.
QUICK, COARSE, MOST, SLOW = "four_disks", 0.1 / 2**4, 20, "growing_discs"
PROSE = Path(__file__).parent / "prose"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLES = COLUMNS["sections"]


def run(context: Context) -> None:
    """Complete all studies of this chapter."""
    for study in (solve, prove, extrapolate, converge, overlap, stride):
        study(context)


def solve(context: Context) -> None:
    """Compute the reference solutions."""
    solved = reference.study(convergence.SCENES)
    context.tables["positions"] = context.rows_of(solved, solved.only(lambda key: key["scene"] == QUICK))


def prove(context: Context) -> None:
    """Compare stated and true errors of references where solutions are known."""
    exact = exactness.study()
    context.tables["exactness"] = context.rows_of(exact, exact.only(lambda key: key["scene"] != SLOW))


def extrapolate(context: Context) -> None:
    """Compare the references with the limits of both convergent methods."""
    linearised = {"method": LINEARISED_DAQP.name, "scene": QUICK}
    catch_up = extrapolation.study(convergence.SCENES, context.form(extrapolation.FULL))
    rows = context.rows_of(catch_up, catch_up.only(lambda key: linearised.items() <= key.items()))
    context.tables["catch_up"], times = rows, {one.name: one.times for one in _both()}
    context.keep("references", extrapolation.summary(_references(context), rows, times))


def converge(context: Context) -> None:
    """Compare the methods with the references, and estimate their orders."""
    compared = convergence.study(_references(context), context.form(COMPARED))
    context.tables["convergence"] = context.rows_of(compared, compared.only(lambda key: key["dt"] >= COARSE))
    context.keep("orders", convergence.orders(context.tables["convergence"]))


def overlap(context: Context) -> None:
    """Look for the best strengths of penalty methods."""
    form = context.form(infeasibility.FULL)
    scan = infeasibility.scan(_references(context), form)
    context.tables["penalty_scan"] = context.rows_of(scan, scan.only(lambda key: key["dt"] == max(form.steps)))
    context.keep("penalty_best", infeasibility.best_strengths(context.tables["penalty_scan"]))
    curves = infeasibility.curves(context.tables["penalty_scan"], form)
    context.tables["infeasibility"] = context.rows_of(curves, curves.only(lambda key: key["dt"] == max(form.steps)))


def stride(context: Context) -> None:
    """Try large steps."""
    large = large_steps.study(context.form(large_steps.FORM))
    context.tables["large_steps"] = context.rows_of(large, large.some(MOST))


def _references(context: Context) -> dict[str, reference.EventReference]:
    positions = context.table(POSITIONS)
    return {name: reference.reference(positions, name) for name in convergence.SCENES}


def sections(context: Context) -> Sequence[Section]:
    """Write about the two scenes, the reference, convergence, infeasibility and large steps."""
    return [
        _scenes(context),
        _reference(context),
        *(_convergence(context, name) for name in convergence.SCENES),
        _penalty(context),
        _large(context),
    ]


@cache
def _both() -> tuple[Scene, ...]:
    """Return the scenes; making them compiles the search for neighbours, for which no import should wait."""
    return tuple(scene(name) for name in convergence.SCENES)


def _named(table: pd.DataFrame, columns: Columns) -> pd.DataFrame:
    """Return the columns that the page shows, with words for names of methods and scenes."""
    words = {method.name: method.label for method in METHODS.values()} | {one.name: one.title for one in _both()}
    return headed(table[list(columns)].replace(words), columns)


def _scenes(context: Context) -> Section:
    said = fill(PROSE / "scenes.html")
    pictures = []
    for one in _both():
        own = reference.reference(context.tables["positions"], one.name)
        path = context.draw(f"motion_{one.name}", plots.motion, one, SHOWN[one.name], own.at(SHOWN[one.name])[0])
        pictures.append(Picture(path, said[one.name]))
    return Section(TITLES["scenes"], [Text(said["intro"]), *pictures, Follows(said["follows"])])


def _reference(context: Context) -> Section:
    table, runs = context.tables["references"], context.tables["catch_up"]
    steps = sorted(runs[runs["method"] == CATCH_UP.name]["dt"].unique(), reverse=True)
    said = fill(
        PROSE / "reference.html",
        tol=reference.TOL,
        steps=[number(dt) for dt in steps],
        within=int((table["catch_up"] <= table["error"] + table["catch_up_error"]).sum()),
        count=len(table),
        worst=table["error"].max(),
    )
    grid = Grid(_named(table, COLUMNS["reference"]), said["table"], "references")
    method = HowMeasured([Text(said["events"]), Text(said["checks"])])
    return Section(TITLES["reference"], [Follows(said["follows"]), grid, method])


def _title(name: str) -> str:
    return f"{TITLES['convergence']} {scene(name).title}"


def _convergence(context: Context, name: str) -> Section:
    table, orders = context.tables["convergence"], context.tables["orders"]
    mine = orders[orders["scene"] == name]
    pbd = mine[mine["method"] == PBD.name]
    slopes = pbd["slope"].min(), pbd["slope"].max()
    said = fill(PROSE / "convergence.html", pbd=list(pbd.itertuples()), slopes=slopes)
    return Section(
        _title(name),
        [
            Text(said["orders"]),
            *(
                Picture(context.draw(f"{kind}_{name}", plots.against_step, table, name, kind), said[kind])
                for kind in ("error", "infeasibility")
            ),
            Grid(_named(mine, COLUMNS["orders"]), said["table"], "orders"),
            Grid(_named(mine, COLUMNS["words"]), said["words"], "orders", folded=True),
            Follows(said["follows"]),
        ],
    )


def _penalty(context: Context) -> Section:
    best, form = context.tables["penalty_best"], context.form(infeasibility.FULL)
    kinds = best.assign(kind=best["exponent"].map({1: "as printed", 2: "springs"}))
    springs = best[best["exponent"] == 2]
    times = springs["largest"] / springs["pbd_largest"]
    said = fill(
        PROSE / "penalty.html",
        count=len(form.springs),
        comparable=infeasibility.COMPARABLE,
        width=infeasibility.WIDTH,
        times=(times.min(), times.max()),
    )
    curves = context.tables["infeasibility"]
    drawn = curves[curves["dt"].isin(form.steps[: infeasibility.DRAWN])]
    in_time = context.draw("infeasibility_in_time", plots.infeasibility_in_time, drawn, _both())
    scan = context.draw("penalty_strengths", plots.strengths, context.tables["penalty_scan"], _both())
    return Section(
        TITLES["penalty"],
        [
            Text(said["strengths"]),
            Picture(in_time, said["in_time"]),
            Picture(scan, said["scan"]),
            Grid(_named(kinds, COLUMNS["best"]), said["table"], "penalty_best"),
            Follows(said["follows"]),
        ],
    )


def _large(context: Context) -> Section:
    figure = context.draw("large_steps", plots.large_steps, context.tables["large_steps"], large_steps.FAR, _both())
    said = fill(PROSE / "large_steps.html", end=large_steps.END)
    parts = Text(said["runs"]), Picture(figure, said["picture"]), Follows(said["follows"])
    return Section(TITLES["large_steps"], parts)


def findings(context: Context) -> Sequence[Finding]:
    """Say which order PBD has, and how its error compares with catch-up."""
    orders, table = context.tables["orders"], context.tables["convergence"]
    mine = orders[orders["method"] == PBD.name]
    crowd = table[(table["scene"] == CROWD) & (table["t"] < table["t"].max())]
    errors = crowd.pivot_table(index=["dt", "t"], columns="method", values="error")[[PBD.name, CATCH_UP.name]].dropna()
    ratios = (errors[PBD.name] / errors[CATCH_UP.name]).loc[errors.index.get_level_values("dt").min()]
    said = fill(
        PROSE / "learned_experiments.html",
        orders=(mine["low"].min(), mine["high"].max()),
        ratios=(ratios.min(), ratios.max()),
    )
    return [Finding(said["order"], _title(CROWD))]


CHAPTER = Chapter(
    "experiments",
    "Numerical experiments with first-order PBD",
    "Do first-order PBD and catch-up converge on discs, with which order, and how much do discs overlap on the way?",
    run,
    sections,
    findings,
    place=1,
    tables=(
        "positions",
        "exactness",
        "catch_up",
        "references",
        "convergence",
        "orders",
        "penalty_",
        "infeasibility",
        "large_steps",
    ),
)
