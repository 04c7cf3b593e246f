"""Lemma 2.8 as measured limits: the velocity of one step of PBD as dt -> 0, and after many steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from dincl.geometry import normal_cone, support, tangent_velocity
from verification.instruments.order import estimate, order_text
from verification.site.context import Context
from verification.site.sheet import legend_below, sheet
from verification.thesis.chapter1.prox_regularity import honeycomb

Floats = NDArray[np.float64]
NAME, SHOWN = "consistency", "two contacts, oblique"
STEPS = tuple(10.0**-k for k in (1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5))
# Of the runs that settle: their step, and how many.
SETTLING_DT, SETTLING = 1e-7, 100
SWEEPS = 200
CONTACT = 1e-9
DIRECTIONS = 50
SEED = 32
HEADINGS = {
    "configuration": "Configuration",
    "contacts": "Contacts",
    "inclusion_order": "Order, to F - N",
    "sweep_order": "Order, to one sweep",
    "tangent": "To P_T F, one sweep",
    "many": "To P_T F, many sweeps",
    "outside": "Outside T",
    "settled": "To P_T F, last step",
    "reaction": "|V - F| / |F|",
}
# Column, label, marker of the distances that are drawn.
DISTANCES = (
    ("inclusion", "to F - N", "o"),
    ("sweep", "to one sweep of half-spaces", "s"),
    ("tangent", "to the projection on T", "^"),
)


def configurations() -> Mapping[str, dincl.Problem]:
    """Return points with active contacts, and a constant drift that presses them."""
    rng = np.random.default_rng(SEED)
    discs = [dincl.NonOverlap(0.5)]
    pair = np.array([[0.0, 0.0], [0.6, 0.8]])
    bent = np.array([[-0.8, 0.6], [0.0, 0.0], [0.8, 0.6]])
    cluster = honeycomb(7)
    walls = [dincl.HalfSpace(normal=(0, 1)), dincl.HalfSpace(normal=(np.sin(1.0), -np.cos(1.0)))]
    return {
        "one contact": _pressed(pair, 2 * rng.normal(size=(2, 2)) - 2 * (pair - pair.mean(axis=0)), discs),
        "two contacts, orthogonal": _pressed(
            np.vstack((pair, pair + 5)), _towards(np.vstack((pair, pair)), rng, pair.mean(axis=0)), discs
        ),
        "two contacts, oblique": _pressed(bent, _towards(bent, rng, np.array([0.0, 0.4])), discs),
        "wedge of two walls": _pressed(np.zeros((1, 2)), np.array([[-1.0, -0.2]]), walls),
        "twelve contacts, redundant": _pressed(cluster, _towards(cluster, rng, np.zeros(2)), discs),
    }


def _towards(x: Floats, rng: np.random.Generator, centre: Floats) -> Floats:
    return 2 * (centre - x) + 0.5 * rng.normal(size=x.shape)


def _pressed(x: Floats, drift: Floats, constraints: Sequence[dincl.Constraint]) -> dincl.Problem:
    return dincl.Problem(x, constant(drift), constraints)


def single_steps() -> pd.DataFrame:
    """Return one row for each configuration and dt: how far the velocity of one step is from four candidates.

    Columns: ``inclusion`` dist(V, F - N); ``sweep`` |V - P_T1 ... F|, the row of half-spaces in the order of PBD;
    ``tangent`` |V - P_T F|; ``many`` the same with many sweeps; ``outside`` dist(V, T); ``reaction`` |V - F| / |F|;
    ``excess`` the largest sigma(V - F, w) - sigma(-N in the ball, w) over random unit w.
    """
    rows = []
    for name, problem in configurations().items():
        drift = problem.velocity(0.0, problem.x0)
        cone = normal_cone(problem, 0.0, problem.x0, CONTACT)
        slow = tangent_velocity(problem, 0.0, problem.x0, tol=CONTACT).velocity
        limit = tangent_sweep(cone.generators, drift)
        for dt in STEPS:
            velocity = _velocities(problem, dt, 1)[-1]
            rows.append(
                {
                    "configuration": name,
                    "contacts": len(cone.names),
                    "dt": dt,
                    "inclusion": cone.distance(drift - velocity),
                    "sweep": _length(velocity - limit),
                    "tangent": _length(velocity - slow),
                    "many": _length(_velocities(problem, dt, 1, SWEEPS)[-1] - slow),
                    "outside": _length(cone.normal_part(velocity)),
                    "reaction": _length(velocity - drift) / _length(drift),
                    "excess": _excess(problem, velocity - drift, 2 * _length(drift)),
                }
            )
    return pd.DataFrame(rows)


def settling() -> pd.DataFrame:
    """Return |V_k - P_T F| for each configuration and step k, at a small dt; V_k is the velocity of the k-th step."""
    rows = []
    for name, problem in configurations().items():
        slow = tangent_velocity(problem, 0.0, problem.x0, tol=CONTACT).velocity
        for k, velocity in enumerate(_velocities(problem, SETTLING_DT, SETTLING), start=1):
            rows.append({"configuration": name, "step": k, "tangent": _length(velocity - slow)})
    return pd.DataFrame(rows)


def summary(steps: pd.DataFrame, settled: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each configuration: orders in dt, the values at the smallest dt, and after the last step."""
    rows = []
    for name, mine in steps.groupby("configuration", sort=False):
        finest = mine[mine["dt"] == mine["dt"].min()].iloc[0]
        scale = 1 / float(finest["dt"])  # a velocity is a difference of coordinates of size 1 over dt
        rows.append(
            {
                "configuration": name,
                "contacts": int(finest["contacts"]),
                "inclusion_order": order_text(estimate(mine["dt"], mine["inclusion"], scale=scale)),
                "sweep_order": order_text(estimate(mine["dt"], mine["sweep"], scale=scale)),
                "tangent": float(finest["tangent"]),
                "many": float(finest["many"]),
                "outside": float(finest["outside"]),
                "settled": float(settled[settled["configuration"] == name]["tangent"].iloc[-1]),
                "reaction": float(finest["reaction"]),
            }
        )
    return pd.DataFrame(rows)


