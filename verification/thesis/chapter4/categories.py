"""EMT categories (3.3.3, 3.3.4): which events a cell had in which order, and ratios given a time or a position.

And basal extrusion by the rule of the published code.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from tissue.study.categories import EVENTS, What, kept_times, outcome, time_column
from verification.thesis.chapter4.ratios import ratios

NO_EVENT = "none"
NO_INM = " no INM"
# Part of the end of a run by which an event at the end may be later: 0.1 h + 0.2 h is more than 0.3 h.
ROUNDING = 1e-12
WINDOW = 1.0  # [h], over which a nucleus is below 0 on average to be extruded by the published rule


def happened(cells: pd.DataFrame, end: float) -> pd.DataFrame:
    """Return whether each event came by the end of the run [h]; columns "A", "B", "S", "P".

    [P] counts from when it acts, which it does not before [B]: so ``t_p_h`` has it.
    """
    return pd.DataFrame({event: cells[time_column(event)] <= end * (1 + ROUNDING) for event in EVENTS})


def outcome_published(cells: pd.DataFrame, what: What, t: float) -> pd.Series:
    """Compute delta(t) as the published code has it, which looks ahead for basal extrusion.

    y_AB < 0 at t, and on average over the output times of the next hour and over all that follow. At the end of the run
    it is ``outcome``.
    """
    hits = outcome(cells, what, t)
    if what != "basal":
        return hits
    later = [f"ab_{u:g}h" for u in kept_times(cells) if u >= t]
    soon = [f"ab_{u:g}h" for u in kept_times(cells) if t <= u <= t + WINDOW]
    return hits & (cells[soon].mean(axis=1) < 0) & (cells[later].mean(axis=1) < 0)


def by_order(cells: pd.DataFrame, end: float) -> pd.Series:
    """Return the events of a cell by the end as they followed: "[AB]" for T_A <= T_B, "[BA]" for T_B < T_A.

    Equal times are in the order A, B, S, P. Without INM the name ends with ``NO_INM``; without events it is "none".
    """
    times = np.column_stack([cells[time_column(event)] for event in EVENTS])
    order = np.argsort(times, axis=1, kind="stable")
    had = np.take_along_axis(happened(cells, end).to_numpy(), order, axis=1)
    letters = np.where(had, np.array(EVENTS, dtype=object)[order], "").sum(axis=1)
    names = np.where(letters == "", NO_EVENT, "[" + letters + "]")
    return pd.Series(names + np.where(cells["inm"], "", NO_INM), index=cells.index)


def given(hits: pd.Series, replicate: pd.Series, values: pd.Series, edges: Sequence[float]) -> pd.DataFrame:
    """Compute E[delta | value in (a, b]] of 3.3.4 for each interval between rising edges, with 95 % intervals.

    Parameters
    ----------
    hits, replicate, values
        Of each cell: whether it is one; its replicate; its event time [h] or its position at the onset. Cells outside
        of the edges, and those with none (infinite or missing), are in no row.

    Returns
    -------
    pd.DataFrame
        ``low_edge``, ``high_edge`` and the columns of ``ratios``; an interval without cells has no row.
    """
    table = ratios(hits, replicate, pd.cut(values.astype(float), list(edges), labels=False))
    first = table.index.to_numpy(dtype=int)
    ends = np.asarray(edges, dtype=float)
    return table.assign(low_edge=ends[first], high_edge=ends[first + 1]).reset_index(drop=True)
