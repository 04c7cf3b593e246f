"""How long nuclei can be foretold."""

from __future__ import annotations

import pandas as pd

from tissue.files.parameters import preset
from verification.page.report import Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter3 import disturbed
from verification.thesis.chapter3 import figures as figures_tissue
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sections.part import Part, named

RATES = {
    "preset": "Preset",
    "substeps": "Substeps",
    "size": "Apart at the start [R_soft]",
    "rate": "log growth per h",
    "low": "from",
    "high": "to",
    "jumped": "Part of the runs that parted",
}
FORETOLD = {
    "preset": "Preset",
    "substeps": "Substeps",
    "until": "Foretold until [h]",
    "looked_at": "Looked at until [h]",
}


def _run(context: Context) -> None:
    apart = disturbed.study(context.form(disturbed.SHORT, disturbed.FULL)).complete(context.folder, context.executor)
    context.keep("tissue_distances", disturbed.medians(apart))
    context.keep("tissue_rates", disturbed.rates(apart))
    context.keep(
        "tissue_foretold", disturbed.foretold(context.tables["tissue_errors"], context.tables["tissue_distances"])
    )


def _foretold(context: Context) -> Section:
    rates, foretold = context.tables["tissue_rates"], context.tables["tissue_foretold"]
    picture = context.draw("tissue_disturbances", figures_tissue.disturbances, context.tables["tissue_distances"])
    return Section(
        "How long nuclei can be foretold",
        [
            Text(_chaos(rates)),
            Picture(
                picture,
                "Distance of the nuclei of two runs, median over the seeds; dashed: the largest. Other noise: the same "
                "start and divisions.",
            ),
            Text(_until(foretold)),
            Grid(named(rates, RATES), "Growth of small disturbances, with 95 % intervals.", "tissue_rates"),
            Grid(named(foretold, FORETOLD), "Foretold until", "tissue_foretold", folded=True),
        ],
    )


def _chaos(rates: pd.DataFrame) -> str:
    small = rates[rates["size"] == disturbed.SIZES[1]]
    steady = (small["low"] <= 0).sum()
    told = "; ".join(
        f"{row.preset}, {row.substeps} substeps: {row.rate:.2f} [{row.low:.2f}, {row.high:.2f}]"
        for row in small.itertuples()
    )
    parted = rates.groupby("size")["jumped"].max()
    shares = ", ".join(f"{number(100 * part)} % of those with {number(size)}" for size, part in parted.items())
    return (
        f"Two runs begin {number(disturbed.SIZES[1])} R_soft apart. The logarithm of their distance grows per hour by "
        f"{told}: slowly, if at all (the interval holds 0 in {steady} of {len(small)} cases), so that rounding does "
        "not matter. The larger the disturbance, the sooner runs part: in the end at most "
        f"{shares} are further apart than half the distance of two runs with other noise. The error of "
        "substeps is of that large kind, and made anew at every step."
    )


def _until(foretold: pd.DataFrame) -> str:
    parts = []
    for name in PRESETS:
        mine = foretold[foretold["preset"] == name].set_index("substeps")["until"]
        own, finest = preset(name).numbers().substeps, int(mine.index.max())
        parts.append(f"{name}, {own} substeps: {mine[own]:g} h, {finest} substeps: {mine[finest]:g} h")
    return (
        "A nucleus is foretold as long as the median error, against the reference, is below half the distance of two "
        f"runs with other noise; afterwards only quantities of the tissue mean anything ({'; '.join(parts)}; looked at "
        f"until {foretold['looked_at'].max():g} h)."
    )


PART = Part(_run, _foretold)
