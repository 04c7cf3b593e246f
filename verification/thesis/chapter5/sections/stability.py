"""The constant of the stability estimate."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import pandas as pd

from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3.sections.part import Part
from verification.thesis.chapter5 import figures, stability_constant
from verification.thesis.chapter5.cases import TITLES
from verification.thesis.chapter5.sections.words import listed, named

SUMMARY = {
    "model": "Model",
    "pairs": "Pairs",
    "largest": "Largest D(t)/D(0)",
    "at": "at t",
    "kind": "of pairs that differ in",
    "rate": "Growth rate",
    "low": "from",
    "high": "to",
    "needed": "Least L that holds, C = 1",
    "bound": "L of the proof",
    "held": "Bound holds",
}


def _run(context: Context) -> None:
    table = stability_constant.study(context.full).complete(context.folder, context.executor)
    context.tables["meanfield_stability"] = table
    context.keep("meanfield_stability_summary", stability_constant.summary(table))
    context.keep("meanfield_stability_envelopes", stability_constant.envelopes(table))
    context.keep("meanfield_stability_laws", stability_constant.counterexample())


def _section(context: Context) -> Section:
    summary, envelopes, laws = (
        context.tables[f"meanfield_stability_{name}"] for name in ("summary", "envelopes", "laws")
    )
    picture = context.draw("meanfield_stability", figures.stability, envelopes, summary)
    shown = summary.assign(kind=summary["kind"].map(stability_constant.KINDS))
    return Section(
        "The constant of the stability estimate (5.60)",
        [
            Text(_words(summary)),
            Text(_printed(laws)),
            Picture(picture, "D = |y1 − y2| + |v1 − v2| + W1, the largest ratio over all pairs of a kind."),
            Grid(named(shown, SUMMARY), "Measured and bound.", "meanfield_stability_summary"),
        ],
    )


def _words(summary: pd.DataFrame) -> str:
    told = listed([f"{TITLES[row.model]} {number(row.largest)} (t = {row.at:g})" for row in summary.itertuples()])
    rates = listed(
        [f"{row.rate:.3f} [{row.low:.3f}, {row.high:.3f}]" for row in summary.itertuples()],
    )
    bounds = listed([f"{number(row.bound)} ({number(row.needed)} is enough)" for row in summary.itertuples()])
    return (
        "Pairs of starts, drawn at random, differ in one or all of: sample, law, y(0), y'(0). The largest D(t)/D(0) is "
        f"{told}. It does not grow exponentially, as the motions are oscillations: the rate of its logarithm is "
        f"{rates} (95 % intervals). The proof, with a coupling and C = 1, gives e^(Lt) with L = {bounds}, from the "
        "Lipschitz constants of Φ, m_eff and F_eff on the levels g, y and y' that the motions visit: true, and far too "
        "large."
    )


def _printed(laws: pd.DataFrame) -> str:
    top = laws.loc[laws["ratio"].idxmax()]
    return (
        "(5.65) as printed, W1(μ1, μ2) ≤ C ‖X1 − X2‖ + W1 at t = 0, is wrong: two laws with equal second moment have "
        f"the same flow under StraightFibre (found: y apart by {number(laws['flows_apart'].max())}), X1 = X2, but W1 "
        f"grows with y, by a factor {top['ratio']:.4g} at t = {top['t']:g}, where y has grown by {top['stretch']:.4g}. "
        "The last term needs the Lipschitz constant of the flow as a factor; the theorem stays true, with another C."
    )


PART = Part(_run, _section)
