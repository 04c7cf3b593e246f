"""Substeps of PBD against catch-up on a frozen tissue."""

from __future__ import annotations

import numpy as np
import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3 import catch_up, figures_daha
from verification.thesis.chapter3.judged import floored
from verification.thesis.chapter3.sections.part import Part, named

ERRORS = {
    "method": "Method",
    "steps": "Steps in dt",
    "rms": "Error of nuclei [R_soft]",
    "own": "Error of the reference",
    "seconds": "Seconds",
    "lost": "Lost",
}
ORDERS = {"method": "Method", "order": "Order in h [95 %]", "verdict": "In words"}


def _run(context: Context) -> None:
    table = catch_up.study(context.form(catch_up.SHORT, catch_up.FULL)).complete(context.folder, context.executor)
    errors = catch_up.errors(table)
    context.keep("tissue_catch_up_errors", errors)
    context.keep("tissue_catch_up_orders", catch_up.orders(errors, floored().numbers().dt))


def _catch_up(context: Context) -> Section:
    errors, orders = (context.tables[f"tissue_catch_up_{name}"] for name in ("errors", "orders"))
    picture = context.draw("tissue_catch_up", figures_daha.catch_up, errors)
    return Section(
        "PBD against catch-up on a frozen tissue",
        [
            Text(_verdict(errors)),
            Picture(picture, "Error of the nuclei after dt = 0.1 h, median over the tissues."),
            Grid(named(orders, ORDERS), "Orders", "tissue_catch_up_orders", folded=True),
            Grid(named(errors, ERRORS), "All errors", "tissue_catch_up_errors", folded=True),
        ],
    )


def _verdict(errors: pd.DataFrame) -> str:
    own = floored().numbers().substeps
    pbd = errors[errors["method"] == "PBD"].set_index("steps")
    parts = []
    for method, mine in errors[errors["steps"] > errors["least"]].groupby("method", sort=False):
        rows = mine.sort_values("steps")
        first, last = rows.iloc[0], rows.iloc[-1]
        order = np.log(first["rms"] / last["rms"]) / np.log(last["steps"] / first["steps"])
        parts.append(f"{method} {order:.2f} (from {first['steps']} to {last['steps']} steps)")
    fine = pbd.iloc[-1]
    rivals = errors[(errors["method"] != "PBD") & (errors["rms"] <= fine["rms"])].sort_values("seconds")
    told = (
        f"The cheapest of the others that is as exact is {rivals.iloc[0]['method']} with "
        f"{rivals.iloc[0]['steps']} steps in {number(1e3 * rivals.iloc[0]['seconds'])} ms."
        if len(rivals)
        else "None of the others is as exact."
    )
    return (
        "Rules stand still, there is no noise, the start is in S: then the motion has one solution. The reference is "
        "MidpointCatchUp with projections on all constraints at once, its error of second order taken out; what was "
        f"taken out bounds its own error, {number(fine['own'])} R_soft. Mean orders beyond the linear limit of "
        f"explicit Euler, {fine['least']:.0f} steps in dt: {', '.join(parts)}. PBD with {own} "
        f"substeps, in one sweep each, is off by {number(pbd.loc[own, 'rms'])} R_soft after one dt, with "
        f"{fine.name} by {number(fine['rms'])} in {number(1e3 * fine['seconds'])} ms, the setting up included. {told}"
    )


PART = Part(_run, _catch_up)
