"""Section on the rates at which N particles find their limit."""

from __future__ import annotations

from typing import Any

import pandas as pd

from dincl.study import read_sealed
from verification.instruments.rates import QUANTILES
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import figures, flow_rates, sampling
from verification.thesis.chapter5.sections.words import COLUMNS, PROSE, named

TITLE = "How fast do N particles find their limit?"


def _run(context: Context) -> None:
    complete = flow_rates.study().complete(context.folder, context.executor) if context.full else None
    table = read_sealed(flow_rates.FILE) if complete is None else complete
    context.keep("meanfield_flow", table)
    averages = flow_rates.averaged(table)
    context.keep("meanfield_flow_means", averages)
    context.keep("meanfield_flow_exponents", flow_rates.fitted(averages))
    means = sampling.means(read_sealed(sampling.FILE))
    context.keep("meanfield_start_means", means)
    context.keep("meanfield_start_exponents", sampling.exponents(means))
    context.keep("meanfield_start_laws", sampling.laws(means))


def _section(context: Context) -> Section:
    tables = {name: context.tables[f"meanfield_{name}"] for name in ("flow_means", "flow_exponents", "start_exponents")}
    fitted = tables["flow_exponents"]
    fitted = fitted.assign(what=fitted["quantity"].map(flow_rates.QUANTITIES))
    shown = fitted.assign(agrees=fitted["agrees"].map({True: "yes", False: "no"}).where(fitted["known"].notna(), "—"))
    laws = context.tables["meanfield_start_laws"]
    at_start = named(tables["start_exponents"], COLUMNS["start_exponents"])
    picture = context.draw("meanfield_rates", figures.rates, tables["flow_means"])
    said = fill(
        PROSE / "rates.html",
        fits=_fits(laws),
        **_through(fitted, tables["flow_means"]),
    )
    return Section(
        TITLE,
        [
            Text(said["start"]),
            Text(said["flow"]),
            Picture(picture, said["picture"]),
            Grid(named(shown, COLUMNS["flow_exponents"]), said["exponents"], "meanfield_flow_exponents"),
            Grid(at_start, said["at_start"], "meanfield_start_exponents"),
            Grid(named(laws, COLUMNS["start_laws"]), said["laws"], "meanfield_start_laws", folded=True),
            Follows(said["follows"]),
        ],
    )


def _fits(laws: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the bare power for each dimension, and the law that fits best where it is another one."""
    fits = []
    for d, mine in laws.groupby("d"):
        plain, best = mine.iloc[0], mine.loc[mine["misfit"].idxmin()]
        fits.append({"d": d, "plain": plain, "better": None if best["law"] == plain["law"] else best})
    return fits


def _through(fitted: pd.DataFrame, means: pd.DataFrame) -> dict[str, Any]:
    random = fitted[fitted["start"] != QUANTILES].set_index(["quantity", "model"])
    start, end, y = (random.loc[quantity] for quantity in flow_rates.QUANTITIES)
    alike = (start["low"] <= end["exponent"]) & (end["exponent"] <= start["high"])
    quantiles = fitted[(fitted["start"] == QUANTILES) & (fitted["quantity"] != "start_w1")]
    return {
        "alike": int(alike.sum()),
        "models": len(alike),
        "halves": int(y["agrees"].sum()),
        "quantiles": list(quantiles.itertuples()),
        "ratios": list(_kept(means).items()),
    }


def _kept(means: pd.DataFrame) -> dict[str, float]:
    """Return W1 at the end over W1 at the start for random starts, at the largest N of each model."""
    found = {}
    for name, mine in means[means["start"] != QUANTILES].groupby("model", sort=False):
        last = mine[mine["N"] == mine["N"].max()].set_index("quantity")["mean"]
        found[str(name)] = float(last["end_w1"] / last["start_w1"])
    return found


PART = Part(_run, _section)
