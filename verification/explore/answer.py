"""The answer of an ensemble: what becomes of EMT and control cells, the height, with intervals; and comparisons."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tissue.pictures.charts import OUTCOMES, ratios_in_time
from tissue.study.categories import CONTROL_SIDES, control_shares, run_shares_in_time
from tissue.study.estimates import estimate
from verification.explore.sequences import Interval, bounded, runs_to_decide, unbounded

if TYPE_CHECKING:
    from tissue.study.categories import What
    from verification.explore.ensemble import PartialResults


Floats = NDArray[np.float64]
Text = Callable[[float, float, float], str]


@dataclass(frozen=True)
class Sample:
    """One value of each run, in the order of the runs, with intervals that are valid at any time.

    Attributes
    ----------
    values
        Of each run.
    bounds
        Of the values, as 0 and 1 for shares; None: none are known.
    """

    values: Floats
    bounds: Interval | None = None

    @property
    def value(self) -> float:
        """The mean."""
        return float(self.values.mean())

    def interval(self) -> Interval:
        """Return the 95 % confidence sequence of the mean."""
        return unbounded(self.values) if self.bounds is None else bounded(self.values, *self.bounds)


def difference(first: Sample, second: Sample) -> Sample:
    """Return first - second, run by run, of as many runs as both have: runs of two settings are independent."""
    runs = min(len(first.values), len(second.values))
    bounds = None
    if first.bounds is not None and second.bounds is not None:
        bounds = first.bounds[0] - second.bounds[1], first.bounds[1] - second.bounds[0]
    return Sample(first.values[:runs] - second.values[:runs], bounds)


def means_of(values: Any) -> tuple[Floats, Floats, Floats]:
    """Compute the mean over the first axis, of length 2 at least, and the ends of its intervals at each time alone."""
    mean = estimate([1.0], [values])
    return mean.value, *mean.interval()


POSITION, HEIGHT, APICAL, BASAL = "y_AB of EMT cells", "height [µm]", "control cells apical", "control cells basal"


class TimeSeries(NamedTuple):
    """A mean over runs at each output time, with its interval; NaN where there are not two values."""

    times: list[float]  # [h]
    mean: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


class Answer(NamedTuple):
    """Answer of the runs so far.

    Attributes
    ----------
    runs, failed
        Replicates, and those of them that did not succeed: they count in nothing else.
    shares
        Of the EMT cells of each run at the end; empty where there are none.
    means
        At the end, of each run: y_AB, the height, shares of control cells; those that have two values.
    in_time
        The ratios at each output time, as ``tissue.pictures.charts.ratios_in_time``; no rows without EMT cells.
    time_series
        Of y_AB and the height.
    folded
        Replicates whose apical layer was folded, so that heights and positions mean nothing; they are among those that
        failed, unless numerics.folded keeps them.
    """

    runs: int
    failed: int
    shares: dict[What, Sample]
    means: dict[str, Sample]
    in_time: pd.DataFrame
    time_series: dict[str, TimeSeries]
    folded: int = 0


def answer_of(grown: PartialResults) -> Answer:
    """Return the answer of the runs that there are, which is that of a study of as many replicates."""
    cells, runs = grown
    times = [float(name.removeprefix("height_um_").removesuffix("h")) for name in runs if _is_height(name)]
    sound = runs[runs["status"] == "SUCCESS"]
    positions = _by_run(cells, times) if len(cells) else np.empty((0, len(times)))
    heights = sound[[f"height_um_{t:g}h" for t in times]].to_numpy(np.float64)
    end = times[-1]
    values = {POSITION: positions[:, -1], HEIGHT: heights[:, -1]}
    values |= {
        name: control_shares(runs, side, end).to_numpy()
        for name, side in zip(SHARES, CONTROL_SIDES.values(), strict=True)
    }
    shares = run_shares_in_time(cells) if len(cells) else {}
    return Answer(
        len(runs),
        len(runs) - len(sound),
        {what: Sample(one[:, -1], SHARE) for what, one in shares.items()},
        {name: Sample(one, SHARE if name in SHARES else None) for name, one in values.items() if len(one) > 1},
        ratios_in_time(cells) if len(cells) else pd.DataFrame(columns=["what", "time_h"]),
        {
            name: TimeSeries(times, *means_of(one))
            for name, one in ((POSITION, positions), (HEIGHT, heights))
            if len(one) > 1
        },
        int((runs["folded"] != "no").sum()),
    )


def _is_height(name: str) -> bool:
    return name.startswith("height_um_")


def _by_run(cells: pd.DataFrame, times: list[float]) -> NDArray[np.float64]:
    """Return the mean of y_AB over the EMT cells of each run; shape (runs, times)."""
    means: NDArray[np.float64] = cells.groupby("replicate")[[f"ab_{t:g}h" for t in times]].mean().to_numpy(np.float64)
    return means


DECIDED = "decided"
NO_INTERVAL = "too few runs for an interval"
SHARES, SHARE = (APICAL, BASAL), (0.0, 1.0)


class AnswerRow(NamedTuple):
    """A number of one answer, or of two: texts of the value with its interval, of the difference, of what is needed."""

    name: str
    value: str
    held: str = ""
    difference: str = ""
    needed: str = ""


def rows_of(now: Answer, held: Answer | None) -> list[AnswerRow]:
    """Return all numbers of an answer; beside one that is held, their differences, this one minus that one."""
    ratios = [
        _row(OUTCOMES[what][2], now.shares[what], None if held is None else held.shares.get(what), _percent, _points)
        for what in OUTCOMES
        if what in now.shares
    ]
    means = [
        _row(name, now.means[name], None if held is None else held.means.get(name), *_texts(name))
        for name in (POSITION, HEIGHT, APICAL, BASAL)
        if name in now.means
    ]
    return ratios + means


def _texts(name: str) -> tuple[Text, Text]:
    return (_percent, _points) if name in SHARES else (_plain, _signed)


def _row(name: str, now: Sample, held: Sample | None, text: Text, of_difference: Text) -> AnswerRow:
    if held is None:
        return AnswerRow(name, text(now.value, *now.interval()))
    gap = difference(now, held)
    texts = text(now.value, *now.interval()), text(held.value, *held.interval())
    compared = f"{of_difference(gap.value, *gap.interval())}, {len(gap.values)} runs of each"
    return AnswerRow(name, *texts, compared, _needed(gap))


def _needed(gap: Sample) -> str:
    """Return what is missing until a difference as large as this one is decided with a probability of 80 %."""
    low, high = gap.interval()
    if low > 0 or high < 0:
        return DECIDED
    needed = runs_to_decide(abs(gap.value), float(gap.values.std()))
    if needed is None:
        return "equal so far"
    return f"{max(needed - len(gap.values), 1):,} more runs".replace(",", " ")


def _percent(value: float, low: float, high: float) -> str:
    return f"{100 * value:.1f} % [{100 * max(low, 0):.1f}, {100 * min(high, 1):.1f}]"


def _points(value: float, low: float, high: float) -> str:
    return f"{100 * value:+.1f} [{100 * low:+.1f}, {100 * high:+.1f}] points"


def _plain(value: float, low: float, high: float) -> str:
    return f"{value:.3g} [{low:.3g}, {high:.3g}]" if low > -np.inf else f"{value:.3g}, {NO_INTERVAL}"


def _signed(value: float, low: float, high: float) -> str:
    return f"{value:+.2g} [{low:+.2g}, {high:+.2g}]" if low > -np.inf else f"{value:+.2g}, {NO_INTERVAL}"
