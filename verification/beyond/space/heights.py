"""Means of the study of growth with intervals, and the share of daughters that stays in a section."""

from __future__ import annotations

import math

import pandas as pd

from verification.thesis.chapter3.intervals import over_seeds

# Those with an interval, and without.
TOLD, BESIDE = ("height", "section"), ("number", "basal", "fan", "rough")


def means(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each layer and time: means with Student's 95 % intervals of TOLD; and ``stay``."""
    rows = []
    for name, mine in table.groupby(["layer", "cells", "both", "t"], sort=False):
        told: dict[str, object] = dict(zip(("layer", "cells", "both", "t"), name, strict=True))
        for column in TOLD:
            mean = over_seeds(mine[column])
            told |= {column: mean.mean, f"{column}_low": mean.low, f"{column}_high": mean.high}
        told |= {column: mine[column].mean() for column in BESIDE}
        number = float(mine["number"].mean())
        for end in ("", "_low", "_high"):
            told[f"stay{end}"] = part_that_stays(float(told[f"section{end}"]), number)  # type: ignore[arg-type]
        rows.append(told | {"runs": len(mine)})
    return pd.DataFrame(rows)


def part_that_stays(section: float, number: float) -> float:
    """Return p of (1 + p)^g = section, g = log2(number) generations: the share of second daughters in a section.

    p^div of section 2.2.5 of chapter 3, as a slice would need it; NaN before any division, -1 for an end of an interval
    below 0.
    """
    generations = math.log2(number)
    return float(max(0.0, section) ** (1.0 / generations) - 1.0) if generations > 0.0 else math.nan
