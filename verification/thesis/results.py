"""The page docs/explain/results.md, from the tables that ship: ``python -m verification.thesis.results`` writes it."""

from __future__ import annotations

from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

import pandas as pd

from dincl.files import write_text
from dincl.study import read_sealed
from verification.beyond.chart import cheapest, work_precision
from verification.beyond.chart.references import SCENES
from verification.claims import Verdict
from verification.instruments.error_norms import distance
from verification.page.kept import STUDIES
from verification.page.parts import number, number_up
from verification.page.prose import percent, percent_up, text_page
from verification.thesis.chapter2 import convergence, extrapolation, infeasibility, reference
from verification.thesis.chapter2.methods import CATCH_UP, PBD
from verification.thesis.chapter3 import beyond, daha, daha_ends, daha_fit, growth, substeps
from verification.thesis.chapter4 import kept
from verification.thesis.chapter4.frequencies import RULE
from verification.thesis.chapter4.printed import PRINTED_LEVEL
from verification.thesis.chapter4.studies import preset_of
from verification.thesis.chapter5 import agreement, cost, grid_order, sampling
from verification.thesis.register import register
from verification.thesis.text.errata import errata

MAKES_NO_NUMBERS = True
PAGE = Path(__file__).parents[2] / "docs" / "explain" / "results.md"
TEMPLATE = Path(__file__).with_name("results.md")
PROTRUDES, NO_INM = "[BP]", "[B] no INM"


def page() -> str:
    """Return the text of the page."""
    filters = {one.__name__: one for one in (percent, percent_up, signed, number, number_up)}
    known = {"claims": claims(), "emt": emt(), "w1": w1(), "chart": chart(), "discs": discs(), "tissue": tissue()}
    return text_page(TEMPLATE, filters, **known, meanfield=meanfield(), rule=RULE)


def claims() -> dict[str, Any]:
    """Count the claims by recorded verdict and by the effect of their corrections."""
    found = register()
    return {
        "all": len(found),
        "errata": len(errata()),
        "verdicts": Counter(claim.recorded.name for claim in found),
        "open": sum(claim.recorded is Verdict.OPEN for claim in found),
        "effects": Counter(claim.correction.effect.value for claim in found if claim.correction is not None),
    }


def emt() -> dict[str, Any]:
    """Return the results of the studies of chapter 4, from their kept tables."""
    printed, ratios, controls = kept.read("printed"), kept.read("ratios"), kept.read("controls")
    alone = ratios[ratios["study"].str.startswith("figure10") & (ratios["what"] == "basal")]
    effects = _main_effects(kept.read("effects"))
    within = printed.groupby(["preset", "time_h"])["agrees"].agg(["sum", "count"])
    apical = controls.assign(preset=controls["study"].map(preset_of)).groupby("preset")["apical"]
    return {
        "runs": int(controls["runs"].sum()),
        "level": PRINTED_LEVEL,
        "times": sorted(printed["time_h"].unique()),
        "within": {key: (int(row["sum"]), int(row["count"])) for key, row in within.iterrows()},
        "hardly": _only(ratios, scenario=NO_INM, what="basal", preset="thesis"),
        "printed": _only(printed, scenario=NO_INM, what="basal", preset="thesis")["printed"],
        "protruding": sorted(alone[alone["scenario"] == PROTRUDES]["value"]),
        "apical": {preset: (values.min(), values.max()) for preset, values in apical},
        "published": _precision(printed[printed["preset"] == "published"]),
        "effects": effects,
        "changed": _changed(printed, effects),
        "outside": kept.read("outside").set_index("preset").to_dict("index"),
        "ranking": {name: rows.head(3).to_dict("records") for name, rows in kept.read("ranking").groupby("preset")},
    }


def chart() -> dict[str, Any]:
    """Return the cheapest methods by the complete chart of speed against accuracy, and PBD beside them."""
    winners = cheapest.winners(_study("work_precision"), work_precision.FULL)
    beside = cheapest.against_pbd(winners)
    return {
        "wins": winners["cheapest"].value_counts().to_dict(),
        "pbd": PBD.label,
        "fine": cheapest.FINE,
        "coarse": cheapest.COARSE,
        "beside": beside.assign(title=[SCENES[scene]().title for scene in beside["scene"]]).to_dict("records"),
        "wide": cheapest.wide(winners),
    }


def w1() -> dict[str, Any]:
    """Return the decay of E W1 of random starts with N, from the kept distances."""
    means = sampling.means(read_sealed(sampling.FILE))
    exponents, laws = sampling.exponents(means), sampling.laws(means)
    return {
        "line": exponents[exponents["d"] == 1].iloc[0],
        "plane": laws[laws["law"].str.startswith("((a")].iloc[0],
        "space": laws[laws["law"].str.contains(" \\+ b N")].iloc[0],
        "largest": int(exponents["to"].max()),
    }


