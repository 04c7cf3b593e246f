"""Chapter 2, section 4.2: the two experiments and the order of PBD."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

import dincl
from verification.claims import Evidence, Tables, Verdict, at_least, at_most, equal
from verification.thesis.chapter1.sets import Floats
from verification.thesis.chapter2.discs import RADIUS
from verification.thesis.chapter2.methods import PBD
from verification.thesis.text.quoted import claim

# An order is one if its interval lies within this distance of 1.
ORDER_BAND = 0.1
# A disc that moved less than this in a quarter of a unit of time is at rest [length].
AT_REST = 1e-6
# The four discs: a step, a time at which they have come to rest, and the accuracy of what is read off there.
FOUR_DT, SETTLED, SETTLED_TO = 0.02, 12.0, 0.02
SEED, STARTS = 24, 12
# Scenes with known solutions, at times at which discs slide or have been pressed together; steps that are small there.
EXACT = (("two_disks", 2.0), ("two_disks", 4.0), ("sliding_disc", 3.0), ("stack", 1.5))
EXACT_STEPS = (0.0025, 0.00125)


def exact_error(name: str, t: float, dt: float) -> float:
    """Of PBD in a scene whose solution is known."""
    scene = getattr(dincl.scenes, name)()
    final = dincl.solve(scene, dincl.PBD(dt=dt), t=t).final
    return float(np.linalg.norm(final - scene.exact(t), axis=-1).max())


@claim(
    "c2.order-exact",
    "The error of PBD falls as the step.",
    "section 4",
    Verdict.NOT_REFUTED,
    chosen="scenes whose exact solutions are known",
    tried_on="four scenes and times with known solutions",
)
def _exact() -> Evidence:
    orders = {}
    for name, t in EXACT:
        coarse, fine = (exact_error(name, t, dt) for dt in EXACT_STEPS)
        orders[f"{name.replace('_', ' ')}, t = {t:g}"] = math.log2(coarse / fine)
    told = "; ".join(f"{what}: {order:.2f}" for what, order in orders.items())
    return Evidence(
        f"Order of PBD against exact solutions, from dt = {EXACT_STEPS[0]:g} and half of it: {told}.",
        tuple(equal(f"order, {what}", order, 1.0, ORDER_BAND) for what, order in orders.items()),
    )


def pull(_t: float, x: Floats) -> Floats:
    """The force of Figure 4."""
    return -x


def settled(start: Floats) -> tuple[float, float]:
    """|x|²/2 of four discs once they have come to rest, and their speed then."""
    problem = dincl.Problem(start, pull, [dincl.NonOverlap(RADIUS)])
    before, end = dincl.solve(problem, dincl.PBD(dt=FOUR_DT), t=[SETTLED - FOUR_DT, SETTLED]).x
    return float((end**2).sum()) / 2, float(np.abs(end - before).max()) / FOUR_DT


@claim(
    "c2.equilibrium",
    "The four discs come to rest in a state of least energy.",
    "section 4.2",
    chosen="the starts; the end t = 12",
)
def _equilibrium() -> Evidence:
    """Energy |x|²/2 and speed at the end, against many other starts."""
    energy, speed = settled(dincl.scenes.four_disks().x0)
    corners = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])
    starts = corners * np.random.default_rng(SEED).uniform(0.6, 4.0, (STARTS, 4, 2))
    others = [settled(start)[0] for start in starts]
    return Evidence(
        f"At t = {SETTLED:g} the four discs move with speed {speed:.0e} and have the energy |x|²/2 = {energy:.3f}; all "
        f"rhombi of touching discs have 1. From {STARTS} random starts the least is {min(others):.3f}.",
        (
            at_most("speed", speed, 1e-3),
            equal("energy", energy, 1.0, SETTLED_TO),
            at_most("energy over the least of all starts", energy / min(others), 1.0, SETTLED_TO),
        ),
        seed=SEED,
    )


def _order(scene: str, tables: Tables) -> Evidence:
    rows = tables["orders"]
    mine = rows[(rows["scene"] == scene) & (rows["method"] == PBD.name)]
    return Evidence(
        "Order of PBD, with its 95 % interval: "
        + "; ".join(f"t = {row.t:g}: {row.order}" for row in mine.itertuples()),
        tuple(
            equal(f"order at t = {row.t:g}", (row.low + row.high) / 2, 1.0, ORDER_BAND, (row.low, row.high))
            for row in mine.itertuples()
        ),
    )


@claim(
    "c2.order-four",
    "Four discs that are drawn to one point: the error of PBD falls as the step.",
    "Figure 4",
    needs=("orders",),
    chosen="the start",
)
def _four(tables: Tables) -> Evidence:
    return _order("four_disks", tables)


def _pbd_errors(tables: Tables, scene: str) -> pd.DataFrame:
    rows = tables["convergence"]
    return rows[(rows["scene"] == scene) & (rows["method"] == PBD.name)].pivot(index="dt", columns="t", values="error")


@claim(
    "c2.decreases",
    "Four discs: the error of PBD is smaller at t = 2 than at t = 1.",
    "section 4.2",
    needs=("convergence",),
    chosen="the start",
)
def _decreases(tables: Tables) -> Evidence:
    errors = _pbd_errors(tables, "four_disks")
    ratio = errors[2.0] / errors[1.0]
    return Evidence(
        f"The error of PBD at t = 2 is {ratio.min():.2f} to {ratio.max():.2f} of that at t = 1, over {len(ratio)} step "
        "sizes.",
        (at_most("largest ratio of the errors", float(ratio.max()), 1.0),),
    )


@claim(
    "c2.order-ten",
    "Ten discs that fall into a corner: the error of PBD falls as the step.",
    "Figure 5",
    needs=("orders",),
    chosen="the start and the corner",
)
def _ten(tables: Tables) -> Evidence:
    return _order("ten_disks_corner", tables)


@claim(
    "c2.at-rest",
    "Of the ten discs most move at t = 1 and most rest at t = 3.",
    "section 4.2",
    needs=("positions",),
    chosen="the start and the corner",
)
def _at_rest(tables: Tables) -> Evidence:
    rows = tables["positions"]
    rows = rows[rows["scene"] == "ten_disks_corner"].set_index(["t", "particle"])[["x", "y"]]
    moved = {t: ((rows.loc[t] - rows.loc[t - 0.25]) ** 2).sum(axis=1) ** 0.5 for t in (1.0, 2.0, 3.0)}
    resting = {t: int((values < AT_REST).sum()) for t, values in moved.items()}
    text = ", ".join(f"{count} at t = {t:g}" for t, count in resting.items())
    return Evidence(
        f"Discs at rest, of ten: {text}.",
        (at_most("at rest at t = 1", resting[1.0], 4), at_least("at rest at t = 3", resting[3.0], 6)),
    )
