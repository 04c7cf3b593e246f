"""Ratios of cells for claims about runs: what decides, and how many runs it would need."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeVar

import numpy as np

from tissue.statistics.comparisons import Difference, runs_needed
from tissue.statistics.proportions import POWER, quantile, sample_size
from tissue.statistics.ratios import Ratio, as_ratio
from verification.claims import Comparison, Interval, Tables
from verification.thesis.chapter4.ratio_claims import CLAIM_LEVEL
from verification.thesis.chapter4.studies import PRESETS

Found = TypeVar("Found")
# The model that decides: as printed, with the energies corrected and nothing else. Beside it stand the others.
DECIDES = "corrected"
BESIDE = {"thesis": "as printed", "published": "published"}
RATIOS, CATEGORIES, CONDITIONAL = (f"emt_complete_{name}" for name in ("ratios", "categories", "conditional"))


def ratio_of(tables: Tables, study: str, scenario: str, what: str) -> Ratio:
    """The cells of a scenario with this outcome at the end of the runs."""
    table = tables[RATIOS]
    (row,) = np.flatnonzero((table["study"] == study) & (table["scenario"] == scenario) & (table["what"] == what))
    return as_ratio(table.iloc[row])


def of_event(tables: Tables, suffix: str, event: str, what: str) -> Ratio:
    """An isolated cell with INM and one event, Figure 10."""
    return ratio_of(tables, f"figure10{suffix}", event, what)


def category(tables: Tables, study: str, *categories: str) -> Ratio:
    """The basally extruded ones among the cells of a mixed group with these events, several orders taken together."""
    rows = tables[CATEGORIES].set_index(["study", "category"])
    found = [as_ratio(rows.loc[(study, name)]) for name in categories]
    counts = [sum(numbers) for numbers in zip(*((each.count, each.of, each.size) for each in found), strict=True)]
    return Ratio(int(counts[0]), int(counts[1]), counts[2])


def in_models(find: Callable[[str], Found]) -> dict[str, Found]:
    """What is found by preset; ``find`` is given the end of the names of its studies."""
    return {preset: find(suffix) for preset, suffix in PRESETS.items()}


def exclusive(first: Ratio, second: Ratio) -> Difference:
    """The difference of two outcomes of the same cells, of which no cell has both; one cell in each run."""
    p, q = first.value, second.value
    spread = math.sqrt(p * (1 - p) * q * (1 - q))
    return Difference(first, second, max(-1.0, -p * q / spread) if spread > 0 else 0.0)


def hull(what: str, intervals: Sequence[Interval], low: float, high: float) -> Comparison:
    """One number of several kinds of cells: its interval reaches over all of theirs, so that no kind is left out."""
    least, most = min(a for a, _ in intervals), max(b for _, b in intervals)
    return Comparison(what, sum(a + b for a, b in intervals) / (2 * len(intervals)), low, high, (least, most))


def more(what: str, *found: Mapping[str, Difference]) -> Comparison:
    """The first ratio is larger than the second, of each of the kinds."""
    return hull(what, _intervals(found), 0.0, math.inf)


def alike(what: str, *found: Mapping[str, Difference], margin: float) -> Comparison:
    """The ratios differ by less than the margin, of each of the kinds."""
    return hull(what, _intervals(found), -margin, margin)


def most_runs(sizes: Iterable[int | None]) -> int | None:
    """The largest of some numbers of runs; None stands for what no number of runs shows."""
    return max((size for size in sizes if size is not None), default=None)


def needed(*found: Mapping[str, Difference]) -> int | None:
    """Runs of each kind with which the measured differences would be seen, of those that runs can show."""
    deciding = (each[DECIDES] for each in found)
    return most_runs(runs_needed(each.first.value, each.second.value, level=CLAIM_LEVEL) for each in deciding)


def runs_for_bound(value: float, bound: float, level: float = CLAIM_LEVEL, power: float = POWER) -> int | None:
    """Independent cells with which a ratio is seen to be above or below a bound with the given probability.

    n = (z_level sqrt(b (1 - b)) + z_power sqrt(p (1 - p)))^2/(p - b)^2 for the ratio p and the bound b; None if they
    are equal, which no number of cells tells apart, and for a bound that no ratio crosses.
    """
    if value == bound or not 0 < bound < 1:
        return None
    spreads = (math.sqrt(p * (1 - p)) for p in (bound, value))
    return max(1, math.ceil(sample_size(value - bound, *spreads, level=level, power=power)))


def runs_for_margin(found: Difference, margin: float, level: float = CLAIM_LEVEL, power: float = POWER) -> int | None:
    """Independent cells of each kind with which a difference is seen to be above or below a margin.

    n = ((z_level + z_power)/(|d| - margin))^2 (v_1 + v_2 - 2 c sqrt(v_1 v_2)) with v = p (1 - p) and the correlation c;
    None for a difference at the margin.
    """
    distance = abs(abs(found.value) - margin)
    if distance == 0:
        return None
    variances = [side.value * (1 - side.value) for side in (found.first, found.second)]
    variance = sum(variances) - 2 * found.correlation * math.sqrt(math.prod(variances))
    spread = math.sqrt(variance)
    return max(1, math.ceil(sample_size(distance, spread, spread, level=level, power=power)))


def runs_by_width(cells: float, interval: Interval, level: float) -> int | None:
    """Independent cells with which a number is seen to be above or below 0, by its interval from ``cells`` of them.

    n = cells (h/m (z_claim + z_power)/z_level)^2 for the middle m and the half-width h; None for m = 0.
    """
    half, middle = (interval[1] - interval[0]) / 2, (interval[0] + interval[1]) / 2
    if middle == 0:
        return None
    spread = half / quantile(level) * math.sqrt(cells)
    return max(1, math.ceil(sample_size(middle, spread, spread, level=CLAIM_LEVEL)))


def told(found: Mapping[str, Difference]) -> str:
    """The difference that decides with its interval, and those of the other models."""
    others = ", ".join(f"{name} {100 * found[preset].value:+.1f}" for preset, name in BESIDE.items())
    return f"{found[DECIDES]} ({others})"


def shares(found: Mapping[str, Ratio]) -> str:
    """The ratio that decides with its interval, and those of the other models."""
    others = ", ".join(f"{name} {100 * found[preset].value:.1f} %" for preset, name in BESIDE.items())
    return f"{found[DECIDES]} ({others})"


def _intervals(found: Iterable[Mapping[str, Difference]]) -> list[Interval]:
    return [each[DECIDES].interval(CLAIM_LEVEL) for each in found]
