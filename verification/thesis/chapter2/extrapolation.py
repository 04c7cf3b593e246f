"""Catch-up at three fine steps, extrapolated, with a stated error: an independent check of the reference.

Catch-up converges with order 1, x_h = x + c h + ..., so 2 x_{h/2} - x_h loses the term c h (Richardson). Events (a
contact that opens or closes inside of a step) make c depend on h; then the differences do not halve, and nothing can be
extrapolated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from verification.instruments.error_norms import distance
from verification.instruments.references import Known
from verification.thesis.chapter2.convergence import STEP
from verification.thesis.chapter2.methods import CATCH_UP, CATCH_UP_DAQP, LINEARISED_DAQP, REFERENCE_TOL
from verification.thesis.chapter2.reference import EventReference, kept_times, stack
from verification.thesis.chapter2.runs import position_rows, solved

Floats = NDArray[np.float64]
# |x_{h/2} - x_h| / |x_{h/4} - x_{h/2}| is 2 where c h is the error; outside of this range it is not.
RATIOS = (1.6, 2.5)
# A difference of successive results is about their error, but it may be small by chance: where an event falls within a
# step, differs from run to run. So twice the largest difference at a time and at its two neighbours is stated.
SAFETY = 2.0


@dataclass(frozen=True)
class ExtrapolationForm:
    """The k of the three steps STEP / 2^k, coarsest first."""

    exponents: tuple[int, int, int]


FULL = ExtrapolationForm((8, 9, 10))


@dataclass(frozen=True)
class Extrapolated(Known):
    """The solution of one scene.

    Attributes
    ----------
    ratio
        |x_{h/2} - x_h| / |x_{h/4} - x_{h/2}|, (K,); NaN where both are equal.
    extrapolated
        Whether x is 2 x_{h/4} - x_{h/2}, (K,), or else x_{h/4}.
    """

    ratio: Floats
    extrapolated: NDArray[np.bool_]


def extrapolate(t: Floats, coarse: Floats, middle: Floats, fine: Floats, tol: float) -> Extrapolated:
    """Return x = 2 x_{h/4} - x_{h/2} where the differences halve, otherwise x_{h/4}.

    The error is estimated by |x - (2 x_{h/2} - x_h)|, the difference of two successive extrapolations, or by the last
    difference |x_{h/4} - x_{h/2}|, or half of the first if that is larger; stated is ``SAFETY`` times the largest
    estimate at the time and at its neighbours.

    Arguments
    ---------
    t : (K,) times
    coarse, middle, fine : (K, N, d) positions with steps h, h/2, h/4 [length]
    tol : of the projections that made them; no smaller error is stated [length]
    """
    first, second = distance(coarse, middle), distance(middle, fine)
    ratio = np.divide(first, second, out=np.full(len(t), np.nan), where=second > 0)
    halving = (ratio >= RATIOS[0]) & (ratio <= RATIOS[1])
    better = 2 * fine - middle
    x = np.where(halving[:, None, None], better, fine)
    estimate = np.where(halving, distance(better, 2 * middle - coarse), np.maximum(first / 2, second))
    padded = np.pad(estimate, 1)
    error = SAFETY * np.max([padded[:-2], estimate, padded[2:]], axis=0)
    return Extrapolated(t, x, np.maximum(error, tol), ratio, halving)


def study(scenes: Sequence[str], form: ExtrapolationForm) -> Study:
    """Return all runs of catch-up with Ipopt, with Daqp, and of linearised catch-up."""
    steps = [STEP / 2**k for k in form.exponents]
    runs = [
        {"scene": name, "method": method.name, "dt": dt}
        for dt in reversed(steps)
        for method in (CATCH_UP, LINEARISED_DAQP, CATCH_UP_DAQP)
        for name in reversed(scenes)
        if method is not CATCH_UP_DAQP or dt == steps[0]
    ]
    return Study(
        name="catch_up",
        title="Catch-up, to be extrapolated",
        key=("scene", "method", "dt"),
        runs=tuple(runs),
        run=run,
    )


def run(key: Key) -> list[Row]:
    """Return the positions of one run at the times of the reference: one row for each time and particle."""
    times = kept_times(key["scene"])
    path, columns = solved(key["scene"], key["method"], key["dt"], times)
    return position_rows(path, times, dict(key) | columns)


def extrapolated(table: pd.DataFrame, name: str, method: str = CATCH_UP.name) -> Extrapolated:
    """Extrapolate the three runs of a method on a scene, from the table of ``study``."""
    mine = table[(table["scene"] == name) & (table["method"] == method)]
    steps = sorted(mine["dt"].unique(), reverse=True)
    runs = [stack(mine[mine["dt"] == dt]) for dt in steps]
    return extrapolate(runs[0][0], runs[0][1], runs[1][1], runs[2][1], REFERENCE_TOL)


def summary(
    references: Mapping[str, EventReference], table: pd.DataFrame, times: Mapping[str, Sequence[float]]
) -> pd.DataFrame:
    """Return, for each scene and time, the stated error of the reference and its distance to extrapolated catch-up.

    Beside it what that distance is made of: the stated error of the extrapolation, the ratio of its differences; the
    distance of one of its runs to the same run with another projection, which may differ by the tolerances only; the
    distance to the extrapolated linearised catch-up, whose own error is beside it.
    """
    return pd.concat(
        [_summary_of(references[name], table, name, kept) for name, kept in times.items()], ignore_index=True
    )


def _summary_of(own: EventReference, table: pd.DataFrame, name: str, kept: Sequence[float]) -> pd.DataFrame:
    full, linear = extrapolated(table, name), extrapolated(table, name, LINEARISED_DAQP.name)
    columns = {
        "t": full.t,
        "error": own.error,
        "events": own.events,
        "catch_up": distance(own.x, full.x),
        "catch_up_error": full.error,
        "ratio": full.ratio,
        "extrapolated": full.extrapolated,
        "daqp": _same_step(table, name),
        "linearised": distance(full.x, linear.x),
        "linearised_error": linear.error,
    }
    chosen = pd.DataFrame(columns).iloc[np.searchsorted(full.t, kept)]
    chosen.insert(0, "scene", name)
    return chosen


def _same_step(table: pd.DataFrame, name: str) -> Floats:
    """Return the distance between catch-up with Ipopt and with Daqp at the same step."""
    mine = table[table["scene"] == name]
    dt = mine[mine["method"] == CATCH_UP_DAQP.name]["dt"].max()
    pair = [mine[(mine["method"] == method.name) & (mine["dt"] == dt)] for method in (CATCH_UP, CATCH_UP_DAQP)]
    return distance(stack(pair[0])[1], stack(pair[1])[1])
