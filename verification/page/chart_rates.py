"""The chart of W1 rates, from its tables only."""

from __future__ import annotations

import numpy as np
import pandas as pd

from verification.page.charts import COLOURS
from verification.page.sheet import Axes, own_axes

LOOKS = {"w1": ("E W1", "o", "-"), "error_y": ("E |y_N - y|", "s", "--")}


def draw_rates(means: pd.DataFrame, fit: pd.DataFrame, ax: Axes | None) -> Axes:
    """Means with intervals as bars, the fitted power as a line, for each quantity and time."""
    panel = own_axes(ax)
    for k, row in enumerate(fit.itertuples()):
        what, marker, line = LOOKS[row.quantity]
        mine = means[(means["quantity"] == row.quantity) & (means["t"] == row.t)]
        colour = COLOURS[k % len(COLOURS)]
        # A lower end that is not positive has no place on a logarithmic axis.
        low = mine["low"].where(mine["low"] > 0, mine["mean"] / 10)
        bars = np.array([mine["mean"] - low, mine["high"] - mine["mean"]])
        panel.errorbar(mine["N"], mine["mean"], yerr=np.nan_to_num(bars), fmt=marker, color=colour, capsize=2.0)
        half = (row.high - row.low) / 2
        label = f"{what} at t = {row.t:g}: power {row.slope:.2f} ± {half:.2f}"
        panel.plot(mine["N"], row.constant * mine["N"] ** row.slope, line, color=colour, label=label)
    panel.set(xscale="log", yscale="log", xlabel="N")
    panel.legend(fontsize="small")
    return panel
