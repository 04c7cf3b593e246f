"""DAHA against PBD: iterations, termination, the damping that fits, limits of DAHA."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3 import daha, daha_ends, daha_fit, daha_limits, figures_daha
from verification.thesis.chapter3.sections.part import COLUMNS, PROSE, Part, named

# What the thesis states: median iterations, share of runs that fail, distance at mu = 0.14, time ratio.
PRINTED = {"median": 7500, "share": 0.25, "distance": 0.06, "ratio": 300}

# Made again beside the complete study: two runs, and a line of each map.
AGAIN = daha.DahaForm({(daha.TERMINATING, daha.OWN): 1, (daha.PRINTED, daha.OWN): 1}, (daha.COMPARED,))
LINE = {"method": "0", "y": 1.0}


def _run(context: Context) -> None:
    form = context.form(daha.FULL)
    table = context.rows_of(daha.study(form), daha.study(AGAIN), ("kind", "t", "mu", "substeps"))
    context.tables["tissue_daha"] = table
    context.keep("tissue_daha_iterations", daha.iterations(table))
    context.keep("tissue_daha_failures", daha.failures(table))
    context.keep("tissue_daha_distances", daha.distances(table))
    context.keep("tissue_daha_speed", daha.speed(table, form.end))
    context.keep("tissue_daha_fits", daha_fit.fitted(table))
    ends = daha_ends.study(context.form(daha_ends.FULL))
    again = ends.only(lambda key: key["seed"] == 0)
    context.keep("tissue_daha_shares", daha_ends.shares(context.rows_of(ends, again)))
    maps = {}
    for plane in context.form(daha_limits.FORM).planes:
        study = daha_limits.study(plane)
        maps[plane.name] = context.rows_of(study, study.only(lambda key: key == LINE))
    for name, rows in maps.items():
        context.tables[f"tissue_daha_{name}"] = rows
    context.keep("tissue_daha_held", daha_limits.held(maps))


def _daha(context: Context) -> Section:
    names = ("iterations", "failures", "shares", "distances", "speed", "fits", "held")
    made, failed, shares, apart, speed, fits, held = (context.tables[f"tissue_daha_{name}"] for name in names)
    maps = {plane.name: context.tables[f"tissue_daha_{plane.name}"] for plane in daha_limits.PLANES}
    table = context.tables["tissue_daha"]
    counts = context.draw("tissue_daha_iterations", figures_daha.iterations, table, daha.PRINTED)
    fitted = context.draw("tissue_daha_damping", figures_daha.damping, apart, fits)
    limits = context.draw("tissue_daha_limits", figures_daha.limits, maps)
    said = fill(
        PROSE / "daha.html",
        printed=PRINTED,
        end=daha.END,
        limit=daha_limits.limit(),
        compared=daha.COMPARED,
        speed=speed[speed["case"] == daha.TERMINATING].iloc[0].to_dict(),
        shares=shares.to_dict("records"),
        **_termination(made, failed),
        **_damping(made, fits),
        **_distance(apart),
        **_limits(held, maps),
    )
    return Section(
        "Do DAHA and PBD grow the same tissue?",
        [
            Text(said["termination"]),
            Picture(counts, said["iterations"]),
            Grid(named(made, COLUMNS["daha_iterations"]), said["made"], "tissue_daha_iterations"),
            Grid(named(failed, COLUMNS["daha_failures"]), said["failures"], "tissue_daha_failures"),
            Text(said["fourth"]),
            Grid(named(shares, COLUMNS["daha_shares"]), said["shares"], "tissue_daha_shares"),
            Text(said["damping"]),
            Text(said["distance"]),
            Picture(fitted, said["fitted"]),
            Grid(named(fits, COLUMNS["daha_fits"]), said["fits"], "tissue_daha_fits"),
            Text(said["speed"]),
            Grid(named(speed, COLUMNS["daha_speed"]), said["runs"], "tissue_daha_speed"),
            Text(said["limits"]),
            Picture(limits, said["maps"]),
            Grid(named(held, COLUMNS["daha_held"]), said["held"], "tissue_daha_held"),
            Grid(named(apart, COLUMNS["daha_distances"]), said["distances"], "tissue_daha_distances", folded=True),
            Follows(said["follows"]),
        ],
    )


def _one(table: pd.DataFrame, case: str, eps: float = daha.OWN) -> dict[str, Any]:
    """Return the row of a case at a tolerance."""
    row: dict[str, Any] = table[(table["case"] == case) & (table["eps"] == eps)].iloc[0].to_dict()
    return row


def _termination(made: pd.DataFrame, failed: pd.DataFrame) -> dict[str, Any]:
    return {
        "steps": _one(made, daha.PRINTED),
        "printed_runs": _one(failed, daha.PRINTED),
        "floored_steps": _one(made, daha.TERMINATING),
        "floored_runs": _one(failed, daha.TERMINATING),
        "tight": _one(failed, daha.PRINTED, min(daha.TOLERANCES)),
        "most": daha.parameters_of(daha.PRINTED, daha.OWN).daha_numbers().most_iterations,
    }


def _damping(made: pd.DataFrame, fits: pd.DataFrame) -> dict[str, Any]:
    """Return the fits at the end with the alpha of Table 4 and with twice that, and which is nearer to the thesis."""
    own, doubled = (_fit(made, fits, case) for case in (daha.TERMINATING, daha.DOUBLED_CASE))
    off = [abs(fit["median"] - PRINTED["median"]) for fit in (own, doubled)]
    apart = [abs(np.log(fit["mu"] / daha.COMPARED)) for fit in (own, doubled)]
    return {
        "fit_end": fits["t"].max(),
        "fitted": [own, doubled],
        "fits_doubled": apart[1] < apart[0],
        "nearer_doubled": not off[0] <= off[1],
    }


def _fit(made: pd.DataFrame, fits: pd.DataFrame, case: str) -> dict[str, Any]:
    """Return the fit at the end, PBD with the substeps of the preset, beside the iterations that it took DAHA."""
    mine = fits[(fits["case"] == case) & (fits["t"] == fits["t"].max())].sort_values("substeps")
    fit: dict[str, Any] = mine.iloc[0].to_dict()
    steps = _one(made, case)
    return fit | {
        "doubled": case == daha.DOUBLED_CASE,
        "alpha": daha.parameters_of(case, daha.OWN).daha_numbers().alpha,
        "half": steps["half"],
        "median": steps["median"],
    }


def _distance(apart: pd.DataFrame) -> dict[str, Any]:
    last = apart[apart["t"] == apart["t"].max()]
    few, many = daha.PBD_SUBSTEPS
    own = last[last["case"] == daha.TERMINATING]
    itself, noise = (own[own["kind"] == kind].iloc[0].to_dict() for kind in ("pbd with itself", "other noise"))
    return {
        "apart_end": apart["t"].max(),
        "apart": [_compared(last, case) for case in (daha.TERMINATING, daha.DOUBLED_CASE)],
        "table_5": own[(own["mu"] == daha.TABLE_5) & (own["substeps"] == few)].iloc[0].to_dict(),
        "few": few,
        "many": many,
        "itself": itself,
        "other_noise": noise,
    }


def _compared(last: pd.DataFrame, case: str) -> dict[str, Any]:
    """Return PBD with the damping of the thesis, and with the one that comes nearest."""
    mine = last[(last["case"] == case) & (last["kind"] == "pbd") & (last["substeps"] == min(daha.PBD_SUBSTEPS))]
    return {
        "doubled": case == daha.DOUBLED_CASE,
        "at": mine[mine["mu"] == daha.COMPARED].iloc[0].to_dict(),
        "least": mine.loc[mine["relative"].idxmin()].to_dict(),
    }


def _limits(held: pd.DataFrame, maps: dict[str, pd.DataFrame]) -> dict[str, Any]:
    first = held[held["seed"] == held["seed"].min()]
    beyond = maps["descent"][maps["descent"]["x"] > maps["descent"]["limit"]]
    return {
        "held": first.to_dict("records"),
        "alpha": first[first["parameter"] == "alpha"].iloc[0].to_dict(),
        "broken": int(beyond["outcome"].isin(daha_limits.OUTCOMES[2:]).sum()),
        "beyond": len(beyond),
        "seen": daha_limits.SEEN,
        "most_of_maps": daha_limits.MOST,
    }


PART = Part(_run, _daha)
