"""Speed against accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from verification.budget import GRACE
from verification.cheapest import LEAST_SPREAD, RESOLVED, UNDECIDED
from verification.measure import BRIEF, REPEATS
from verification.page.parts import Chart, Grid, Picture, Section, Text, number
from verification.page.prose import fill
from verification.page.report import Chapter, Context, Finding
from verification.speed_accuracy import TARGETS
from verification.thesis.chapter2 import (
    cheapest,
    figures_work_precision,
    kept_winners,
    reach,
    work_precision,
    work_references,
)
from verification.thesis.chapter2.methods import EVENT_DRIVEN, METHODS, PBD
from verification.thesis.chapter2.work_references import SCENES

WINNERS = {
    "scene": "Scene",
    "target": "Error",
    "cheapest": "Cheapest",
    "cost": "CPU seconds",
    "tied": "Within the spread",
    "next": "Next",
    "ratio": "takes times as long",
    "pbd_ratio": "PBD takes times as long",
}
TIMES = {"method": "Method", "order": "Order in dt [95 %]"} | {
    f"{target:g}": f"s to {number(target)}" for target in TARGETS
}
TIMES |= {"best": "Best error", "at_end": "at the end, of it", "failed": "Failed"}
RUNS = {
    "method": "Method",
    "setting": "dt or tol",
    "status": "Status",
    "cpu_seconds": "CPU seconds",
    "repeats": "Repeats",
    "spread": "Median over shortest",
    "disturbed": "Disturbed",
    "drift_evaluations": "Drift evaluations",
    "candidate_pairs": "Pairs in sweeps",
    "solver_iterations": "Solver iterations",
    "largest": "Largest error",
    "final": "Error at the end",
    "overlap": "Overlap",
    "detail": "Detail",
}
REACH = {"discs": "Discs", "events": "Events", "target": "Error", "cheapest": "Cheapest"} | {
    method.name: method.label for method in reach.METHODS
}
CHEAPEST = "Who is cheapest"
# Of the question that users ask first: ten discs to this error.
TEN, MODERATE = "ten_disks_corner", 1e-4
PROSE = Path(__file__).parent / "prose"


def run(context: Context) -> None:
    """Complete the references and the study; keep what they say."""
    form = _form(context)
    known, table = work_precision.complete(form, context.folder, context.executor)
    context.tables |= {"work_references": known, "work_precision": table}
    context.keep("work_times", cheapest.times(table, form))
    context.keep("work_winners", cheapest.winners(table, form))
    context.keep("work_reach", reach.table())


def sections(context: Context) -> Sequence[Section]:
    """What is measured and who wins, then one section for each scene."""
    return [_summary(context), _reach(context), *(_scene(context, name) for name in _form(context).scenes)]


def _named(table: pd.DataFrame, headings: dict[str, str]) -> pd.DataFrame:
    """The columns of a table that a reader wants, with words for names."""
    words = {method.name: method.label for method in METHODS.values()}
    titles = {name: make().title for name, make in SCENES.items()}
    return table[list(headings)].replace({"method": words, "scene": titles}).rename(columns=headings)


def _form(context: Context) -> work_precision.Form:
    return context.form(work_precision.SHORT, work_precision.FULL)


def _summary(context: Context) -> Section:
    winners = context.tables["work_winners"]
    said = fill(
        PROSE / "work_precision.html",
        every=work_references.EVERY,
        tol=work_references.TOL,
        repeats=REPEATS,
        brief=BRIEF,
        least_spread=LEAST_SPREAD,
        resolved=RESOLVED,
        budget=_form(context).budget,
        grace=GRACE,
    )
    labels = _named(winners, WINNERS)
    wide = labels.pivot(index="Scene", columns="Error", values="Cheapest").rename_axis(columns=None)
    wide = wide[sorted(wide, reverse=True)].rename(columns=number).reset_index()
    grids = Grid(wide, said["wide"], "work_winners"), Grid(labels, said["table"], "work_winners", folded=True)
    texts = [Text(said[name]) for name in ("error", "time", "second_order", "yardsticks", "references", "limits")]
    return Section(CHEAPEST, [Text(cheapest.summary(winners)), *grids, *texts])


def _reach(context: Context) -> Section:
    said = reach.said()
    grid = Grid(_named(context.tables["work_reach"], REACH), said["table"], "work_reach")
    return Section("How far the event-driven scheme pays", [Text(said["said"]), grid])


def _scene(context: Context, name: str) -> Section:
    from verification.page.interactive import draw_work_precision

    table, times, winners = (context.tables[one] for one in ("work_precision", "work_times", "work_winners"))
    path = context.draw(f"work_precision_{name}", figures_work_precision.draw_chart, table, name, _form(context))
    said, one = fill(PROSE / "work_scene.html"), work_precision.chart(table, name, _form(context))
    html = draw_work_precision(one.table, one.looks, one.errors[0], "cpu_seconds")
    return Section(
        f"Speed against accuracy: {SCENES[name]().title.lower()}",
        [
            Text(cheapest.sentence(winners[winners["scene"] == name])),
            Chart(html, said["interactive"], Picture(path, said["chart"])),
            Grid(_named(times[times["scene"] == name], TIMES), said["times"], "work_times"),
            Grid(_named(table[table["scene"] == name], RUNS), said["runs"], _file(context), folded=True),
        ],
    )


def _file(context: Context) -> str:
    return f"work_precision{'_full' if context.full else ''}"


def findings(context: Context) -> Sequence[Finding]:
    """Who is cheapest by the complete chart, which ships, and on ten discs to a moderate error."""
    winners = context.tables["work_winners"] if context.full else pd.read_parquet(kept_winners.FILE)
    alone = winners[~winners["cheapest"].isin(UNDECIDED)]["cheapest"]
    row = winners[(winners["scene"] == TEN) & (winners["target"] == MODERATE)].iloc[0]
    said = fill(
        PROSE / "learned_speed.html",
        pairs=len(winners),
        alone=len(alone),
        own=int((alone == EVENT_DRIVEN.label).sum()),
        pbd=int((alone == PBD.label).sum()),
        target=MODERATE,
        methods=row["tied"].split("; "),
        seconds=row["cost"],
        times=row["pbd_ratio"],
    )
    return [Finding(said["winners"], CHEAPEST), Finding(said["ten"], CHEAPEST)]


CHAPTER = Chapter(
    "speed",
    "Speed against accuracy",
    "Which method reaches an error in the least time, on which scene?",
    run,
    sections,
    findings,
    place=2,
    tables=("work_",),
)
