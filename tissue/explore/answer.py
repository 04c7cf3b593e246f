"""The answer of an ensemble: what becomes of EMT cells and of control cells, the height; all with intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pandas as pd

from tissue.explore.means import Mean, mean_of, means_of
from tissue.study.answers import end_ratios, shares_of
from tissue.study.figures.course import ratios_in_time

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from tissue.explore.ensemble import Grown
    from tissue.study.categories import What
    from tissue.study.ratios import Ratio

MAKES_NO_NUMBERS = True

POSITION, HEIGHT, APICAL, BASAL = "y_AB of EMT cells", "height [µm]", "control cells apical", "control cells basal"


class Course(NamedTuple):
    """A mean over runs at each kept time, with its interval; NaN where there are not two values."""

    times: list[float]  # [h]
    mean: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


class Answer(NamedTuple):
    """What the runs say that there are.

    Attributes
    ----------
    runs, failed
        Replicates, and those of them that did not succeed: they count in nothing else.
    ratios
        Of EMT cells at the end; empty where there are none.
    means
        At the end, over runs: of y_AB, of the height, of shares of control cells; those that have two values.
    in_time
        The ratios at each kept time, as ``tissue.study.curves.over_time`` has them; no rows without EMT cells.
    courses
        Of y_AB and the height.
    """

    runs: int
    failed: int
    ratios: dict[What, Ratio]
    means: dict[str, Mean]
    in_time: pd.DataFrame
    courses: dict[str, Course]


def answer_of(grown: Grown) -> Answer:
    """The answer of the runs that there are, which is that of a study of as many replicates."""
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
            name: Course(times, *means_of(one))
            for name, one in ((POSITION, positions), (HEIGHT, heights))
            if len(one) > 1
        },
    )


def _is_height(name: str) -> bool:
    return name.startswith("height_um_")


def _by_run(cells: pd.DataFrame, times: list[float]) -> NDArray[np.float64]:
    """The mean of y_AB over the EMT cells of each run; shape (runs, times)."""
    means: NDArray[np.float64] = cells.groupby("replicate")[[f"ab_{t:g}h" for t in times]].mean().to_numpy(np.float64)
    return means
