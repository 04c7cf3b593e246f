"""Outcomes of EMT cells (3.3.1), shares of the cells of a run, and the columns of tables."""

from __future__ import annotations

import re
from typing import Literal, cast, get_args

import numpy as np
import pandas as pd

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.events.known import mark_of

EVENTS = ("A", "B", "S", "P")

What = Literal["basal", "apical", "below"]
# Shares of the control cells of a run, by their side.
CONTROL_SIDES = {"controls_apical": "apical", "controls_basal": "basal"}
# A share that hardly any run has: of a few EMT cells all may leave, of some fifty control cells about seven. Intervals
# of shares are widened by it (``tissue.study.estimates``).
EXTREME = dict.fromkeys(get_args(What), 1.0) | dict.fromkeys(CONTROL_SIDES, 0.15)

_TIMED = re.compile(r"t_([a-z][a-z0-9]*)_h")
_KEPT = re.compile(r"ab_(.+)h")


def time_column(event: str) -> str:
    """Return the column with the times of an event [h]: "t_a_h" for "A"."""
    return f"t_{event.lower()}_h"


def timed(cells: pd.DataFrame) -> list[str]:
    """Return the events that a table has times of: those of the thesis, then the others."""
    found = [mark_of(match[1]) for match in map(_TIMED.fullmatch, cells.columns) if match]
    return [*EVENTS, *(event for event in found if event not in EVENTS)]


def kept_times(cells: pd.DataFrame) -> list[float]:
    """List the times at which a table has the positions of the cells, ascending [h]."""
    return sorted(float(match[1]) for match in map(_KEPT.fullmatch, cells.columns) if match)


def outcome(cells: pd.DataFrame, what: What, t: float) -> pd.Series:
    """Compute delta(t) of (4.3) for each cell.

    Parameters
    ----------
    cells
        Table of the EMT cells.
    what
        "basal": extruded basally, y_AB < 0. "apical": extruded apically, y_AB > 1, in a tube beyond the apical layer.
        "below": at or below all control cells.
    t
        An output time [h].

    Returns
    -------
    pd.Series
        bool.

    Raises
    ------
    InvalidProblem
        If ``what`` or the time is not one of those.
    """
    if what not in get_args(What):
        raise InvalidProblem(f"what = {describe(what)}: must be one of {', '.join(get_args(What))}")
    times = kept_times(cells)
    if t not in times:
        raise InvalidProblem(f"t = {describe(t)}: must be an output time; these are {describe(times)} h")
    return _hits(cells, what, t)


def in_time(cells: pd.DataFrame) -> dict[What, np.ndarray]:
    """Return ``outcome`` of all cells at all output times; each of shape (times, cells)."""
    times, every = kept_times(cells), get_args(What)
    return {what: np.array([_hits(cells, what, t) for t in times]).reshape(len(times), len(cells)) for what in every}


def _hits(cells: pd.DataFrame, what: What, t: float) -> pd.Series:
    if what == "below":
        return cells[f"below_{t:g}h"].astype(bool)
    if what == "apical" and f"beyond_{t:g}h" in cells:  # of a tube
        return cells[f"beyond_{t:g}h"]
    return cells[f"ab_{t:g}h"] > 1 if what == "apical" else cells[f"ab_{t:g}h"] < 0


def run_shares(cells: pd.DataFrame, what: What, t: float) -> pd.Series:
    """Compute the share of the EMT cells of each run with an outcome at t [h]; by replicate, in rising order."""
    return outcome(cells, what, t).groupby(cells["replicate"].to_numpy()).mean().astype(float)


def run_shares_in_time(cells: pd.DataFrame) -> dict[What, np.ndarray]:
    """Compute the shares of each run with each outcome at all output times; each of shape (runs, times)."""
    runs = cells["replicate"].to_numpy()
    return {what: pd.DataFrame(hits.T).groupby(runs).mean().to_numpy(float) for what, hits in in_time(cells).items()}


def control_shares(runs: pd.DataFrame, side: str, t: float) -> pd.Series:
    """Compute the share of the control cells of each run outside on the "apical" or "basal" side; by replicate.

    Runs that failed, or have no control cells, have none.
    """
    sound = runs[(runs["status"] == "SUCCESS") & (runs[f"controls_{t:g}h"] > 0)].set_index("replicate")
    return (sound[f"controls_{side}_{t:g}h"] / sound[f"controls_{t:g}h"]).astype(float)


def run_values(cells: pd.DataFrame, runs: pd.DataFrame, outcome: str, t: float) -> pd.Series:
    """Return one number for each run that did not fail: a share of its cells, or a number in ``runs``; by replicate."""
    if outcome in CONTROL_SIDES:
        return control_shares(runs, CONTROL_SIDES[outcome], t)
    if outcome in get_args(What):
        return run_shares(cells, cast(What, outcome), t)
    return runs[runs["status"] == "SUCCESS"].set_index("replicate")[f"{outcome}_{t:g}h"].astype(float)
