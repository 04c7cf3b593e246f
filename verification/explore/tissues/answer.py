"""The answer of an ensemble: what becomes of EMT and control cells, the height, with intervals; and comparisons."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import stdtrit

from tissue.pictures.charts import OUTCOMES, ratios_in_time
from tissue.statistics.comparisons import Difference, runs_needed
from tissue.statistics.proportions import LEVEL, sample_size
from tissue.study.answers import end_ratios, mean_and_half, shares_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tissue.statistics.categories import What
    from tissue.statistics.ratios import Ratio
    from verification.explore.tissues.ensemble import PartialResults

MAKES_NO_NUMBERS = True

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Mean:
    """Mean of one value of each run; ``spread``: the standard deviation, ``half``: half of the 95 % interval."""

    value: float
    half: float
    spread: float
    runs: int

    def interval(self) -> tuple[float, float]:
        """Return Student's interval."""
        return self.value - self.half, self.value + self.half


def mean_of(values: Floats) -> Mean:
    """Return the mean of one value of each run, of two runs at least."""
    value, half = mean_and_half(values)
    return Mean(float(value), float(half), float(values.std(ddof=1)), len(values))


def means_of(values: Any) -> tuple[Floats, Floats, Floats]:
    """Compute the mean over the first axis, of length 2 at least, and the ends of its intervals."""
    mean, half = mean_and_half(values)
    return mean, mean - half, mean + half


def difference(first: Mean, second: Mean) -> tuple[float, float, float]:
    """Compute first - second with the ends of Welch's 95 % interval for independent runs.

    Source
    ------
    B. L. Welch, The generalization of Student's problem, Biometrika 34 (1947).
    """
    a, b = first.spread**2 / first.runs, second.spread**2 / second.runs
    value = first.value - second.value
    if a + b == 0:
        return value, value, value
    freedom = (a + b) ** 2 / (a**2 / (first.runs - 1) + b**2 / (second.runs - 1))
    half = float(stdtrit(freedom, 0.5 + LEVEL / 2)) * math.sqrt(a + b)
    return value, value - half, value + half


def runs_to_see(first: Mean, second: Mean) -> int | None:
    """Return how many runs of each show a difference of this size, as ``runs_needed`` does of ratios; None: none do.

    n = (z_level + z_power)^2 (s_1^2 + s_2^2)/(m_1 - m_2)^2.
    """
    if first.value == second.value:
        return None
    spread = math.hypot(first.spread, second.spread)
    return max(2, math.ceil(sample_size(first.value - second.value, spread, spread, level=LEVEL)))


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
    ratios
        Of EMT cells at the end; empty where there are none.
    means
        At the end, over runs: of y_AB, of the height, of shares of control cells; those that have two values.
    in_time
        The ratios at each output time, as ``tissue.statistics.ratios.over_time`` has them; no rows without EMT cells.
    time_series
        Of y_AB and the height.
    """

    runs: int
    failed: int
    ratios: dict[What, Ratio]
    means: dict[str, Mean]
    in_time: pd.DataFrame
    time_series: dict[str, TimeSeries]


def answer_of(grown: PartialResults) -> Answer:
    """Return the answer of the runs that there are, which is that of a study of as many replicates."""
    cells, runs = grown
    times = [float(name.removeprefix("height_um_").removesuffix("h")) for name in runs if _is_height(name)]
    sound = runs[runs["status"] == "SUCCESS"]
    positions = _by_run(cells, times) if len(cells) else np.empty((0, len(times)))
    heights = sound[[f"height_um_{t:g}h" for t in times]].to_numpy(np.float64)
    end = times[-1]
    values = {POSITION: positions[:, -1], HEIGHT: heights[:, -1]}
    values |= {name: shares_of(runs, side, end) for name, side in ((APICAL, "apical"), (BASAL, "basal"))}
    return Answer(
        len(runs),
        len(runs) - len(sound),
        end_ratios(cells, end),
        {name: mean_of(one) for name, one in values.items() if len(one) > 1},
        ratios_in_time(cells) if len(cells) else pd.DataFrame(columns=["what", "time_h"]),
        {
            name: TimeSeries(times, *means_of(one))
            for name, one in ((POSITION, positions), (HEIGHT, heights))
            if len(one) > 1
        },
    )


def _is_height(name: str) -> bool:
    return name.startswith("height_um_")


def _by_run(cells: pd.DataFrame, times: list[float]) -> NDArray[np.float64]:
    """Return the mean of y_AB over the EMT cells of each run; shape (runs, times)."""
    means: NDArray[np.float64] = cells.groupby("replicate")[[f"ab_{t:g}h" for t in times]].mean().to_numpy(np.float64)
    return means


DECIDED = "decided"
SHARES = (APICAL, BASAL)


class AnswerRow(NamedTuple):
    """A number of one answer, or of two: texts of the value with its interval, of the difference, of what is needed."""

    name: str
    value: str
    held: str = ""
    difference: str = ""
    needed: str = ""


def rows_of(now: Answer, held: Answer | None) -> list[AnswerRow]:
    """Return all numbers of an answer; beside one that is held, their differences, this one minus that one."""
    ratios = [_of_ratios(OUTCOMES[what][2], what, now, held) for what in OUTCOMES if what in now.ratios]
    names = [name for name in (POSITION, HEIGHT, APICAL, BASAL) if name in now.means]
    return ratios + [_of_means(name, now.means[name], None if held is None else held.means.get(name)) for name in names]


def _of_ratios(name: str, what: What, here: Answer, there: Answer | None) -> AnswerRow:
    now = here.ratios[what]
    if there is None or what not in there.ratios:
        return AnswerRow(name, _percent(now.value, *now.interval()))
    held = there.ratios[what]
    gap = Difference(now, held)
    runs = min(here.runs, there.runs)
    needed = runs_needed(now.value, held.value, cells_per_run=min(now.size / here.runs, held.size / there.runs))
    texts = _percent(now.value, *now.interval()), _percent(held.value, *held.interval())
    return AnswerRow(name, *texts, _points(gap.value, *gap.interval()), _needed(gap.interval(), needed, runs))


def _of_means(name: str, now: Mean, held: Mean | None) -> AnswerRow:
    text = _percent if name in SHARES else _plain
    if held is None:
        return AnswerRow(name, text(now.value, *now.interval()))
    value, *ends = difference(now, held)
    needed = _needed((ends[0], ends[1]), runs_to_see(now, held), min(now.runs, held.runs))
    texts = text(now.value, *now.interval()), text(held.value, *held.interval())
    return AnswerRow(name, *texts, (_points if name in SHARES else _signed)(value, *ends), needed)


def _needed(interval: tuple[float, float], needed: int | None, runs: int) -> str:
    """Return what is missing to see a difference as large as this one with a probability of 80 %."""
    if interval[0] > 0 or interval[1] < 0:
        return DECIDED
    if needed is None:
        return "equal so far"
    return f"{max(needed - runs, 1):,} more runs".replace(",", " ")


def _percent(value: float, low: float, high: float) -> str:
    return f"{100 * value:.1f} % [{100 * max(low, 0):.1f}, {100 * min(high, 1):.1f}]"


def _points(value: float, low: float, high: float) -> str:
    return f"{100 * value:+.1f} [{100 * low:+.1f}, {100 * high:+.1f}] points"


def _plain(value: float, low: float, high: float) -> str:
    return f"{value:.3g} [{low:.3g}, {high:.3g}]"


def _signed(value: float, low: float, high: float) -> str:
    return f"{value:+.2g} [{low:+.2g}, {high:+.2g}]"
