"""How fast N particles find their limit."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.rates import QUANTILES
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import figures, flow_rates, sampling
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.sections.words import listed, named

EXPONENTS = {
    "model": "Model",
    "d": "d",
    "start": "Start",
    "what": "Quantity",
    "from": "N from",
    "to": "to",
    "exponent": "Power of N",
    "low": "from",
    "high": "to ",
    "known": "Known",
    "agrees": "Known one within",
}
AT_START = {
    "d": "d",
    "start": "Start",
    "from": "N from",
    "to": "to",
    "exponent": "Power of N",
    "low": "from",
    "high": "to ",
    "known": "Known",
}
LAWS = {
    "d": "d",
    "law": "E W1",
    "a": "a",
    "a_half": "±",
    "b": "b",
    "b_half": "± ",
    "misfit": "χ² per degree of freedom",
    "largest": "Largest deviation",
}


def _run(context: Context) -> None:
    complete = flow_rates.study().complete(context.folder, context.executor) if context.full else None
    table = pd.read_parquet(flow_rates.FILE) if complete is None else complete
    context.keep("meanfield_flow", table)
    averages = flow_rates.averaged(table)
    context.keep("meanfield_flow_means", averages)
    context.keep("meanfield_flow_exponents", flow_rates.fitted(averages))
    means = sampling.means(pd.read_parquet(sampling.FILE))
    context.keep("meanfield_start_means", means)
    context.keep("meanfield_start_exponents", sampling.exponents(means))
    context.keep("meanfield_start_laws", sampling.laws(means))


def _section(context: Context) -> Section:
    tables = {name: context.tables[f"meanfield_{name}"] for name in ("flow_means", "flow_exponents", "start_exponents")}
    fitted = tables["flow_exponents"]
    fitted = fitted.assign(what=fitted["quantity"].map(flow_rates.QUANTITIES))
    shown = fitted.assign(agrees=fitted["agrees"].map({True: "yes", False: "no"}).where(fitted["known"].notna(), "—"))
    laws = context.tables["meanfield_start_laws"]
    picture = context.draw("meanfield_rates", figures.rates, tables["flow_means"])
    return Section(
        "How fast N particles find their limit",
        [
            Text(_at_start(tables["start_exponents"], laws)),
            Text(_through(fitted, tables["flow_means"])),
            Picture(picture, "Means with 95 % intervals, complete study: random starts (filled), quantiles (open)."),
            Grid(named(shown, EXPONENTS), "Fitted powers of N with 95 % intervals.", "meanfield_flow_exponents"),
            Grid(
                tables["start_exponents"][list(AT_START)].rename(columns=AT_START),
                "At t = 0, uniform law on the unit cube, complete study.",
                "meanfield_start_exponents",
            ),
            Grid(
                laws[list(LAWS)].rename(columns=LAWS),
                "Laws fitted to the means at t = 0.",
                "meanfield_start_laws",
                folded=True,
            ),
        ],
    )


def _at_start(exponents: pd.DataFrame, laws: pd.DataFrame) -> str:
    told = "; ".join(
        f"d = {row.d}, {row.start}: {row.exponent:.3f} [{row.low:.3f}, {row.high:.3f}], N to {row.to}"
        for row in exponents.itertuples()
    )
    fits = []
    for d, mine in laws.groupby("d"):
        plain, best = mine.iloc[0], mine.loc[mine["misfit"].idxmin()]
        better = "" if best["law"] == plain["law"] else f", {best['law']} with {number(best['misfit'])}"
        fits.append(f"d = {d}: {plain['law']} with χ² = {number(plain['misfit'])} per degree of freedom{better}")
    return (
        f"E W1 at t = 0 falls like N to the power: {told} (95 % intervals). Laws that fit: {'; '.join(fits)} (about 1 "
        "is as good as the data). In two dimensions the logarithm is needed (Ajtai, Komlós and Tusnády), and a bare "
        "power misses it; in three a part that falls faster is seen beside N^(−1/3). W1 there is that of two "
        "independent samples, between one and two times E W1 to the law."
    )


def _through(fitted: pd.DataFrame, means: pd.DataFrame) -> str:
    random = fitted[fitted["start"] != QUANTILES].set_index(["quantity", "model"])
    start, end, y = (random.loc[quantity] for quantity in flow_rates.QUANTITIES)
    powers = listed(
        [
            f"{TITLES[name]} {start['exponent'][name]:.2f}, {end['exponent'][name]:.2f} and {y['exponent'][name]:.2f}"
            for name in start.index
        ]
    )
    alike = (start["low"] <= end["exponent"]) & (end["exponent"] <= start["high"])
    quantiles = fitted[(fitted["start"] == QUANTILES) & (fitted["quantity"] != "start_w1")]
    told = listed([f"{TITLES[row.model]}, {row.what}: {row.exponent:.2f}" for row in quantiles.itertuples()])
    ratio = listed([f"{TITLES[name]} {number(value)}" for name, value in _kept(means).items()])
    return (
        f"Powers of N with random starts, of W1 at t = 0, of W1 at the end and of y: {powers}. The flow keeps the "
        f"rate: in {int(alike.sum())} of {len(alike)} models the power at the end is within the 95 % interval of that "
        f"at t = 0. y has the power −1/2 within its interval in {int(y['agrees'].sum())} of {len(y)}, in any "
        f"dimension: it is a mean over the particles. Quantile starts are far better, powers {told}: where the density "
        "vanishes at the ends of its support, 1/N is approached slowly, and y gains because its error is that of a "
        f"quadrature. W1 at the end over W1 at t = 0, at the largest N: {ratio}."
    )


def _kept(means: pd.DataFrame) -> dict[str, float]:
    """W1 at the end over W1 at the start for random starts, at the largest N of each model."""
    found = {}
    for name, mine in means[means["start"] != QUANTILES].groupby("model", sort=False):
        last = mine[mine["N"] == mine["N"].max()].set_index("quantity")["mean"]
        found[str(name)] = float(last["end_w1"] / last["start_w1"])
    return found


PART = Part(_run, _section)
