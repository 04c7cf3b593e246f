"""Speed against accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from verification.instruments.budget import GRACE
from verification.instruments.cheapest import LEAST_SPREAD, RESOLVED
from verification.instruments.measure import BRIEF, REPEATS
from verification.methods.chart import events, work_precision
from verification.methods.chart.references import LONG, SCENES, SHORT, TIGHT
from verification.methods.chart.work_precision import COSTS, charts
from verification.methods.decisions import section as decisions
from verification.methods.methods import METHODS
from verification.site.context import Context
from verification.site.parts import Chart, Follows, Grid, HowMeasured, Picture, Section, Text
from verification.site.prose import fill
from verification.site.report import Chapter, Finding
from verification.site.sheet import sheet

LIVE, CHEAPEST = "Choose a scene, an error and a cost", "Chosen scenes: which method is the cheapest?"
EVENTS = "Where does midpoint catch-up lose its order?"
STUDY = "work_precision"
# Of the question that users ask first: ten discs to this error.
TEN, MODERATE = "ten_disks_corner", 1e-4
# Letters of labels that fit side by side below both panels.
LETTERS = 135
PROSE = Path(__file__).parent / "prose"


def run(context: Context) -> None:
    """Complete the references and the studies; keep what they say."""
    context.rows("work_references")
    context.keep("work_winners", work_precision.winners(context.rows(STUDY)))
    context.rows("events")
    orders = events.orders(context.rows("events_local"))
    context.keep("events_orders", orders[orders["discs"] == orders["discs"].max()])
    context.keep("events_summary", events.summary(context.tables["events_orders"]))
    decisions.run(context)


def sections(context: Context) -> Sequence[Section]:
    """Write how often each method is the cheapest, then about chosen scenes and what Auto keeps."""
    scenes = (_scene(context, name) for name in charts(context.tables[STUDY]))
    return [
        decisions.profile_section(context),
        _live(context),
        _summary(context),
        _events(context),
        decisions.section(context),
        *scenes,
    ]


def _live(context: Context) -> Section:
    from verification.instruments import interactive

    short = {method.label: method.short for method in METHODS.values()}
    # The scenes of many discs first: there calls of Python decide nothing.
    html = interactive.draw_chart(dict(reversed(charts(context.tables[STUDY]).items())), COSTS, short)
    return Section(LIVE, [Chart(html, interactive.script(), fill(PROSE / "live.html")["live"])])


def _summary(context: Context) -> Section:
    said = fill(
        PROSE / "work_precision.html",
        tol=TIGHT,
        repeats=REPEATS,
        brief=BRIEF,
        least_spread=LEAST_SPREAD,
        resolved=RESOLVED,
        budgets=(LONG, SHORT),
        grace=GRACE,
    )
    wide = Grid(work_precision.wide(context.tables["work_winners"]), said["wide"], "work_winners")
    texts = [Text(said[name]) for name in ("error", "time", "second_order", "baselines", "references", "limits")]
    return Section(CHEAPEST, [Text(said["chosen"]), wide, HowMeasured(texts)])


def _events(context: Context) -> Section:
    found, orders = context.tables["events_summary"], context.tables["events_orders"]
    by_kind = {row.coupled: row for row in found.itertuples()}
    rows, discs = context.tables["events"], orders["discs"].max()
    said = fill(PROSE / "events.html", discs=discs, steps=events.STEPS, **by_kind)
    return Section(
        EVENTS,
        [
            Picture(context.draw("events", events.draw, rows[rows["discs"] == discs], orders), said["picture"]),
            Follows(said["follows"]),
            Grid(context.headed("events_local", found), said["table"], "events_summary"),
            Text(said["why"]),
        ],
    )


def _scene(context: Context, name: str) -> Section:
    tables = context.tables[STUDY], context.tables["work_winners"]
    rows, winners = (table[table["scene"] == name] for table in tables)
    asked = winners[(winners["target"] == MODERATE) & winners["cost"].notna()]
    said = fill(PROSE / "work_scene.html", scene=name, first=next(asked.itertuples(), None))
    return Section(
        f"Speed against accuracy: {SCENES[name].make().title.lower()}",
        [
            Picture(context.draw(f"work_precision_{name}", draw_scene, rows), said["chart"]),
            Grid(context.headed(STUDY, winners), said["winners"], "work_winners"),
            Grid(context.headed(STUDY, rows), said["runs"], STUDY, folded=True),
            Follows(said["follows"]),
        ],
    )


def draw_scene(rows: pd.DataFrame, path: Path) -> Path:
    """Draw the largest error in time against CPU time and against counted work, with one legend below both."""
    (one,) = charts(rows).values()
    with sheet(path, 5.8) as figure:
        panels = figure.subplots(1, len(COSTS), sharey=True)
        for panel, cost in zip(panels, COSTS, strict=True):
            one.plot(panel, cost=cost).set_title("")
            panel.get_legend().remove()
        panels[0].set_ylim(top=10)
        panels[1].set_ylabel("")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=LETTERS // max(map(len, labels)))
    return path


def findings(context: Context) -> Sequence[Finding]:
    """Say how often each method is the cheapest on random scenes, and which one is for ten discs."""
    winners = context.tables["work_winners"]
    ten = winners[(winners["scene"] == TEN) & (winners["target"] == MODERATE)]
    said = fill(PROSE / "learned_speed.html", ten=list(ten.itertuples()))
    first = Finding(decisions.often(context), decisions.PROFILE, decisions.card(context, place=1))
    return [first, *([Finding(said["ten"], CHEAPEST)] if said["ten"] else [])]


CHAPTER = Chapter(
    "speed",
    "Speed against accuracy",
    "Which method reaches an error in the least time, on which scene?",
    run,
    sections,
    findings,
    tables=("work_", "events", "decisions"),
)
