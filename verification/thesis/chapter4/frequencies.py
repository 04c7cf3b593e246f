"""Ratios of cells for claims about runs: three readings of the model, comparisons of ratios, and the runs they need.

Chapter 3 can be read in three ways: with the energies as printed, as the published program runs them, and with the
misprints of the energies corrected and nothing else. Each claim that depends on the model is decided under all three;
``RULE`` says which verdict is its headline.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd

from tissue.statistics.comparisons import Difference, runs_needed
from tissue.statistics.proportions import POWER, quantile, sample_size
from tissue.statistics.ratios import Ratio, as_ratio
from verification.claims import Comparison, Evidence, Interval, Table, Tables
from verification.thesis.chapter4.studies import PRESETS

# By preset.
READINGS = {"thesis": "printed energies", "published": "published program", "corrected": "corrected energies"}
# The readings that decide what the thesis says of its simulations, and of its model; pages quote the rule.
OUTCOMES, MODEL = "published", "thesis"
RULE = (
    "The published program decides where the thesis reports outcomes of its simulations, "
    "the printed energies where it describes the model."
)
RATIOS, CATEGORIES, CONDITIONAL, ORDERS, RANKING, PRINTED, SINCE = (
    Table(f"emt_complete_{name}", "verification.thesis.chapter4.kept:take_over")
    for name in ("ratios", "categories", "conditional", "orders", "ranking", "printed", "since")
)
CLAIM_LEVEL = 0.99  # at which a claim is judged: so narrow a chance of error is for several comparisons of a claim
ALIKE = 0.1  # ratios that differ by less are alike: the thesis prints tenths and calls its results qualitative
PERCENT = 100.0
KINDS = ("INM", "no INM")
EDGE = 1e-9  # rounding of the ends of intervals


class Sized(NamedTuple):
    """A comparison, and the independent cells or runs of each kind that would probably decide it; None: no number."""

    comparison: Comparison
    runs: int | None


class Estimate(NamedTuple):
    """A number with its interval at ``CLAIM_LEVEL``, and the independent cells that it is from."""

    value: float
    interval: Interval
    cells: float


def in_readings(compare: Callable[[str], Evidence], decides: str = OUTCOMES) -> Evidence:
    """Return the evidence of the reading that decides, with the evidence of all; ``compare`` is given the preset."""
    found = {preset: compare(preset) for preset in READINGS}
    return replace(found[decides], readings={name: found[preset] for preset, name in READINGS.items()})


def evidence(printed: Sequence[Sized], corrected: Sequence[Sized] = (), remark: str = "") -> Evidence:
    """Return comparisons as evidence, with the most runs that one of them needs."""
    wanted, instead = (tuple(each.comparison for each in side) for side in (printed, corrected))
    return Evidence(remark, wanted, instead, runs_needed=most_runs(each.runs for each in (*printed, *corrected)))


def ratio_of(tables: Tables, preset: str, study: str, scenario: str, what: str) -> Ratio:
    """Return the cells of a scenario with this outcome at the end of the runs."""
    table = tables[RATIOS]
    wanted = {"study": study + PRESETS[preset], "scenario": scenario, "what": what}
    (row,) = np.flatnonzero(np.logical_and.reduce([table[name] == value for name, value in wanted.items()]))
    return as_ratio(table.iloc[row])


def category(tables: Tables, preset: str, study: str, *categories: str) -> Ratio:
    """Return the basally extruded ones among the cells of a mixed group with these events, in any of some orders."""
    rows = tables[CATEGORIES].set_index(["study", "category"])
    return pooled([as_ratio(rows.loc[(study + PRESETS[preset], name)]) for name in categories])


def mixed(tables: Tables, preset: str, study: str, events: str, inm: str) -> Ratio:
    """Return basal extrusion of cells with these events, in any order, in a group of Table 5."""
    names = ("[AB]", "[BA]") if events == "[A] and [B]" else (events,)
    return category(tables, preset, study, *(f"{name}{inm}" for name in names))


def own(tables: Tables, preset: str, events: str, inm: str, group: str) -> Ratio:
    """Return basal extrusion of cells with these events at any time, alone or in a group in which all have them."""
    return basal(tables, preset, ("mixtures", "questions"), f"{events} at any time{inm}{group}")


def basal(tables: Tables, preset: str, studies: Sequence[str], scenario: str) -> Ratio:
    """Return basal extrusion in a scenario, of the first of some studies that has it."""
    table = tables[RATIOS]
    there = set(table.loc[table["scenario"] == scenario, "study"])
    study = next(study for study in studies if study + PRESETS[preset] in there)
    return ratio_of(tables, preset, study, scenario, "basal")


def bins(tables: Tables, preset: str, study: str, given: str, inm: str) -> pd.DataFrame:
    """Return basal extrusion by intervals of an event time, or of the position at the onset, cells without [P]."""
    table = tables[CONDITIONAL]
    mine = (table["study"] == study + PRESETS[preset]) & (table["given"] == given) & (table["inm"] == inm)
    return table[mine].sort_values("low_edge")


def between(tables: Tables, preset: str, study: str, given: str, inm: str, low: float, high: float) -> Ratio:
    """Return basal extrusion of the cells of several such intervals together."""
    rows = bins(tables, preset, study, given, inm)
    inside = (rows["low_edge"] >= low - EDGE) & (rows["high_edge"] <= high + EDGE)
    return pooled([as_ratio(row) for _, row in rows[inside].iterrows()])


def pooled(ratios: Sequence[Ratio]) -> Ratio:
    """Return the ratio of several kinds of cells together."""
    return Ratio(sum(r.count for r in ratios), sum(r.of for r in ratios), sum(r.size for r in ratios))


def minus(sides: Iterable[Ratio]) -> Difference:
    """Return the first of two ratios of separate cells minus the second."""
    first, second = sides
    return Difference(first, second)


def exclusive(first: Ratio, second: Ratio) -> Difference:
    """Return the difference of two outcomes of the same cells, of which no cell has both; one cell in each run."""
    p, q = first.value, second.value
    spread = math.sqrt(p * (1 - p) * q * (1 - q))
    return Difference(first, second, max(-1.0, -p * q / spread) if spread > 0 else 0.0)


def more(what: str, found: Difference, least: float = 0.0) -> Sized:
    """Compare: the first ratio is larger than the second by ``least``."""
    first, second = found.first.value, found.second.value
    runs = runs_for_margin(found, least) if least else runs_needed(first, second, level=CLAIM_LEVEL)
    return Sized(_in_percent(f"{what} [points]", found.value, found.interval(CLAIM_LEVEL), least, math.inf), runs)


def alike(what: str, found: Difference, margin: float = ALIKE) -> Sized:
    """Compare: two ratios differ by less than a margin."""
    comparison = _in_percent(f"{what} [points]", found.value, found.interval(CLAIM_LEVEL), -margin, margin)
    return Sized(comparison, runs_for_margin(found, margin))


def share(what: str, found: Ratio, low: float = -math.inf, high: float = math.inf) -> Sized:
    """Compare: a ratio is from ``low`` to ``high``."""
    comparison = _in_percent(f"{what} [%]", found.value, found.interval(CLAIM_LEVEL), low, high)
    return Sized(comparison, most_runs(runs_for_bound(found.value, end) for end in (low, high)))


def averaged(found: Sequence[Difference], weights: Sequence[float] | None = None) -> Estimate:
    """Return the mean of differences of separate kinds of cells; by default each counts by n_1 n_2/(n_1 + n_2) cells.

    The interval is d - sqrt(sum w^2 (d_k - l_k)^2) to d + sqrt(sum w^2 (u_k - d_k)^2) for intervals [l_k, u_k].

    Source
    ------
    G. Y. Zou, A. Donner, Construction of confidence limits about effect measures, Statistics in Medicine 27 (2008).
    """
    sizes = [1 / (1 / each.first.size + 1 / each.second.size) for each in found] if weights is None else weights
    shares = [size / sum(sizes) for size in sizes]
    ends = [each.interval(CLAIM_LEVEL) for each in found]
    value = sum(w * each.value for w, each in zip(shares, found, strict=True))
    below, above = (
        math.hypot(*(w * (each.value - end[side]) for w, each, end in zip(shares, found, ends, strict=True)))
        for side in (0, 1)
    )
    return Estimate(value, (value - below, value + above), sum(sizes))


def estimated(what: str, found: Estimate, low: float, high: float) -> Sized:
    """Compare: an estimate is from ``low`` to ``high``."""
    nearest = min((end for end in (low, high) if math.isfinite(end)), key=lambda end: abs(end - found.value))
    shifted = (found.interval[0] - nearest, found.interval[1] - nearest)
    comparison = _in_percent(f"{what} [points]", found.value, found.interval, low, high)
    return Sized(comparison, runs_by_width(found.cells, shifted, CLAIM_LEVEL))


def counted(what: str, parts: Sequence[Comparison], least: int) -> Comparison:
    """Compare: at least so many of some comparisons hold; those that are open are between."""
    held, refuted = (sum(part.true is truth for part in parts) for truth in (True, False))
    most = len(parts) - refuted
    return Comparison(f"{what}, of {len(parts)}", (held + most) / 2, least, math.inf, (held, most))


def most_runs(sizes: Iterable[int | None]) -> int | None:
    """Return the largest of some numbers of runs; None stands for what no number of runs shows."""
    return max((size for size in sizes if size is not None), default=None)


def runs_for_bound(value: float, bound: float, level: float = CLAIM_LEVEL, power: float = POWER) -> int | None:
    """Return the independent cells that show a ratio to be above or below a bound with the given probability.

    n = (z_level sqrt(b (1 - b)) + z_power sqrt(p (1 - p)))^2/(p - b)^2 for the ratio p and the bound b; None if they
    are equal, which no number of cells tells apart, and for a bound that no ratio crosses.
    """
    if value == bound or not 0 < bound < 1:
        return None
    spreads = (math.sqrt(p * (1 - p)) for p in (bound, value))
    return max(1, math.ceil(sample_size(value - bound, *spreads, level=level, power=power)))


def runs_for_margin(found: Difference, margin: float, level: float = CLAIM_LEVEL, power: float = POWER) -> int | None:
    """Return the independent cells of each kind that show a difference to be above or below a margin.

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
    """Return the independent cells that show a number to be above or below 0, by its interval from ``cells`` of them.

    n = cells (h/m (z_claim + z_power)/z_level)^2 for the middle m and the half-width h; None for m = 0.
    """
    half, middle = (interval[1] - interval[0]) / 2, (interval[0] + interval[1]) / 2
    if middle == 0:
        return None
    spread = half / quantile(level) * math.sqrt(cells)
    return max(1, math.ceil(sample_size(middle, spread, spread, level=CLAIM_LEVEL)))


def _in_percent(what: str, value: float, interval: Interval, low: float, high: float) -> Comparison:
    low_end, high_end = interval
    return Comparison(what, PERCENT * value, PERCENT * low, PERCENT * high, (PERCENT * low_end, PERCENT * high_end))
