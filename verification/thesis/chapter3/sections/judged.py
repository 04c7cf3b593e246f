"""Single steps of DAHA and PBD, judged by the local minimum."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import pandas as pd

from verification.page.report import Context, Grid, Section, Text, number
from verification.thesis.chapter3 import judged
from verification.thesis.chapter3.sections.part import Part, named

STEPS = {
    "where": "State",
    "energy": "W, mean",
    "part": "Part of the way down",
    "low": "from",
    "high": "to",
    "distance": "Nuclei to the minimum [R_soft]",
    "relative": "Relative",
    "gradient": "‖∇W − Jᵀλ‖/‖z‖, median",
    "steepest": "Largest",
    "violation": "Largest violation [R_soft]",
    "made": "Iterations, mean",
    "seconds": "Seconds, median",
    "solved": "Solved",
    "steps": "Steps",
}
RUNS = {"seed": "Seed", "start": "Height at the start", "judge": "Through minima", "DAHA": "DAHA", "PBD": "PBD"}


def _run(context: Context) -> None:
    where = context.folder, context.executor
    form = context.form(judged.SHORT, judged.FULL)
    context.keep("tissue_judged_steps", judged.summary(judged.study(form).complete(*where)))
    context.tables["tissue_judged_runs"] = judged.whole(form).complete(*where)


def _judged(context: Context) -> Section:
    steps, runs = context.tables["tissue_judged_steps"], context.tables["tissue_judged_runs"]
    parts: list[Text | Grid] = [
        Text(_verdict(steps)),
        Grid(named(steps, STEPS), "One step from the same states, means over steps.", "tissue_judged_steps"),
    ]
    if len(runs):
        parts += [
            Text(_whole(runs)),
            Grid(named(runs, RUNS), f"Heights at {judged.END:g} h [R_soft].", "tissue_judged_runs"),
        ]
    return Section("How far from a minimum a step ends", parts)


def _verdict(steps: pd.DataFrame) -> str:
    row = steps.set_index("where")
    daha, pbd, least = row.loc["DAHA"], row.loc["PBD"], row.loc["minimum from DAHA"]
    numbers = judged.floored().daha_numbers()
    bound = numbers.eps / (numbers.alpha * numbers.dtau)
    apart = row.loc["minimum", "distance"]
    return (
        "The quasi-steady model asks for a minimum in each step. From the states in which "
        f"{least['steps']:.0f} steps begin, DAHA with Table 4 goes {_part(daha)} of the way down from the start of the "
        f"step to the minimum that Ipopt finds from where DAHA stopped, PBD over Δt {_part(pbd)}. Their nuclei are "
        f"{number(daha['distance'])} and {number(pbd['distance'])} R_soft from that minimum; Ipopt from the start of "
        f"the step ends {number(apart)} R_soft from it, on average"
        + (": there are several minima. " if apart > judged.TOL else ": there is one minimum. ")
        + "Remark 3.6 bounds what is "
        f"left of the gradient by ‖∇W‖/‖z‖ ≤ ε/α = {number(bound)}. With the multipliers that fit best it is "
        f"{number(daha['gradient'])} (median), {number(daha['steepest'])} at most: {daha['steepest'] / bound:.2f} "
        f"times the bound, and {daha['steepest'] / (2 * bound):.2f} times 2ε/α, which (3.25) has for the gradient of "
        "one iteration before. So the “minimum” is a state on the way, and the rule (3.24) decides how far along. The "
        f"minimum takes Ipopt {least['made']:.0f} iterations and "
        f"{number(least['seconds'])} s from there, DAHA {daha['made']:.0f} and {number(daha['seconds'])} s."
    )


def _part(row: pd.Series) -> str:
    return f"{100 * row['part']:.0f} % [{100 * row['low']:.0f}, {100 * row['high']:.0f}]"


def _whole(runs: pd.DataFrame) -> str:
    ratio = (runs["judge"] / runs["DAHA"] - 1).dropna()
    return (
        f"Grown through minima, {len(ratio)} of {len(runs)} tissues reach {judged.END:g} h; they are then "
        f"{100 * ratio.mean():+.0f} % in height off those of DAHA ({100 * ratio.min():+.0f} to "
        f"{100 * ratio.max():+.0f} %)."
    )


PART = Part(_run, _judged)
