"""What each row in which the presets differ does to the printed ratios, from the runs of ``differences``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tissue.statistics.categories import Rule, outcome
from tissue.statistics.proportions import LEVEL, quantile
from tissue.statistics.ratios import ratio
from tissue.study.read import Results
from verification.thesis.chapter4.differences import AS_PRINTED, NAME, PUBLISHED, ROWS, SEPARATOR, SETTINGS, design
from verification.thesis.chapter4.printed import END, OF, PRINTED, PRINTED_LEVEL, Printed, against_printed, agrees

# At which time [h] and by which rule of basal extrusion cells are counted, by the ends of both presets.
COUNTS: Mapping[str, tuple[float, Rule]] = {"thesis": (END, "thesis"), "published": (54.0, "published")}
COUNTING = "end and rule of counting"


def changed_ratios(results: Mapping[str, Results]) -> pd.DataFrame:
    """Each printed ratio with one row changed, in the model as printed and in the published runs.

    Columns: start ("as printed" or "published"), row ("" for none), scenario, what, printed, count, of, value, low,
    high (95 %), agrees (whether the 99 % interval of the difference from the printed ratio of 400 cells has 0 in it).
    """
    rows = []
    for kind, start, own, other in (
        ("alone", AS_PRINTED, "thesis", "published"),
        ("without", PUBLISHED, "published", "thesis"),
    ):
        made = results[f"{NAME}_{kind}"]
        for setting in SETTINGS[kind]():
            row = "" if setting.name == start else setting.name
            rows += [{"start": start, "row": row} | each for each in _found(made, setting.name, own)]
        rows += [{"start": start, "row": COUNTING} | each for each in _found(made, start, other)]
    return pd.DataFrame(rows)


def _found(results: Results, setting: str, counted: str) -> Iterator[dict[str, Any]]:
    """The printed ratios in one setting."""
    for printed in PRINTED:
        hits, replicates = _hits(results, setting, printed, counted)
        one = ratio(hits, replicates)
        low, high = one.interval()
        yield {
            "scenario": printed.scenario,
            "what": printed.what,
            "printed": printed.value,
            "count": one.count,
            "of": one.of,
            "value": one.value,
            "low": low,
            "high": high,
            "agrees": agrees(against_printed(one, printed.value, OF), PRINTED_LEVEL),
        }


def _hits(results: Results, setting: str, printed: Printed, counted: str) -> tuple[pd.Series, pd.Series]:
    cells = results.cells(f"{setting}{SEPARATOR}{printed.scenario}")
    return outcome(cells, printed.what, *COUNTS[counted]), cells["replicate"]


def average_effects(results: Mapping[str, Results]) -> pd.DataFrame:
    """Of each row, and of each two: by how much it changes a printed ratio, averaged over all the others.

    With the sign s of a row in each of n settings (1: as published, -1: as printed) and the ratio p of its m runs,

        effect = 2/n sum s p,  variance = 4/n^2 sum p (1 - p)/(m - 1);

    of two rows s is the product of their signs, and the effect half of the difference that one makes to the effect of
    the other. Columns: row, with ("" or the second row), scenario, what, effect, low, high (95 %). Cells are counted at
    the end and by the rule of the thesis; the row of counting is the mean difference of the same cells.
    """
    signs = np.array([[1.0 if row in setting.published else -1.0 for row in ROWS] for setting in design()])
    rows = []
    for printed in PRINTED:
        mine = {"scenario": printed.scenario, "what": printed.what}
        hits = _design_hits(results[f"{NAME}_design"], printed, "thesis")
        for (row, other), sign in _contrasts(signs):
            rows.append({"row": row, "with": other} | mine | _effect(hits, sign))
        apart = _design_hits(results[f"{NAME}_design"], printed, "published") - hits
        half = quantile(LEVEL) * float(apart.std(ddof=1)) / math.sqrt(apart.size)
        mean = float(apart.mean())
        rows.append({"row": COUNTING, "with": ""} | mine | {"effect": mean, "low": mean - half, "high": mean + half})
    return pd.DataFrame(rows)


def _design_hits(results: Results, printed: Printed, counted: str) -> NDArray[np.float64]:
    """1 for a cell with the outcome, 0 for another one; shape (settings, replicates)."""
    return np.array([_hits(results, setting.name, printed, counted)[0] for setting in design()], dtype=float)


def _contrasts(signs: NDArray[np.float64]) -> Iterator[tuple[tuple[str, str], NDArray[np.float64]]]:
    """The signs of each row, then of each two rows."""
    names = list(ROWS)
    for i, name in enumerate(names):
        yield (name, ""), signs[:, i]
    for i, j in combinations(range(len(names)), 2):
        yield (names[i], names[j]), signs[:, i] * signs[:, j]


def _effect(hits: NDArray[np.float64], sign: NDArray[np.float64]) -> dict[str, float]:
    settings, runs = hits.shape
    p = hits.mean(axis=1)
    effect = float(2 / settings * (sign * p).sum())
    half = quantile(LEVEL) * 2 / settings * math.sqrt(float((p * (1 - p)).sum()) / (runs - 1))
    return {"effect": effect, "low": effect - half, "high": effect + half}
