"""Small pictures for the first page, from tables only."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from verification.claims import Verdict
from verification.site.sheet import GREY, Axes, sheet

SIZE = {"width": 4.4, "height": 2.7}  # inches
LOOK: dict[str, Any] = {"font.size": 9.0, "axes.grid": False}
# From sure to wrong.
VERDICT_COLOURS: Mapping[Verdict, str] = {
    Verdict.PROVED: "#12602c",
    Verdict.PROVED_INSTANCE: "#5a9467",
    Verdict.HOLDS: "#8fc49a",
    Verdict.NOT_REFUTED: "#c4dfc9",
    Verdict.CORRECTED: "#e0a33e",
    Verdict.REFUTED: "#b3261e",
    Verdict.OPEN: "#c9ced2",
}


def share(hits: int, tries: int) -> tuple[float, float, float]:
    """Return a share with its 95 % interval by Wilson."""
    low, high = binomtest(hits, tries).proportion_ci(method="wilson")
    return hits / tries, float(low), float(high)


@contextmanager
def card(path: Path, **look: Any) -> Iterator[Axes]:
    """Yield the axes of a card, which is written at the end of the block."""
    with sheet(path, **SIZE, **LOOK | look) as figure:
        yield figure.subplots()


def bars(
    names: Sequence[str], values: Sequence[float], ends: Sequence[tuple[float, float]], label: str, path: Path
) -> Path:
    """Draw horizontal bars with intervals, the first one on top."""
    with card(path) as panel:
        place = np.arange(len(names))[::-1]
        low, high = (np.array([end[k] for end in ends]) for k in (0, 1))
        panel.barh(place, values, color="#0072b2", height=0.62)
        panel.hlines(place, low, high, color="#22262b", linewidth=1.4)
        panel.set_yticks(place, names)
        panel.tick_params(axis="y", length=0)
        panel.set_xlabel(label)
    return path


def verdicts(counts: Mapping[Verdict, int], path: Path) -> Path:
    """Draw one bar of all claims, divided by verdict, each part with its number."""
    with card(path, **{"axes.spines.left": False, "axes.spines.bottom": False}) as panel:
        start, total = 0, sum(counts.values())
        for k, (verdict, count) in enumerate((one, counts[one]) for one in Verdict if counts.get(one)):
            panel.barh(0, count, left=start, color=VERDICT_COLOURS[verdict], height=0.5)
            high = -0.42 - 0.2 * k
            panel.plot(start + count / 2, -0.25, "|", color=GREY, markersize=4)
            panel.plot(0.01 * total, high, "s", color=VERDICT_COLOURS[verdict], markersize=7)
            panel.text(0.04 * total, high, f"{count} {verdict.value}", va="center")
            start += count
        panel.set(xlim=(0, total), ylim=(-0.5 - 0.2 * len(counts), 0.3), xticks=[], yticks=[])
    return path
