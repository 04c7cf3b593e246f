"""Are the intervals of ``tissue fit`` true? Coverage of 95 % intervals, and whether a wrong model is noticed.

The parameters mu in [0.03, 0.4] h and two_daughters in [0, 0.6] of published tissues are fitted to heights every 4 h
and the apical width at 48 h, with errors of 1 um, of tissues that were grown with parameters from these ranges.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.fitting.design import measure_runs
from tissue.fitting.plan import load_fit
from tissue.fitting.results import FitResults, fit
from tissue.kernels.lanes import WIDTH

NAME, FILE = "fit_coverage", Path(__file__).with_name("fit_coverage.toml")
NOISE = 1.0  # um, of a height or a width
OWN, HEIGHT, OTHERS = "height and width", "height alone", ("thesis", "gastrulation", "cuboidal")
SMALLEST = {"data": OWN, "points": 24, "fits": 8}
RUNS: tuple[Key, ...] = (
    *({"data": name, "points": 96, "fits": 208} for name in (OWN, HEIGHT)),
    *({"data": f"preset {name}, means of {WIDTH}", "points": 96, "fits": 16} for name in OTHERS),
    SMALLEST,
)
COLUMNS = {
    "data": "Data",
    "mu": "Damping [h]",
    "mu_low": "Lower end, 95 %",
    "mu_high": "Upper end, 95 %",
    "two_daughters": "Probability of two daughters",
    "two_daughters_low": "Lower end, 95 %",
    "two_daughters_high": "Upper end, 95 %",
    "p": "Misfit, p",
}


def study(smallest: bool = False) -> Study:
    """Fit tissues whose parameters are known, and tissues of other models; minutes of two cores."""
    keys = (SMALLEST,) if smallest else RUNS
    return Study(NAME, "Fits of known parameters", ("data", "points", "fits"), keys, fits, columns=COLUMNS, by=("fit",))


def fits(key: Key) -> list[Row]:
    """Return a row for each fit: the true parameters, the ends of their intervals, and p of the misfit.

    A tissue whose apical layer is folded at one of the times is left out.
    """
    results, rng, rows = designed(key["points"]), np.random.default_rng(5), []
    ranges, base = results.fit.ranges, results.fit.base
    of_other = key["data"].startswith("preset")
    runs, parts = key["fits"] * (WIDTH if of_other else 1), rng.random((key["fits"], len(ranges)))
    if of_other:
        keep = {name: base.as_dict()["numerics"][name] for name in ("t_end", "keep")}
        other = preset(key["data"].removeprefix("preset ").partition(",")[0])
        grown = [other.changed({f"numerics.{name}": value for name, value in keep.items()})] * runs
    else:
        grown = [results.fit.parameters(part) for part in parts]
    values = _values(results, grown).reshape(key["fits"], -1, len(results.fit.outputs))
    values = np.ma.masked_invalid(values).mean(axis=1).filled(np.nan)  # no height of a layer that is folded
    noise, shown = rng.normal(0.0, NOISE, values.shape), results.fit.data
    for number, (part, value) in enumerate(zip(parts, values + noise, strict=True)):
        if np.isnan(value).any():
            continue
        data = shown.assign(value=value, standard_error=NOISE)
        found = results.given(data[data["measure"] == "height_um"] if key["data"] == HEIGHT else data)
        if of_other:
            found = FitResults(replace(found.fit, tissues=WIDTH), found.runs)
        row: Row = {**key, "fit": number, "p": found.p_value()}
        for one, ends, true in zip(ranges, found.intervals().itertuples(), part, strict=True):
            name = one.key.partition(".")[2]
            row = {**row, name: None if of_other else float(one.value(true))}
            row = {**row, f"{name}_low": ends.low, f"{name}_high": ends.high}
        rows.append(row)
    return rows


@cache
def designed(points: int) -> FitResults:
    """Return the results of the design, made in a minute."""
    with TemporaryDirectory() as folder:
        return fit(replace(load_fit(FILE, values=False), points=points), folder)


def _values(results: FitResults, grown: list[Parameters]) -> np.ndarray:
    """Grow tissues with seeds of their own; return what is measured of each, (tissues, outputs)."""
    rows = []
    for begin in range(0, len(grown), WIDTH):
        some = grown[begin : begin + WIDTH]
        rows += measure_runs(some, range(10**6 + begin, 10**6 + begin + len(some)), results.fit)
    return np.array([[row[name] for name in results.fit.outputs] for row in rows])
