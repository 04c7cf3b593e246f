"""Speed against accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from verification.beyond.chart import cheapest, reach, work_precision
from verification.beyond.chart import figures as figures_work_precision
from verification.beyond.chart import references as work_references
from verification.beyond.chart.references import SCENES
from verification.beyond.decisions import section as decisions
from verification.instruments.budget import GRACE, CpuSeconds
from verification.instruments.chart import TARGETS
from verification.instruments.cheapest import LEAST_SPREAD, RESOLVED
from verification.instruments.measure import BRIEF, REPEATS
from verification.page.columns import Columns, headed, read_columns
from verification.page.context import Context
from verification.page.parts import Chart, Follows, Grid, HowMeasured, Picture, Section, Text, number
from verification.page.prose import fill
from verification.page.report import Chapter, Finding
from verification.thesis.chapter2.methods import METHODS

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
PROSE = Path(__file__).parent / "prose"


def run(context: Context) -> None:
    """Complete the references and the study; keep what they say."""
    form, again = _form(context), context.form(AGAIN)
    solved = work_references.study(form.scenes)
    known = context.rows_of(solved, solved.only(lambda key: key["scene"] in again.scenes))
    references = {name: work_references.reference(known, name) for name in form.scenes}
    study = work_precision.study(references, form)
    table = context.rows_of(study, work_precision.study(references, again), ("setting",))
    context.tables |= {"work_references": known, STUDY: context.paced(STUDY, table)}
    context.keep("work_times", cheapest.times(context.tables[STUDY], form))
    # Who is the cheapest is decided by the times of the complete study; the seconds shown are those of this machine.
    winners = cheapest.winners(table, form)
    context.keep("work_winners", winners.assign(cost=context.pace(STUDY) * winners["cost"]))
    context.keep("work_reach", reach.ratios())
    decisions.run(context)


def sections(context: Context) -> Sequence[Section]:
    """Write how often each method is the cheapest, the chosen scenes and piles, and what Auto keeps."""
    scenes = (_scene(context, name) for name in _form(context).scenes)
    six = [_live(context), _summary(context), _reach(context), *scenes]
    return [decisions.profile_section(context), *six, decisions.section(context)]


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
    )
    wide = Grid(cheapest.wide(winners), said["wide"], "work_winners")
    texts = [Text(said[name]) for name in ("error", "time", "second_order", "baselines", "references", "limits")]
    return Section(TITLES["cheapest"], [Text(said["chosen"]), wide, HowMeasured(texts)])


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
    """Say how often each method is the cheapest on random scenes, and which one is for ten discs."""
    winners = context.tables["work_winners"]
    ten = winners[(winners["scene"] == TEN) & (winners["target"] == MODERATE)]
    said = fill(PROSE / "learned_speed.html", ten=list(ten.itertuples()))
    first = Finding(decisions.often(context), decisions.PROFILE, decisions.card(context, place=1))
    return [first, *([Finding(said["ten"], TITLES["cheapest"])] if said["ten"] else [])]


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