def tangent_sweep(gradients: Floats, drift: Floats) -> Floats:
    """Return P_T_m ... P_T_1 F with T_k = {v : grad g_k . v >= 0}, one sweep on velocities; gradients (m, N, d)."""
    velocity = drift
    for gradient in gradients:
        closing = min(0.0, float((gradient * velocity).sum()))
        velocity = velocity - closing / float((gradient**2).sum()) * gradient
    return velocity


def _velocities(problem: dincl.Problem, dt: float, steps: int, sweeps: int = 1) -> Floats:
    """Return (x_k - x_{k-1}) / dt for k = 1 ... steps, shape (steps, N, d)."""
    path = dincl.solve(problem, dincl.PBD(dt=dt, sweeps=sweeps), t=dt * np.arange(steps + 1))
    moved: Floats = np.diff(path.x, axis=0) / dt
    return moved


def _excess(problem: dincl.Problem, reaction: Floats, radius: float) -> float:
    rng = np.random.default_rng(SEED)
    worst = -np.inf
    for w in rng.normal(size=(DIRECTIONS, *reaction.shape)):
        unit = w / _length(w)
        bound = support(problem, 0.0, problem.x0, unit, CONTACT, radius=radius)
        worst = max(worst, float((reaction * unit).sum()) - bound)
    return worst


def _length(vector: Floats) -> float:
    return float(np.sqrt((vector**2).sum()))


def figure(steps: pd.DataFrame, settled: pd.DataFrame, path: Path) -> Path:
    """Draw the velocity of one step of ``SHOWN`` against dt, and of the k-th step of all against k."""
    with sheet(path, 3.8) as drawn:
        left, right = drawn.subplots(1, 2)
        mine = steps[steps["configuration"] == SHOWN]
        for column, label, marker in DISTANCES:
            left.loglog(mine["dt"], mine[column], marker=marker, label=label)
        left.set(title=f"One step, {SHOWN}", xlabel="step dt [time]", ylabel="distance of the velocity [length/time]")
        for name, rows in settled.groupby("configuration", sort=False):
            positive = rows[rows["tangent"] > 0]
            right.semilogy(positive["step"], positive["tangent"], label=name)
        right.set(title="The k-th step", xlabel="k", ylabel="distance to the projection [length/time]")
        legend_below(drawn, (left, right), 3)
    return path


def run(context: Context) -> None:
    """Measure the limits, which takes a second."""
    context.keep(f"{NAME}_steps", single_steps())
    context.keep(f"{NAME}_settling", settling())


def show(context: Context) -> None:
    """Give the limits of one step and of many."""
    steps, settled = context.tables[f"{NAME}_steps"], context.tables[f"{NAME}_settling"]
    context.draw(NAME, figure, steps, settled)
    context.show(NAME, summary(steps, settled).rename(columns=HEADINGS), f"{NAME}_steps")
