"""Ratios of cells for claims about runs: three readings of the model, comparisons of ratios, and the runs they need.

Chapter 3 can be read in three ways: with the energies as printed, as the published program runs them, and with the
misprints of the energies corrected and nothing else. Each claim that depends on the model is decided under all three;
``RULE`` says which verdict is its headline.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from tissue.study.estimates import POWER
from verification.claims import Claim, Comparison, Evidence, Interval, Table, Tables, claim
from verification.thesis.chapter4.ensembles import PRESETS, preset_of
from verification.thesis.chapter4.groups import BY_EVENTS
from verification.thesis.chapter4.ratios import ProportionContrast, Ratio, as_ratio, difference, quantile

# By preset.
READINGS = {"thesis": "printed energies", "published": "published program", "corrected": "corrected energies"}
# The readings that decide what the thesis says of its simulations, and of its model; pages quote the rule.
OUTCOMES, MODEL = "published", "thesis"
RULE = (
    "The published program decides where the thesis reports outcomes of its simulations, "
    "the printed energies where it describes the model."
)
NAMES = ("ratios", "in_time", "groups", "ranking")
RATIOS, IN_TIME, GROUPS, RANKING = (Table(f"emt_{name}", "verification.thesis.chapter4.page:read") for name in NAMES)
CLAIM_LEVEL = 0.99  # at which a claim is judged: so narrow a chance of error is for several comparisons of a claim
SHOWN = quantile(CLAIM_LEVEL) + quantile(2 * POWER - 1)  # standard deviations of an effect that is probably shown
ALIKE = 0.1  # ratios that differ by less are alike: the thesis prints tenths and calls its results qualitative
PERCENT = 100.0
KINDS = ("INM", "no INM")
EDGE = 1e-9  # rounding of the ends of intervals


class Sized(NamedTuple):
    """A comparison, and the independent cells or runs of each kind that would probably decide it; None: no number."""

    comparison: Comparison
    runs: int | None


Compared = Evidence | Sequence[Sized]


def in_readings(compare: Callable[[str], Compared], decides: str = OUTCOMES) -> Evidence:
    """Return the evidence of the reading that decides, with the evidence of all; ``compare`` is given the preset."""
    made = {preset: compare(preset) for preset in READINGS}
    found = {preset: each if isinstance(each, Evidence) else evidence(each) for preset, each in made.items()}
    return replace(found[decides], readings={name: found[preset] for preset, name in READINGS.items()})


def claim_in_readings(
    id: str, statement: str, decides: str = OUTCOMES, **details: Any
) -> Callable[[Callable[[Tables, str], Compared]], Claim]:
    """State a claim, as ``claim`` does, above a function of the tables and the preset of a reading."""

    def stated(compare: Callable[[Tables, str], Compared]) -> Claim:
        def check(tables: Tables) -> Evidence:
            return in_readings(lambda preset: compare(tables, preset), decides)

        line = f"{compare.__module__}:{compare.__code__.co_firstlineno}"
        return claim(id, statement, stated_at=line, **details)(check)

    return stated


def evidence(printed: Sequence[Sized], corrected: Sequence[Sized] = ()) -> Evidence:
    """Return comparisons as evidence, with the most runs that one of them needs."""
    wanted, instead = (tuple(each.comparison for each in side) for side in (printed, corrected))
    return Evidence("", wanted, instead, runs_needed=most_runs(each.runs for each in (*printed, *corrected)))


def ratio_of(tables: Tables, preset: str, study: str, scenario: str, what: str) -> Ratio:
    """Return the cells of a scenario with this outcome at the end of the runs."""
    table = tables[RATIOS]
    wanted = {"study": study + PRESETS[preset], "scenario": scenario, "what": what}
    (row,) = np.flatnonzero(np.logical_and.reduce([table[name] == value for name, value in wanted.items()]))
    return as_ratio(table.iloc[row])


def groups(tables: Tables, preset: str, given: str) -> pd.DataFrame:
    """Return the rows of the heterogeneous groups of a preset that are by this."""
    table = tables[GROUPS]
    mine = table[table["given"] == given]
    return mine[mine["study"].map(preset_of) == preset]


def category(tables: Tables, preset: str, study: str, *categories: str) -> Ratio:
    """Return the basally extruded ones among the cells of a mixed group with these events, in any of some orders."""
    rows = groups(tables, preset, BY_EVENTS).set_index(["study", "kind"])
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
    table = groups(tables, preset, given)
    return table[(table["study"] == study + PRESETS[preset]) & (table["kind"] == inm)].sort_values("low_edge")


def between(tables: Tables, preset: str, study: str, given: str, inm: str, low: float, high: float) -> Ratio:
    """Return basal extrusion of the cells of several such intervals together."""
    rows = bins(tables, preset, study, given, inm)
    inside = (rows["low_edge"] >= low - EDGE) & (rows["high_edge"] <= high + EDGE)
    return pooled([as_ratio(row) for _, row in rows[inside].iterrows()])


def pooled(ratios: Sequence[Ratio]) -> Ratio:
    """Return the ratio of several kinds of cells together."""
    return Ratio(sum(r.count for r in ratios), sum(r.of for r in ratios), sum(r.size for r in ratios))


def minus(sides: Iterable[Ratio]) -> ProportionContrast:
    """Return the first of two ratios of separate cells minus the second."""
    return difference(*sides)


def averaged(found: Sequence[ProportionContrast], weights: Sequence[float] | None = None) -> ProportionContrast:
    """Return the mean of differences of separate kinds of cells; by default each counts by n_1 n_2/(n_1 + n_2)."""
    sizes = [1 / sum(1 / one.size for one in each.ratios) for each in found] if weights is None else weights
    shares = [size / sum(sizes) for size in sizes]
    return ProportionContrast(
        tuple(share * w for share, each in zip(shares, found, strict=True) for w in each.weights),
        tuple(one for each in found for one in each.ratios),
    )


def more(what: str, found: ProportionContrast, least: float = 0.0) -> Sized:
    """Compare: the first ratio is larger than the second by ``least``."""
    return weighted(f"{what} [points]", found, least, math.inf)


def alike(what: str, found: ProportionContrast, margin: float = ALIKE) -> Sized:
    """Compare: two ratios differ by less than a margin."""
    return weighted(f"{what} [points]", found, -margin, margin)


def share(what: str, found: Ratio, low: float = -math.inf, high: float = math.inf) -> Sized:
    """Compare: a ratio is from ``low`` to ``high``."""
    return weighted(f"{what} [%]", ProportionContrast((1.0,), (found,)), low, high)


def weighted(what: str, found: ProportionContrast, low: float, high: float) -> Sized:
    """Compare: a weighted sum of ratios is from ``low`` to ``high``, parts of 1."""
    runs = (runs_for_bound(found, end) for end in (low, high) if math.isfinite(end))
    return Sized(_in_percent(what, found.value, found.interval(CLAIM_LEVEL), low, high), most_runs(runs))


def cells_of(found: ProportionContrast) -> float:
    """Return the independent cells of the side of a difference that has fewer."""
    sides = ([one.size for w, one in zip(found.weights, found.ratios, strict=True) if w * sign > 0] for sign in (1, -1))
    return min(sum(side) for side in sides if side)


def apart(what: str, first: Interval, second: Interval, cells: float = math.inf) -> Sized:
    """Compare: a number is larger than another one of the same cells, by intervals of both."""
    ends = (first[0] - second[1], first[1] - second[0])
    runs = runs_by_width(cells, sum(ends) / 2, ends) if math.isfinite(cells) else None
    return Sized(_in_percent(f"{what} [points]", sum(ends) / 2, ends, 0.0, math.inf), runs)


def counted(what: str, parts: Sequence[Comparison], least: int) -> Comparison:
    """Compare: at least so many of some comparisons hold; the interval ends with those that are not refuted."""
    held, refuted = (sum(part.true is truth for part in parts) for truth in (True, False))
    most = len(parts) - refuted
    return Comparison(f"{what}, of {len(parts)}", held, least, math.inf, (held, most))


def most_runs(sizes: Iterable[int | None]) -> int | None:
    """Return the largest of some numbers of runs; None stands for what no number of runs shows."""
    return max((size for size in sizes if size is not None), default=None)


def runs_for_bound(found: ProportionContrast, bound: float) -> int | None:
    """Return the independent cells of each kind that show a weighted sum of ratios to be above or below a bound.

    n = ((z + z_power)/(d - b))^2 sum w^2 p (1 - p) for the sum d and the bound b; None where no number shows it, as for
    d = b, or for ratios that are all 0 or 1.
    """
    variance = sum(w * w * one.value * (1 - one.value) for w, one in zip(found.weights, found.ratios, strict=True))
    if found.value == bound or variance == 0:
        return None
    return max(1, math.ceil(variance * (SHOWN / (found.value - bound)) ** 2))


def runs_by_width(cells: float, distance: float, interval: Interval) -> int | None:
    """Return the independent cells that show a number to be above or below a bound, by its interval from ``cells``.

    n = cells (h/d (z + z_power)/z)^2 for the distance d from the bound and the half-width h at ``CLAIM_LEVEL``; None
    for d = 0.
    """
    if distance == 0:
        return None
    half = (interval[1] - interval[0]) / 2
    return max(1, math.ceil(cells * (half / distance * SHOWN / quantile(CLAIM_LEVEL)) ** 2))


def _in_percent(what: str, value: float, interval: Interval, low: float, high: float) -> Comparison:
    low_end, high_end = interval
    return Comparison(what, PERCENT * value, PERCENT * low, PERCENT * high, (PERCENT * low_end, PERCENT * high_end))
