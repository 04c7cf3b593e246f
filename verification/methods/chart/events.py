"""Midpoint catch-up and coupled events: its error against their number, and its order across each event alone.

Between events the motion is smooth. Where a contact alone begins or ends, the step around it has an error of order 2.
An event is coupled where a contact begins that ends another one at the same time: the error of the step around it is
of order 1.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.study import Key, Row, Study
from verification.instruments.error_norms import distance
from verification.instruments.order import estimate
from verification.methods.methods import ADAPTIVE, METHODS, MIDPOINT_ACTIVE
from verification.site.sheet import GREY, NOTE, sheet

TOL = 1e-12  # of the reference [length]
# Two events are one if they are less apart [time].
SAME = 1e-9
# Discs of the pile of the page, and of that of the smallest form; the end of the run [time].
MANY, FEW, END = 100, 10, 2.0
SETTINGS = {MIDPOINT_ACTIVE.name: [0.04 / 4**k for k in range(4)], ADAPTIVE.name: [1e-2, 1e-3, 1e-4, 1e-5]}
# Numbers of steps of a run across one event, which lies at a third of the run: these leave 1 if divided by three, so
# that the event lies at a third of a step, too, and the errors of one event fall without scatter.
STEPS = (4, 7, 13, 25, 49, 97)
COLUMNS = {"coupled": "Event", "events": "Number", "low": "Least order", "median": "Median order", "high": "Greatest"}


class Solved(NamedTuple):
    """A pile with its events at times t (K,), whether each is coupled, and states shortly before and behind, (K, N, 2).

    An event at t has its states at t - room and t + 2 room, and no other event is between these; room (K,) [time].
    """

    scene: dincl.Problem
    t: NDArray[np.float64]
    coupled: NDArray[np.bool_]
    room: NDArray[np.float64]
    before: NDArray[np.float64]
    behind: NDArray[np.float64]


@cache
def solved(discs: int) -> Solved:
    """Solve a pile of so many discs by events; a first run finds them, a second one has the states around them."""
    scene = dincl.scenes.pile(discs)
    events = [event for event in dincl.solve(scene, dincl.EventDriven(TOL), [END]).events if event.t < END]
    times = np.array([event.t for event in events])
    first = np.flatnonzero(np.diff(times, prepend=-1.0) > SAME)
    kinds = [{event.kind for event in events[a:b]} for a, b in zip(first, [*first[1:], len(events)], strict=True)]
    t = times[first]
    gaps = np.diff(t, prepend=0.0, append=END)
    room = np.minimum(gaps[:-1] / 3, gaps[1:] / 5)
    x = dincl.solve(scene, dincl.EventDriven(TOL), np.column_stack((t - room, t + 2 * room)).ravel()).x
    return Solved(scene, t, np.array([len(kind) == 2 for kind in kinds]), room, x[::2], x[1::2])


def study(smallest: bool = False) -> Study:
    """Return whole runs of a pile: one row for each event, with the error behind it."""
    piles = (FEW,) if smallest else (MANY, FEW)
    pairs = [(name, setting) for name, ladder in SETTINGS.items() for setting in ladder]
    runs = tuple({"discs": discs, "method": name, "setting": setting} for discs in piles for name, setting in pairs)
    return Study("events", "Errors behind events", ("discs", "method", "setting"), runs, run, by=("event",))


def run(key: Key) -> list[Row]:
    """Return the error behind each event of a pile, and how many of the events so far were coupled."""
    pile = solved(key["discs"])
    path = dincl.solve(pile.scene, METHODS[key["method"]].make(key["setting"]), pile.t + 2 * pile.room)
    columns = zip(pile.t, np.cumsum(pile.coupled), distance(path.x, pile.behind), strict=True)
    return [{**key, "event": k, "t": t, "coupled": many, "error": error} for k, (t, many, error) in enumerate(columns)]


def local_study(smallest: bool = False) -> Study:
    """Return runs across one event each, which start from the exact state: one row for each event."""
    piles, key = (FEW,) if smallest else (MANY, FEW), ("discs", "steps")
    runs = tuple({"discs": discs, "steps": steps} for discs in piles for steps in STEPS)
    return Study("events_local", "Errors of one event", key, runs, run_local, columns=COLUMNS, by=("event",))


def run_local(key: Key) -> list[Row]:
    """Return the error of midpoint catch-up behind each event, from the exact state before it, in so many steps."""
    pile = solved(key["discs"])
    rows: list[Row] = []
    for k, (x0, exact, span) in enumerate(zip(pile.before, pile.behind, 3 * pile.room, strict=True)):
        problem, dt = dincl.Problem(x0, pile.scene.drift, pile.scene.constraints), span / key["steps"]
        path = dincl.solve(problem, dincl.MidpointCatchUp(dt, dincl.ActiveSet(1e-13)), [span])
        row = {**key, "event": k, "t": pile.t[k], "coupled": bool(pile.coupled[k]), "dt": dt}
        rows.append(row | {"error": float(distance(path.x, exact[None])[0])})
    return rows


def orders(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the order of the error in dt across each event, from the rows of ``local_study``; NaN for rounding."""
    found = []
    for (discs, event, coupled), mine in rows.groupby(["discs", "event", "coupled"]):
        slope = estimate(mine["dt"], mine["error"], TOL).slope
        row = {"discs": discs, "event": event, "coupled": coupled}
        found.append(row | {"order": np.nan if slope is None else slope})
    return pd.DataFrame(found)


def summary(found: pd.DataFrame) -> pd.DataFrame:
    """Return a row for the coupled events and one for the others: their number, least, median and greatest order."""
    return pd.DataFrame(
        {"coupled": "coupled" if coupled else "alone", "events": len(mine)}
        | {"low": mine["order"].min(), "median": mine["order"].median(), "high": mine["order"].max()}
        for coupled, mine in found.dropna().groupby("coupled")
    )


def draw(rows: pd.DataFrame, found: pd.DataFrame, path: Path) -> Path:
    """Draw the largest error against the number of coupled events so far, and the order across each event alone."""
    with sheet(path, 3.8) as figure:
        panel, right = figure.subplots(1, 2)
        for name, line in ((MIDPOINT_ACTIVE.name, "-"), (ADAPTIVE.name, "--")):
            one = METHODS[name]
            for k, setting in enumerate(SETTINGS[name]):
                mine = rows[(rows["method"] == name) & np.isclose(rows["setting"], setting)]
                worst = mine.groupby("coupled")["error"].max()
                look = {"color": one.colour, "linewidth": 0.9 + 0.35 * k, "label": f"{one.setting} = {setting:g}"}
                panel.semilogy(worst.index, worst, line, **look)
        panel.set(xlabel="coupled events so far", ylabel="largest error behind an event [length]")
        for coupled, colour, marker in ((False, MIDPOINT_ACTIVE.colour, "o"), (True, "#000000", "X")):
            mine = found[found["coupled"] == coupled]
            label = "coupled event" if coupled else "event alone"
            right.plot(mine["event"], mine["order"], marker, color=colour, linestyle="none", label=label)
        for order in (1, 2):
            right.axhline(order, color=GREY, linewidth=0.8, zorder=0)
        right.set(xlabel="event", ylabel="order of the error in dt", ylim=(0.0, 2.5))
        right.legend(loc="lower left")
        panel.legend(title="midpoint catch-up, solid; adaptive, dashed", ncols=2, fontsize=NOTE, title_fontsize=NOTE)
        panel.set_ylim(top=30.0)
    return path
