"""The constant of the stability estimate (5.60), measured over many pairs of starts.

D(t) = |y1 - y2| + |v1 - v2| + W1(mu1, mu2).
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from meanfield import State, solve_ode, w1
from verification.instruments.rates import slope
from verification.site.context import Context
from verification.site.sheet import legend_below, sheet
from verification.thesis.chapter5 import cases

Floats = NDArray[np.float64]
NAME, T, TOL = "meanfield_stability", np.linspace(0.0, 8.0, 17), 1e-8
MODELS = ("straight", "linear", "wavy")
# What differs between the two starts of a pair.
KINDS = {"sample": "samples of one law", "law": "laws, shifted", "y0": "y(0)", "v0": "y'(0)", "all": "all of these"}
PAIRS, PARTICLES = 100, 20
# Largest size of a difference.
SHIFT = 0.1
HEADINGS = {
    "model": "Model",
    "pairs": "Pairs",
    "largest": "Largest D(t)/D(0)",
    "at": "at t",
    "kind": "of pairs that differ in",
    "rate": "Growth rate of D",
    "low": "Lower end, 95 %",
    "high": "Upper end, 95 %",
}


def study(smallest: bool = False) -> Study:
    """Return the study: a run has all pairs of one kind, a row for each pair and time; the smallest has two pairs."""
    runs = tuple({"model": name, "kind": kind} for name in MODELS for kind in KINDS)
    run = partial(_rows, pairs=2 if smallest else PAIRS)
    return Study(
        NAME, "Mean field: constant of stability", ("model", "kind"), runs, run, columns=HEADINGS, by=("pair", "t")
    )


def _rows(key: Key, pairs: int) -> list[Row]:
    name, kind = key["model"], key["kind"]
    rows: list[Row] = []
    for pair in range(pairs):
        rng = cases.stream("pairs", MODELS.index(name), list(KINDS).index(kind), pair)
        one, two = (solve_ode(cases.model(name), start, T, TOL) for start in _pair(name, kind, rng))
        gaps = np.array([w1(a, b) for a, b in zip(one.X, two.X, strict=True)])
        apart = np.abs(one.y - two.y)[:, 0] + np.abs(one.v - two.v)[:, 0] + gaps
        rows += [dict(key) | {"pair": pair, "t": t, "ratio": d / apart[0]} for t, d in zip(T, apart, strict=True)]
    return rows


def _pair(name: str, kind: str, rng: np.random.Generator) -> tuple[State, State]:
    case, law = cases.CASES[name], cases.law(name)
    X, y, v = law.sample(rng, PARTICLES), np.array(case.y0), np.array(case.v0)
    shift = rng.uniform(-SHIFT, SHIFT, 3)
    other = law.sample(rng, PARTICLES) if kind in ("sample", "all") else X
    by_law, by_y, by_v = (shift[k] * (kind in (what, "all")) for k, what in enumerate(("law", "y0", "v0")))
    return State(X=X, y=y, v=v), State(X=other + by_law, y=y + by_y, v=v + by_v)


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Summarise each model: the largest D(t)/D(0) of all pairs, its time, and its growth.

    ``rate`` is the slope of the logarithm of the largest ratio against t over the whole time, with 95 % interval.
    """
    rows = []
    for name, mine in table.groupby("model", sort=False):
        envelope = mine.groupby("t")["ratio"].max().iloc[1:]
        where = mine.loc[mine["ratio"].idxmax()]
        rate, low, high = slope(envelope.index.to_numpy(), np.log(envelope.to_numpy()))
        row = {"model": name, "pairs": len(mine) // mine["t"].nunique(), "largest": float(where["ratio"])}
        row |= {"at": float(where["t"]), "kind": where["kind"], "rate": rate, "low": low, "high": high}
        rows.append(row)
    return pd.DataFrame(rows)


def figure(table: pd.DataFrame, path: Path) -> Path:
    """Draw the largest D(t)/D(0) of all pairs of a kind."""
    with sheet(path, 3.3) as drawn:
        panels = drawn.subplots(1, len(MODELS), sharey=True)
        for panel, name in zip(panels, MODELS, strict=True):
            mine = table[table["model"] == name]
            for kind, label in KINDS.items():
                one = mine[mine["kind"] == kind].groupby("t")["ratio"].max()
                panel.semilogy(one.index, one.to_numpy(), label=label)
            panel.set(title=cases.TITLES[name], xlabel="time t", ylim=(0.1, 30))
        panels[0].set_ylabel("largest D(t)/D(0)")
        legend_below(drawn, panels, 5)
    return path


def show(context: Context) -> None:
    """Give the constant of the stability estimate."""
    table = context.tables[NAME]
    context.draw(NAME, figure, table)
    context.show(NAME, context.headed(NAME, summary(table).replace({"model": cases.TITLES, "kind": KINDS})))
