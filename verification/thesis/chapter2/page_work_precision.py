"""Speed against accuracy."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from verification.page.report import Chapter, Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter2 import cheapest, figures_work_precision, work_precision, work_references
from verification.thesis.chapter2.methods import METHODS
from verification.thesis.chapter2.work_references import SCENES

WINNERS = {
    "scene": "Scene",
    "target": "Error",
    "method": "Cheapest",
    "seconds": "Seconds",
    "runner_up": "Next",
    "runner_up_ratio": "takes times as long",
    "pbd_ratio": "PBD takes times as long",
}
TIMES = {"method": "Method", "order": "Order in dt [95 %]"} | {
    f"{target:g}": f"s to {number(target)}" for target in cheapest.TARGETS
}
TIMES |= {"best": "Best error", "at_end": "at the end, of it", "failed": "Failed"}
RUNS = {
    "method": "Method",
    "setting": "dt or tol",
    "status": "Status",
    "seconds": "Seconds",
    "repeats": "Repeats",
    "drift_evaluations": "Drift evaluations",
    "candidate_pairs": "Pairs in sweeps",
    "solver_iterations": "Solver iterations",
    "sup": "Largest error",
    "final": "Error at the end",
    "infeasibility": "Infeasibility",
    "detail": "Detail",
}
ERROR = (
    "The error is the largest distance of a particle from where it should be, at any time looked at, every "
    f"{number(work_references.EVERY)} or where the reference has its times. It is the largest in time that counts "
    "here: where everything comes to rest in the end (the stack, the corner), a method may lose its way and still end "
    "exactly right."
)
TIME = (
    "Time is that of the solution only, without the construction of scene and scheme, after a whole run for warming "
    f"up; the best of {work_precision.REPEATS} where a run takes less than {number(work_precision.BRIEF)} s. Two "
    "methods run at once, on a core each. The counted work is the number of evaluations of the drift: every method "
    "here counts it alike, a step of any kind being one or a few of them. What a method does between two of them "
    "differs, and is in the table of the runs: pairs looked at by sweeps, iterations of solvers."
)
YARDSTICKS = (
    "Two programs of others stand beside the methods. LSODA (scipy) solves the penalty form with springs as a stiff "
    "ordinary differential equation; the strength is tied to its tolerance, so that a loaded contact overlaps by about "
    "the tolerance; it is given the stiff part of the Jacobian, and a longest step, as it would step over whole discs "
    "otherwise. Chipmunk (pymunk) is an engine for rigid bodies: made to forget its velocities in every step, without "
    "friction, elasticity and slop, and with a bias that takes back a whole overlap, it is a first-order method for "
    "discs in the plane. It refuses three dimensions."
)
SECOND_ORDER = (
    "Two forms of catch-up use the middle of a step. Midpoint catch-up takes normals and drift there and meets the set "
    "at the end: order 2 also where contacts are made and lost, as long as contacts do not decide over contacts within "
    "a step. The θ = 1/2 form meets the set in the middle, so a disc overshoots at an impact and swings about contact: "
    "it is of order 2 only while no contact changes, far ahead of θ = 1 where a slide has ended, and of order 1 in the "
    "largest error."
)
REFERENCES = (
    "References: exact solutions of the sliding disc and the stack; the event-driven scheme with tol = "
    f"{number(work_references.TOL)} for the four and ten discs and the balls (its own line is therefore measured "
    "against itself, with a tighter tolerance); a fine solution, kept as a table, for the pile. An error below "
    f"{cheapest.RESOLVED:g} times the stated error of the reference counts as that."
)


def run(context: Context) -> None:
    """Complete the references and the study; keep what they say."""
    where = context.folder, context.executor
    known = work_references.study().complete(*where)
    context.tables["work_references"] = known
    references = {name: work_references.reference(known, name) for name in SCENES}
    table = work_precision.study(references, context.full).complete(*where)
    context.tables["work_precision"] = table
    context.keep("work_times", cheapest.times(table))
    context.keep("work_winners", cheapest.winners(table))


def sections(context: Context) -> Sequence[Section]:
    """What is measured and who wins, then one section for each scene."""
    return [_summary(context), *(_scene(context, name) for name in SCENES)]


def _named(table: pd.DataFrame, headings: dict[str, str]) -> pd.DataFrame:
    """The columns of a table that a reader wants, with words for names."""
    words = {method.name: method.label for method in METHODS.values()}
    titles = {name: make().title for name, make in SCENES.items()}
    return (
        table[list(headings)].replace({"method": words, "runner_up": words, "scene": titles}).rename(columns=headings)
    )


def _summary(context: Context) -> Section:
    form = work_precision.FULL if context.full else work_precision.SHORT
    winners = context.tables["work_winners"]
    costly = f", and {number(form.costly)} of that for costly methods" if form.costly < 1 else ""
    limits = Text(
        "From the coarsest setting on, finer ones are run until one takes more than "
        f"{number(form.enough)} s ({number(form.enough_of_many)} s for the pile of discs{costly}; for tolerances, as "
        "much more as steps are refined from one to the next). A run that takes "
        f"{number(form.patience)} s is stopped and is a row of its own. Not reached means: not within these times. "
        "Between two runs the time to an error is interpolated in logarithms; nothing is extrapolated."
    )
    grid = Grid(_named(winners, WINNERS), "The cheapest method for each scene and error.", "work_winners")
    texts = [Text(text) for text in (ERROR, TIME, SECOND_ORDER, YARDSTICKS, REFERENCES)]
    return Section("Who is cheapest", [Text(cheapest.summary(winners)), grid, *texts, limits])


def _scene(context: Context, name: str) -> Section:
    table, times, winners = (context.tables[one] for one in ("work_precision", "work_times", "work_winners"))
    path = context.draw(f"work_precision_{name}", figures_work_precision.chart, table, name)
    return Section(
        f"Speed against accuracy: {SCENES[name]().title.lower()}",
        [
            Text(cheapest.sentence(winners[winners["scene"] == name])),
            Picture(
                path,
                "Largest error in time against time, and against counted work; coarse settings left. Crosses on the "
                "upper edge: runs that failed or were stopped. The grey edge is below what the reference resolves.",
            ),
            Grid(
                _named(times[times["scene"] == name], TIMES),
                "Seconds to reach an error (—: not reached), and the order of the largest error in time.",
                "work_times",
            ),
            Grid(_named(table[table["scene"] == name], RUNS), "All runs.", _file(context), folded=True),
        ],
    )


def _file(context: Context) -> str:
    return f"work_precision{'_full' if context.full else ''}"


CHAPTER = Chapter("Speed against accuracy", run, sections, place=2, tables=("work_",))
