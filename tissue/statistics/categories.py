"""EMT categories (3.3.3, 3.3.4): which events a cell had, in which order and when; and what became of it (3.3.1)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np
import pandas as pd

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.events.known import mark_of
from tissue.state.cells import Floats

EVENTS = ("A", "B", "S", "P")  # in this order where times are equal, so that [AB] has T_A <= T_B
NO_EVENT = "none"
NO_INM = " no INM"
NEVER = "never"
WINDOW = 1.0  # [h], over which a nucleus is below 0 on average to be extruded by the published rule

Edges = Sequence[float] | Floats
What = Literal["basal", "apical", "below"]
Rule = Literal["thesis", "published"]

# Part of the end of a run by which an event at the end may be later: 0.1 h + 0.2 h is more than 0.3 h.
ROUNDING = 1e-12

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


def happened(cells: pd.DataFrame, end: float) -> pd.DataFrame:
    """Return whether each event came by the end of the run [h]; columns "A", "B", "S", "P" and the others.

    [P] counts from when it acts, which it does not before [B]: so ``t_p_h`` has it.
    """
    return pd.DataFrame({event: _by_end(cells[time_column(event)], end) for event in timed(cells)}, index=cells.index)


def by_selection(cells: pd.DataFrame, end: float, *, inm: bool = False) -> pd.Series:
    """Return which events a cell had by the end, in whatever order: "none", "A", "B", "AB", ..., "ABSP".

    Parameters
    ----------
    cells
        Table of the EMT cells.
    end
        Of the run [h]; later events did not happen.
    inm
        Whether to tell cells without INM apart: "AB no INM".

    Returns
    -------
    pd.Series
        Ordered categories, by number of events, then by the alphabet; those that occur.
    """
    names = np.full(len(cells), "", dtype=object)
    for event, had in happened(cells, end).items():
        names = names + np.where(had, str(event), "")
    return _named(cells, names, inm=inm)


def by_order(cells: pd.DataFrame, end: float, *, inm: bool = False) -> pd.Series:
    """Return the events of a cell by the end as they followed: "[AB]" for T_A <= T_B, "[BA]" for T_B < T_A.

    Equal times are in the order A, B, S, P, others. Parameters and categories are those of ``by_selection``.
    """
    events = timed(cells)
    times = np.column_stack([cells[time_column(event)] for event in events])
    order = np.argsort(times, axis=1, kind="stable")
    had = _by_end(np.take_along_axis(times, order, axis=1), end)
    letters = np.where(had, np.array(events, dtype=object)[order], "")
    joined = letters.sum(axis=1) if len(cells) else np.full(0, "", dtype=object)
    return _named(cells, np.where(joined == "", "", "[" + joined + "]"), inm=inm)


def interval_names(edges: Edges) -> list[str]:
    """Name the intervals that edges make of the line, with the rest: "<= 0", "(0, 0.5]", "(0.5, 1]", "> 1".

    Raises
    ------
    InvalidProblem
        If the edges are not at least two finite numbers that rise.
    """
    values = np.asarray(edges, dtype=np.float64)
    if values.ndim != 1 or len(values) < 2 or not np.isfinite(values).all() or (np.diff(values) <= 0).any():
        raise InvalidProblem(f"edges = {describe(edges)}: must be two or more finite numbers, each above the last")
    texts = [f"{value:g}" for value in values]
    between = [f"({low}, {high}]" for low, high in pairwise(texts)]
    return [f"<= {texts[0]}", *between, f"> {texts[-1]}"]


def by_interval(values: pd.Series, edges: Edges) -> pd.Series:
    """Find the interval (a, b] of an event time [h], or of a position at the onset (3.3.4).

    Parameters
    ----------
    values
        +inf: never. NaN or null: there is none.
    edges
        At least two, rising.

    Returns
    -------
    pd.Series
        Ordered categories: those of ``interval_names``, then "never", which also stands for none.
    """
    names = [*interval_names(edges), NEVER]
    numbers = values.to_numpy(dtype=np.float64, na_value=np.nan)
    codes = np.searchsorted(np.asarray(edges, dtype=np.float64), numbers, side="left")
    codes = np.where(np.isfinite(numbers), codes, len(names) - 1)
    dtype = pd.CategoricalDtype(names, ordered=True)
    return pd.Series(pd.Categorical.from_codes(codes, dtype=dtype), index=values.index, name=values.name)


def outcome(cells: pd.DataFrame, what: What, t: float, rule: Rule = "thesis") -> pd.Series:
    """Compute delta(t) of (4.3) for each cell.

    Parameters
    ----------
    cells
        Table of the EMT cells.
    what
        "basal": extruded basally, y_AB < 0. "apical": extruded apically, y_AB > 1. "below": at or below all control
        cells.
    t
        An output time [h].
    rule
        For basal extrusion: "thesis": y_AB(t) < 0. "published": also on average over the output times of the next hour
        and over all that follow, as the published code has it. At the end of the run both are the same.

    Returns
    -------
    pd.Series
        bool.

    Raises
    ------
    InvalidProblem
        If ``what``, ``rule`` or the time is not one of those.
    """
    for name, value, allowed in (("what", what, get_args(What)), ("rule", rule, get_args(Rule))):
        if value not in allowed:
            raise InvalidProblem(f"{name} = {describe(value)}: must be one of {', '.join(allowed)}")
    times = kept_times(cells)
    if t not in times:
        raise InvalidProblem(f"t = {describe(t)}: must be an output time; these are {describe(times)} h")
    if what == "below":
        return cells[f"below_{t:g}h"].astype(bool)
    position = cells[f"ab_{t:g}h"]
    if what == "apical":
        return position > 1
    return position < 0 if rule == "thesis" else (position < 0) & _stays(cells, [u for u in times if u >= t])


def in_time(cells: pd.DataFrame) -> dict[What, np.ndarray]:
    """Return ``outcome`` of all cells by the rule "thesis" at all output times; each of shape (times, cells)."""
    times = kept_times(cells)
    position, below = (cells[[f"{name}_{t:g}h" for t in times]].to_numpy().T for name in ("ab", "below"))
    return {"basal": position < 0, "apical": position > 1, "below": below.astype(bool)}


def _by_end(times: Any, end: float) -> Any:
    """Return whether times are up to the end: an event at the end begins in the last step."""
    return times <= end * (1 + ROUNDING)


def _stays(cells: pd.DataFrame, times: list[float]) -> pd.Series:
    """Return whether the mean position is below 0 over the next hour, and over the rest of the run."""
    soon = [f"ab_{u:g}h" for u in times if u <= times[0] + WINDOW]
    later = [f"ab_{u:g}h" for u in times]
    return (cells[soon].mean(axis=1) < 0) & (cells[later].mean(axis=1) < 0)


def _named(cells: pd.DataFrame, names: np.ndarray, *, inm: bool) -> pd.Series:
    texts = pd.Series(names, index=cells.index, dtype=object).replace("", NO_EVENT)
    if inm:
        texts = texts + np.where(cells["inm"], "", NO_INM)
    present = sorted(texts.unique(), key=_rank)
    return pd.Series(pd.Categorical(texts, categories=present, ordered=True), index=cells.index, name="category")


def _rank(name: str) -> tuple[bool, int, str]:
    """Rank no event first, then by the number of events, then by the alphabet; with INM before without."""
    return not name.startswith(NO_EVENT), len(name.removesuffix(NO_INM)), name
