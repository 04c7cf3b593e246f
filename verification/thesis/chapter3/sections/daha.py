"""DAHA against PBD: iterations, termination, the damping that fits, and where DAHA breaks."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import numpy as np
import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3 import daha, daha_fit, daha_limits, figures_daha
from verification.thesis.chapter3.sections.part import Part, named

CASE = {"case": "Thesis preset", "eps": "ε"}
ITERATIONS = CASE | {
    "low": "Lower quartile",
    "median": "Median iterations",
    "high": "Upper quartile",
    "whole": "Δt/(n α) [h], (3.32)",
    "half": "2Δt/(n α) [h]",
    "violation": "Largest violation [R_soft]",
}
FAILURES = CASE | {
    "runs": "Runs",
    "failed": "Not terminated",
    "share": "Share",
    "low": "from",
    "high": "to",
    "first": "First at [h]",
    "last": "Last at [h]",
    "stiffness": "Δτ² α λ_max of a cell there, median",
}
FITS = {
    "case": "Thesis preset",
    "t": "t [h]",
    "substeps": "Substeps",
    "mu": "μ nearest in nuclei [h]",
    "mu_low": "from",
    "mu_high": "to",
    "least": "Least distance",
    "equal": "μ of equal height [h]",
    "equal_low": " from",
    "equal_high": " to",
    "runs": "Runs",
}
DISTANCES = {
    "case": "Thesis preset",
    "kind": "Against DAHA",
    "t": "t [h]",
    "mu": "μ [h]",
    "substeps": "Substeps",
    "relative": "Distance of nuclei, relative",
    "low": "from",
    "high": "to",
    "rms": "[R_soft]",
    "height": "Height off by the part",
    "height_low": " from",
    "height_high": " to",
    "width": "Width off by the part",
    "width_low": "  from",
    "width_high": "  to",
    "runs": "Runs",
}
SPEED = {
    "case": "Thesis preset",
    "daha": "DAHA [s]",
    "pbd": "PBD [s]",
    "ratio": "Ratio",
    "low": "from",
    "high": "to",
    "work": "Iterations / substeps",
}
HELD = {
    "parameter": "Parameter",
    "seed": "Seed",
    "from": "Ends well from factor",
    "to": "to",
    "below": "Below",
    "above": "Above",
    "limit": "Linear limit of the factor",
}
# What the thesis states: median iterations, share of runs that fail, distance at mu = 0.14, time ratio.
PRINTED_MEDIAN, PRINTED_SHARE, PRINTED_DISTANCE, PRINTED_RATIO = 7500, 0.25, 0.06, 300


def _run(context: Context) -> None:
    form = context.form(daha.SHORT, daha.FULL)
    table = daha.study(form).complete(context.folder, context.executor)
    context.tables["tissue_daha"] = table
    context.keep("tissue_daha_iterations", daha.iterations(table))
    context.keep("tissue_daha_failures", daha.failures(table))
    context.keep("tissue_daha_distances", daha.distances(table))
    context.keep("tissue_daha_speed", daha.speed(table, form.end))
    context.keep("tissue_daha_fits", daha_fit.fitted(table))
    mapped = context.form(daha_limits.SHORT, daha_limits.FULL)
    maps = {
        plane.name: daha_limits.study(plane, mapped.full).complete(context.folder, context.executor)
        for plane in mapped.planes
    }
    for name, rows in maps.items():
        context.tables[f"tissue_daha_{name}"] = rows
    context.keep("tissue_daha_held", daha_limits.held(maps))


def _daha(context: Context) -> Section:
    names = ("iterations", "failures", "distances", "speed", "fits", "held")
    made, failed, apart, speed, fits, held = (context.tables[f"tissue_daha_{name}"] for name in names)
    maps = {plane.name: context.tables[f"tissue_daha_{plane.name}"] for plane in daha_limits.PLANES}
    table = context.tables["tissue_daha"]
    counts = context.draw("tissue_daha_iterations", figures_daha.iterations, table, daha.PRINTED)
    fitted = context.draw("tissue_daha_damping", figures_daha.damping, apart, fits)
    limits = context.draw("tissue_daha_limits", figures_daha.limits, maps)
    return Section(
        "DAHA against PBD",
        [
            Text(_termination(made, failed)),
            Picture(counts, "Iterations of DAHA in each step, thesis preset as printed (Figure 11)."),
            Grid(named(made, ITERATIONS), "Iterations of the steps that terminated.", "tissue_daha_iterations"),
            Grid(named(failed, FAILURES), "Runs of 10 h, Wilson's 95 % intervals.", "tissue_daha_failures"),
            Text(_damping(made, fits)),
            Text(_distance(apart, fits)),
            Picture(
                fitted,
                "PBD with 20 substeps against DAHA at 10 h, same seed, rest lengths ≥ 0: means over the seeds with 95 "
                "% intervals; dashed: the μ that fits best.",
            ),
            Grid(named(fits, FITS), "The damping that fits best, 95 % intervals.", "tissue_daha_fits"),
            Text(_speed(speed)),
            Grid(named(speed, SPEED), "Whole runs of 10 h on one core.", "tissue_daha_speed"),
            Text(_limits(held, maps)),
            Picture(
                limits,
                "One step of a tissue, other parameters as in Table 4. Violated: terminated with a violation above "
                f"{daha_limits.SEEN:g} R_soft; not terminated: in {daha_limits.MOST:,} iterations.",
            ),
            Grid(named(held, HELD), "Around Table 4, one parameter at a time.", "tissue_daha_held"),
            Grid(named(apart, DISTANCES), "All distances", "tissue_daha_distances", folded=True),
        ],
    )


def _one(table: pd.DataFrame, case: str, eps: float = daha.OWN) -> pd.Series:
    """The row of a case at a tolerance."""
    return table[(table["case"] == case) & (table["eps"] == eps)].iloc[0]


def _termination(made: pd.DataFrame, failed: pd.DataFrame) -> str:
    steps, runs = _one(made, daha.PRINTED), _one(failed, daha.PRINTED)
    other, floored = _one(made, daha.TERMINATING), _one(failed, daha.TERMINATING)
    agrees = "is in" if runs["low"] <= PRINTED_SHARE <= runs["high"] else "is not in"
    tight = failed[(failed["case"] == daha.PRINTED) & (failed["eps"] == min(daha.TOLERANCES))].iloc[0]
    return (
        f"With Table 4 a step takes {steps['median']:.0f} iterations (median; quartiles {steps['low']:.0f} and "
        f"{steps['high']:.0f}); the thesis has {PRINTED_MEDIAN}. {runs['failed']} of {runs['runs']} runs of "
        f"{daha.END:g} h do not terminate in the {_most():,} iterations of a step: {_percent(runs)}; the thesis has "
        f"one in four, which {agrees} this interval. They fail between {_hours(runs)}. With ε = {tight['eps']:.0e} "
        f"{tight['failed']} of {tight['runs']} fail"
        + (f", the first at {number(tight['first'])} h. " if tight["failed"] else ". ")
        + (_where_failed(runs) if runs["failed"] else "")
        + "With desired rest lengths ≥ 0, as in the published "
        f"runs, {floored['failed']} of {floored['runs']} fail, {_percent(floored)}, with a median of "
        f"{other['median']:.0f} iterations: the comparisons at 10 h are made with this rule, by PBD as well."
    )


def _where_failed(runs: pd.Series) -> str:
    return (
        "Rest lengths follow nuclei that come near an end of the cell, and bending grows stiffer without bound: where "
        f"runs fail, Δτ² α times the largest eigenvalue of D²W of a single cell is {runs['stiffness']:.3f} (median), "
        f"and {daha_limits.limit():g} is the limit of the iteration. "
    )


def _most() -> int:
    return daha.parameters_of(daha.PRINTED, daha.OWN).daha_numbers().most_iterations


def _percent(row: pd.Series) -> str:
    return f"{100 * row['share']:.0f} % [{100 * row['low']:.0f}, {100 * row['high']:.0f}]"


def _hours(row: pd.Series) -> str:
    return "no time" if np.isnan(row["first"]) else f"{number(row['first'])} and {number(row['last'])} h"


def _fit(fits: pd.DataFrame, case: str) -> pd.Series:
    """The fit at the end, PBD with the substeps of the preset."""
    mine = fits[(fits["case"] == case) & (fits["t"] == fits["t"].max())]
    return mine.sort_values("substeps").iloc[0]


def _damping(made: pd.DataFrame, fits: pd.DataFrame) -> str:
    parts = []
    for case, words in ((daha.TERMINATING, "α as in Table 4"), (daha.DOUBLED_CASE, "α and γ doubled")):
        fit, steps = _fit(fits, case), _one(made, case)
        alpha = daha.parameters_of(case, daha.OWN).daha_numbers().alpha
        parts.append(
            f"{words} (α = {alpha:.0e}): 2Δt/(n α) = {number(steps['half'])} h, nuclei nearest at μ = "
            f"{number(fit['mu'])} [{number(fit['mu_low'])}, {number(fit['mu_high'])}] h, equal height at "
            f"{number(fit['equal'])} [{number(fit['equal_low'])}, {number(fit['equal_high'])}] h"
        )
    own, doubled = (_fit(fits, case) for case in (daha.TERMINATING, daha.DOUBLED_CASE))
    nearer = [abs(np.log(fit["mu"] / daha.COMPARED)) for fit in (own, doubled)]
    told = "that is doubled" if nearer[1] < nearer[0] else "of Table 4"
    median = _one(made, daha.TERMINATING)["median"], _one(made, daha.DOUBLED_CASE)["median"]
    return (
        "(3.32) has μ = Δt/(n α), but (3.26) leaves out a factor: by (3.25) a step is α/2, so μ = 2Δt/(n α). Without "
        f"the factor Table 4 would have to be read with α and γ doubled. At {fits['t'].max():g} h: {'; '.join(parts)}. "
        f"The μ = {daha.COMPARED:g} of the thesis fits the α {told}; its {PRINTED_MEDIAN} iterations are "
        f"nearer to those of {_nearest(median)} ({median[0]:.0f}, doubled {median[1]:.0f})."
    )


def _nearest(medians: tuple[float, float]) -> str:
    off = [abs(median - PRINTED_MEDIAN) for median in medians]
    return "Table 4" if off[0] <= off[1] else "the doubled α"


def _distance(apart: pd.DataFrame, fits: pd.DataFrame) -> str:
    last = apart[apart["t"] == apart["t"].max()]
    parts = []
    for case, words in ((daha.TERMINATING, "Table 4"), (daha.DOUBLED_CASE, "α doubled")):
        mine = last[last["case"] == case]
        pbd = mine[(mine["kind"] == "pbd") & (mine["substeps"] == min(daha.PBD_SUBSTEPS))]
        at = pbd[pbd["mu"] == daha.COMPARED].iloc[0]
        least = pbd.loc[pbd["relative"].idxmin()]
        parts.append(
            f"{words}: {_part(at)} at μ = {daha.COMPARED:g} with heights {_tall(at)}, least at μ = {least['mu']:g}, "
            f"{_part(least)} with heights {_tall(least)}"
        )
    yard = {
        kind: _part(last[(last["case"] == daha.TERMINATING) & (last["kind"] == kind)].iloc[0])
        for kind in ("pbd with itself", "other noise")
    }
    few, many = daha.PBD_SUBSTEPS
    table_5 = last[(last["case"] == daha.TERMINATING) & (last["mu"] == daha.TABLE_5) & (last["substeps"] == few)]
    return (
        f"Relative distance of nuclei |X<sub>DAHA</sub> − X<sub>PBD</sub>|/|X<sub>DAHA</sub>| at {apart['t'].max():g} "
        f"h (the thesis: {100 * PRINTED_DISTANCE:g} % at μ = {daha.COMPARED:g}): {'; '.join(parts)}; with the μ = "
        f"{daha.TABLE_5:g} of Table 5 heights are off by {_tall(table_5.iloc[0])} (α of Table 4). To see what this "
        f"means: PBD with {few} and with {many} substeps, μ = {daha.COMPARED:g}, is {yard['pbd with itself']} from "
        f"itself, and PBD that meets other noise is {yard['other noise']} from DAHA."
    )


def _part(row: pd.Series) -> str:
    return f"{100 * row['relative']:.1f} % [{100 * row['low']:.1f}, {100 * row['high']:.1f}]"


def _tall(row: pd.Series) -> str:
    return f"{100 * row['height']:+.1f} % [{100 * row['height_low']:+.1f}, {100 * row['height_high']:+.1f}]"


def _speed(speed: pd.DataFrame) -> str:
    mine = speed[speed["case"] == daha.TERMINATING].iloc[0]
    return (
        f"A run of {daha.END:g} h takes DAHA {number(mine['daha'])} s and PBD {number(1e3 * mine['pbd'])} ms, both "
        f"compiled, on one core: {mine['ratio']:.0f} [{mine['low']:.0f}, {mine['high']:.0f}] times as long, for "
        f"{mine['work']:.0f} times as many iterations as substeps; the thesis has {PRINTED_RATIO}."
    )


def _limits(held: pd.DataFrame, maps: dict[str, pd.DataFrame]) -> str:
    first = held[held["seed"] == held["seed"].min()]
    told = "; ".join(
        f"{row.parameter}: {number(row[3])} to {number(row[4])} (below: {row.below}, above: {row.above})"
        for row in first[["seed", "parameter", "from", "to", "below", "above"]]
        .rename(columns={"from": "least", "to": "most"})
        .itertuples()
    )
    alpha = first[first["parameter"] == "alpha"].iloc[0]
    beyond = maps["descent"][maps["descent"]["x"] > maps["descent"]["limit"]]
    broken = int(beyond["outcome"].isin(daha_limits.OUTCOMES[2:]).sum())
    return (
        f"Factors of Table 4 with which one step ends well: {told}. The part of the gradient is stable while Δτ² α "
        f"λ_max(D²W) < {daha_limits.limit():g}, whatever c is: up to {number(alpha['limit'])} times the α of Table 4; "
        f"{broken} of {len(beyond)} steps beyond it do not terminate. A small α does terminate, for the rule looks at "
        "the last move only: it stops early, with the overlaps that the noise left."
    )


PART = Part(_run, _daha)
