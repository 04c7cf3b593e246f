"""Speed against accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from verification.beyond.chart import cheapest, reach, work_precision
from verification.beyond.chart import figures as figures_work_precision
from verification.beyond.chart import references as work_references
from verification.beyond.chart.references import SCENES
from verification.beyond.decisions import section as decisions
from verification.instruments.budget import GRACE, CpuSeconds
from verification.instruments.chart import TARGETS
from verification.instruments.cheapest import LEAST_SPREAD, RESOLVED, UNDECIDED, costs
from verification.instruments.measure import BRIEF, REPEATS
from verification.page import cards
from verification.page.columns import Columns, headed, read_columns
from verification.page.context import Context
from verification.page.parts import Chart, Follows, Grid, HowMeasured, Part, Picture, Section, Text, number
from verification.page.prose import fill
from verification.page.report import Card, Chapter, Finding
from verification.thesis.chapter2.methods import EVENT_DRIVEN, LINEARISED_ACTIVE, METHODS, MIDPOINT_ACTIVE, PBD

COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLES = COLUMNS["sections"]
TIMES = {**COLUMNS["times"], **{f"{error:g}": f"s to {number(error)}" for error in TARGETS}, **COLUMNS["times_end"]}
REACH = {**COLUMNS["reach"], **{method.name: method.label for method in reach.METHODS}}
STUDY = "work_precision"
# Made again on the machine of the reader: a few settings on the small scenes, within a fraction of a second each.
AGAIN = work_precision.Form(
    {"dt": [0.1 / 8**k for k in range(5)], "tol": [1e-2, 1e-6, 1e-10]},
    CpuSeconds(0.1),
    scenes=("sliding_disc", "stack", "four_disks", "ten_disks_corner"),
)
# Of the question that users ask first: ten discs to this error.
TEN, MODERATE = "ten_disks_corner", 1e-4
# Errors up to this one are fine.
FINE = 1e-6
# Programs of others, each step of which is called from Python; their counts do not say so.
OUTSIDE = ("lsoda", "chipmunk")
# The methods on the first page.
CARD = (PBD, LINEARISED_ACTIVE, MIDPOINT_ACTIVE, EVENT_DRIVEN)
PROSE = Path(__file__).parent / "prose"


def run(context: Context) -> None:
    """Complete the references and the study; keep what they say."""
    form, again = _form(context), context.form(AGAIN)
    solved = work_references.study(form.scenes)
    known = context.rows_of(solved, solved.only(lambda key: key["scene"] in again.scenes))
    references = {name: work_references.reference(known, name) for name in form.scenes}
    study = work_precision.study(references, form)
    table = context.rows_of(study, work_precision.study(references, again), ("setting",))
    compiled = table["compiled"] & ~table["method"].isin(OUTSIDE)
    context.tables |= {"work_references": known, STUDY: context.paced(STUDY, table.assign(compiled=compiled))}
    context.keep("work_times", cheapest.times(context.tables[STUDY], form))
    # Who is cheapest does not depend on the machine that reads it; the seconds do.
    winners = cheapest.winners(table, form)
    context.keep("work_winners", winners.assign(cost=context.pace(STUDY) * winners["cost"]))
    context.keep("work_reach", reach.table())
    decisions.run(context)


def sections(context: Context) -> Sequence[Section]:
    """Write which method is the cheapest, how far the event-driven scheme pays, each scene, which method to take."""
    scenes = (_scene(context, name) for name in _form(context).scenes)
    return [_live(context), _summary(context), _reach(context), *scenes, decisions.section(context)]


def _named(table: pd.DataFrame, columns: Columns) -> pd.DataFrame:
    """Return the columns that the page shows, with words for names of methods and scenes."""
    words = {method.name: method.label for method in METHODS.values()}
    titles = {name: make().title for name, make in SCENES.items()}
    return headed(table.replace({"method": words, "scene": titles}), columns)


def _form(context: Context) -> work_precision.Form:
    return context.form(work_precision.FULL)


def _live(context: Context) -> Section:
    from verification.instruments import interactive

    table, form = context.tables[STUDY], _form(context)
    charts = {name: work_precision.chart(table, name, form) for name in form.scenes}
    certain = form.budget.certain() * context.pace(STUDY)
    short = {method.label: method.short for method in METHODS.values()}
    html = interactive.draw_chart(charts, figures_work_precision.COSTS, certain, short)
    said = fill(PROSE / "live.html")
    return Section(TITLES["live"], [Chart(html, interactive.script(), said["live"])])


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
        fine=FINE,
        finest=_most_often(winners[winners["target"] <= FINE]),
        coarsest=_most_often(winners[winners["target"] > FINE]),
    )
    wide = Grid(cheapest.wide(winners), said["wide"], "work_winners")
    texts = [Text(said[name]) for name in ("error", "time", "second_order", "baselines", "references", "limits")]
    parts: list[Part] = [Follows(said["follows"]), wide, Text(cheapest.summary(winners)), HowMeasured(texts)]
    return Section(TITLES["cheapest"], parts)


def _most_often(winners: pd.DataFrame) -> dict[str, Any]:
    """Return the method that is most often among the cheapest, where errors are reached."""
    reached = winners[winners["tied"] != ""]["tied"].str.split("; ")
    counts = reached.explode().value_counts()
    name = counts.index[0] if len(counts) else "none"
    return {"name": name, "count": int(counts.max()) if len(counts) else 0, "of": len(reached)}


def _reach(context: Context) -> Section:
    said = reach.said()
    grid = Grid(_named(context.tables["work_reach"], REACH), said["table"], "work_reach")
    return Section(TITLES["reach"], [Follows(said["follows"]), grid, Text(said["said"])])


def _scene(context: Context, name: str) -> Section:
    table, times, winners = (context.tables[one] for one in (STUDY, "work_times", "work_winners"))
    path = context.draw(f"work_precision_{name}", figures_work_precision.draw_chart, table, name, _form(context))
    mine = winners[winners["scene"] == name]
    asked = mine[(mine["target"] == MODERATE) & mine["cost"].notna()]
    said = fill(PROSE / "work_scene.html", scene=name, first=next(asked.itertuples(), None))
    return Section(
        f"{TITLES['scene']}: {SCENES[name]().title.lower()}",
        [
            Grid(_named(mine, COLUMNS["winners"]), said["winners"], "work_winners"),
            Picture(path, said["chart"]),
            Grid(_named(times[times["scene"] == name], TIMES), said["times"], "work_times"),
            Grid(_named(table[table["scene"] == name], COLUMNS["runs"]), said["runs"], STUDY, folded=True),
            Follows(said["follows"]),
        ],
    )


def findings(context: Context) -> Sequence[Finding]:
    """Say which method is the cheapest, on all scenes and on ten discs to a moderate error."""
    winners = context.tables["work_winners"]
    alone = winners[~winners["cheapest"].isin(UNDECIDED)]["cheapest"]
    ten = winners[(winners["scene"] == TEN) & (winners["target"] == MODERATE)]
    said = fill(
        PROSE / "learned_speed.html",
        pairs=len(winners),
        alone=len(alone),
        own=int((alone == EVENT_DRIVEN.label).sum()),
        pbd=int((alone == PBD.label).sum()),
        ten=list(ten.itertuples()),
        moderate=MODERATE,
        times=_times_as_long(context.tables[STUDY]),
    )
    runs = context.tables[STUDY]
    mine = runs[(runs["scene"] == TEN) & (runs["status"] == "SUCCESS")]
    shown = {one.label.removesuffix(" with ActiveSet"): mine[mine["method"] == one.name] for one in CARD}
    labels = ("CPU time [s]", "largest error, ten discs [length]")
    picture = context.draw(
        "card_speed", cards.lines, shown, "cpu_seconds", "largest", labels, [one.colour for one in CARD]
    )
    found = [Finding(said[name], TITLES["cheapest"]) for name in ("winners", "ten") if said[name]]
    return [replace(found[0], card=Card(picture, said["card"], 1)), *found[1:]]


def _times_as_long(runs: pd.DataFrame) -> tuple[float, float, float]:
    """Return how many times as long as the cheapest method PBD takes for ten discs, and the ends of its spread."""
    found = costs(runs[runs["scene"] == TEN], [MODERATE], "largest", "cpu_seconds").set_index("method")
    pbd, best = found.loc[PBD.name], found.loc[found["value"].idxmin()]
    ratio, spread = float(pbd["value"] / best["value"]), float(max(pbd["spread"], best["spread"]))
    return ratio, ratio / spread, ratio * spread


CHAPTER = Chapter(
    "speed",
    "Speed against accuracy",
    "Which method reaches an error in the least time, on which scene?",
    run,
    sections,
    findings,
    place=2,
    tables=("work_", "decisions"),
)
