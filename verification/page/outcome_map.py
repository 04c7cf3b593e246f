"""Maps of outcomes: a colour and a hatching for each word, so that they are told apart without colours, too."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from verification.outcome import COLOURS, Outcome
from verification.page.sheet import Axes, hatch_cells, patch

HATCHES: Mapping[str, str] = {
    Outcome.CONVERGED.value: "",
    Outcome.BOUNDED.value: "..",
    Outcome.INACCURATE.value: "---",
    Outcome.INFEASIBLE.value: "////",
    Outcome.UNSTABLE.value: "xxxx",
    Outcome.NOT_TERMINATED.value: "||||",
    Outcome.REFUSED.value: "\\\\\\\\",
}
# Thin and light: the colours lead.
HATCHING: dict[str, Any] = {"edgecolor": "#ffffff99", "linewidth": 0.0}


def draw_outcomes(panel: Axes, x: NDArray[np.float64], y: NDArray[np.float64], words: NDArray[Any]) -> None:
    """The word of every cell, (m, n), between the edges x (n + 1,) and y (m + 1,)."""
    colours = np.array([[rgb(COLOURS[word]) for word in line] for line in words])
    panel.pcolormesh(x, y, colours, edgecolors="white", linewidth=0.3)
    for word, hatch in HATCHES.items():
        here = words == word
        if hatch and here.any():
            hatch_cells(panel, x, y, here, hatch=hatch, facecolor="none", **HATCHING)
    panel.grid(visible=False)


def outcome_handles(words: Iterable[str]) -> list[Any]:
    """What stands for these words in a legend."""
    return [patch(facecolor=COLOURS[word], hatch=HATCHES[word], **HATCHING) for word in words]


def rgb(colour: str) -> list[float]:
    """Red, green and blue in [0, 1] of "#rrggbb"."""
    return [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