@cache
def discs() -> dict[str, Any]:
    """Return the errors of the reference, the orders and errors of PBD, and its overlap beside the penalty method."""
    table, solved, runs = _study("convergence"), _study("reference"), _study("catch_up")
    apart = []
    for scene in convergence.SCENES:
        known, checked = reference.reference(solved, scene), extrapolation.extrapolated(runs, scene)
        apart.append(distance(known.x, checked.x).max())
    orders = convergence.orders(table)
    errors = table.pivot_table(index=["scene", "t", "dt"], columns="method", values="error")
    times = (errors[PBD.name] / errors[CATCH_UP.name]).dropna()
    best = infeasibility.best_strengths(_study("penalty_scan"))
    slide, fall = convergence.SCENES
    return {
        "stated": table["reference_error"].max(),
        "contacts": [solved.loc[solved["scene"] == scene, "events"].max() for scene in convergence.SCENES],
        "exact": _study("exactness")["true"].max(),
        "catch_up": max(apart),
        "orders": _range(orders.loc[orders["method"] == PBD.name, "slope"]),
        "slide": _range(times[slide]),
        "fall": _range(times[fall].drop(index=times[fall].index.levels[0].max(), level="t")),
        "penalty": _range(best["largest"] / best["pbd_largest"]),
    }


@cache
def tissue() -> dict[str, Any]:
    """Return the limits, substeps and dampings of the growing tissue, and DAHA beside PBD."""
    runs, swings = _study("tissue_daha"), beyond.summary(_study("tissue_jitter"))
    ends = _study("tissue_daha_ends")
    enough = substeps.enough(substeps.heights(_study("tissue_substeps")))
    doubled = growth.doubling(_study("tissue_growth")).groupby("preset")
    kernel = _study("tissue_kernel")
    compared = runs[runs["case"] == daha.TERMINATING]
    fits = daha_fit.fitted(compared)
    return {
        "beyond": _only(swings, preset="thesis", substeps=min(daha.PBD_SUBSTEPS)),
        "enough": enough[enough["t"] == enough["t"].max()].set_index("preset")["substeps"],
        "right": substeps.ENOUGH,
        "end": enough["t"].max(),
        "ends": daha_ends.shares(ends).set_index("reading").to_dict("index"),
        "stopped": ends.loc[(ends["reading"] == "published program") & ~ends["ended"].astype(bool), "seed"].tolist(),
        "speed": _only(daha.speed(compared)),
        "fit": _only(fits, t=fits["t"].max(), substeps=min(daha.PBD_SUBSTEPS)),
        "doubled": {preset: rows.to_dict("records") for preset, rows in doubled},
        "cells": kernel["cells"].min(),
        "substep": _range(kernel.loc[kernel["cells"] == kernel["cells"].min(), "us_best"]),
    }


@cache
def meanfield() -> dict[str, Any]:
    """Return how the solvers of particles agree, the measured orders and the costs."""
    runs, grids = _study("meanfield_agreement"), grid_order.orders(_study("meanfield_grid"))
    best = agreement.best(runs).groupby("method")["worst"].max()
    orders = agreement.orders(runs).groupby("nominal")["slope"]
    fine = agreement.CLAIMED
    seconds = cost.seconds_to(_study("meanfield_cost"), (fine,)).groupby("method")[f"{fine:g}"]
    side = _study("meanfield_side").set_index("model")
    return {
        "models": runs["model"].nunique(),
        "best": best,
        "orders": {nominal: _range(slopes) for nominal, slopes in orders},
        "smooth": _range(grids.loc[grids["smooth"], "slope_error_f"]),
        "jump": _only(grids[~grids["smooth"]])["slope_error_f"],
        "mass": grids["mass"].max(),
        "least": grids["least"].min(),
        "fine": fine,
        "seconds": {method: _range(times) for method, times in seconds},
        "particles": int(side["N"].max()),
        "passes": _range(side["reading"].drop("interacting")),
    }


def _study(name: str) -> pd.DataFrame:
    """Return the table of a complete study."""
    return read_sealed(STUDIES / f"{name}.parquet")


def _range(values: pd.Series) -> tuple[float, float]:
    return values.min(), values.max()


def signed(value: float, digits: int = 3) -> str:
    """Format a number with so many digits behind the point."""
    return f"{value:.{digits}f}"


def _only(table: pd.DataFrame, **wanted: object) -> pd.Series:
    """Return the first row with these values; ratios have the preset in the name of the study."""
    rows = table.assign(preset=table["study"].map(preset_of)) if "study" in table else table
    for name, value in wanted.items():
        rows = rows[rows[name] == value]
    return rows.iloc[0]


def _precision(printed: pd.DataFrame) -> dict[str, Any]:
    """Return the runs behind each ratio, and how far the intervals of the differences from print reach to a side."""
    sides = pd.concat([printed["high"] - printed["difference"], printed["difference"] - printed["low"]])
    return {"runs": int(printed["runs"].min()), "reach": sides.max()}


def _changed(printed: pd.DataFrame, effects: dict[str, list[dict[str, Any]]]) -> dict[str, Any]:
    """Return the change of a ratio from print to publication by time, beside the sum of its two largest effects."""
    name, mine = f"{NO_INM} basal", printed[(printed["scenario"] == NO_INM) & (printed["what"] == "basal")]
    before = _only(mine, preset="thesis")["measured"]
    after = mine[mine["preset"] == "published"].set_index("time_h")["measured"]
    return {"ratio": name, "effects": sum(one["effect"] for one in effects[name][:2]), "by": dict(after - before)}


def _main_effects(effects: pd.DataFrame) -> dict[str, list[dict[str, Any]]]:
    """Return, for each printed ratio, the rows that change it, by their intervals; the largest effect first."""
    main = effects[(effects["with"] == "") & (effects["low"] * effects["high"] > 0)]
    main = main.sort_values("effect", key=abs, ascending=False)
    groups = main.groupby(["scenario", "what"])
    return {f"{scenario} {what}": mine.to_dict("records") for (scenario, what), mine in groups}


if __name__ == "__main__":
    write_text(PAGE, page())
