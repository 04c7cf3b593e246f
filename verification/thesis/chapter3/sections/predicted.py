"""Prediction of nuclei."""

from __future__ import annotations

from typing import Any

import pandas as pd

from tissue.files.parameters import preset
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3 import disturbed
from verification.thesis.chapter3 import figures as figures_tissue
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sections.part import COLUMNS, PROSE, Part, named

# Made again beside the complete study: one seed to 10 h.
AGAIN = disturbed.DisturbedForm(disturbed.FEW, 1, disturbed.TIMES[:8])


def _run(context: Context) -> None:
    study = disturbed.study(context.form(disturbed.FULL))
    apart = context.rows_of(study, disturbed.study(AGAIN), ("size", "t"))
    context.keep("tissue_distances", disturbed.medians(apart))
    context.keep("tissue_rates", disturbed.rates(apart))
    context.keep(
        "tissue_predicted", disturbed.predicted(context.tables["tissue_errors"], context.tables["tissue_distances"])
    )


def _predicted(context: Context) -> Section:
    rates, predicted = context.tables["tissue_rates"], context.tables["tissue_predicted"]
    picture = context.draw("tissue_disturbances", figures_tissue.disturbances, context.tables["tissue_distances"])
    said = fill(PROSE / "predicted.html", **_chaos(rates), **_until(predicted))
    return Section(
        "How long can nuclei be predicted?",
        [
            Text(said["disturbed"]),
            Picture(picture, said["picture"]),
            Text(said["until"]),
            Grid(named(rates, COLUMNS["rates"]), said["rates"], "tissue_rates"),
            Grid(named(predicted, COLUMNS["predicted"]), said["table"], "tissue_predicted", folded=True),
            Follows(said["follows"]),
        ],
    )


def _chaos(rates: pd.DataFrame) -> dict[str, Any]:
    small = rates[rates["size"] == disturbed.SIZES[1]]
    return {
        "size": disturbed.SIZES[1],
        "small": list(small.itertuples()),
        "steady": (small["low"] <= 0).sum(),
        "parted": list(rates.groupby("size")["jumped"].max().items()),
    }


def _until(predicted: pd.DataFrame) -> dict[str, Any]:
    rows = []
    for name in PRESETS:
        until = predicted[predicted["preset"] == name].set_index("substeps")["until"]
        own, finest = preset(name).numbers().substeps, int(until.index.max())
        rows.append(
            {"preset": name, "own": own, "own_until": until[own], "finest": finest, "finest_until": until[finest]}
        )
    return {"presets": rows, "looked_at": predicted["looked_at"].max()}


PART = Part(_run, _predicted)
