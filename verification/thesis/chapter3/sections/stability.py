"""Limits of stable substeps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter3 import beyond, limits, maps
from verification.thesis.chapter3 import figures as figures_tissue
from verification.thesis.chapter3.sections.part import COLUMNS, PROSE, Part, named

# Made again beside the complete studies: two seeds with the substeps of the presets, lines of maps, cases.
AGAIN = beyond.BeyondForm({"thesis": (20,), "published": (40,)}, 2, (1.0, 5.0))
LINES, FEW = 3, 3


def _run_stability(context: Context) -> None:
    form, cases = context.form(maps.FORM), context.form(limits.FORM)
    studies = {plane.name: maps.study(plane) for plane in form.planes}
    tables = {name: context.rows_of(study, study.some(LINES)) for name, study in studies.items()}
    for name, table in tables.items():
        context.tables[f"tissue_map_{name}"] = table
    context.keep("tissue_losses", maps.losses(tables))
    jitter = beyond.study(context.form(beyond.FULL))
    context.keep("tissue_swing", beyond.summary(context.rows_of(jitter, beyond.study(AGAIN), ("t",))))
    found = context.rows_of(limits.study(cases), limits.study(cases).some(FEW)).set_index("case")
    words = [{"case": case.id, "title": case.title, "theory": case.theory} for case in cases.cases]
    context.keep("tissue_limits_found", pd.DataFrame(words).join(found, on="case"))


def _stability(context: Context) -> Section:
    found, swings, losses = (context.tables[f"tissue_{name}"] for name in ("limits_found", "swing", "losses"))
    tables = {plane.name: context.tables[f"tissue_map_{plane.name}"] for plane in maps.PLANES}
    swing = context.draw("tissue_jitter", figures_tissue.jitter, swings)
    shown = context.draw("tissue_maps", figures_tissue.maps, tables)
    said = fill(PROSE / "stability.html", **_limits(found), **_swings(swings), **_losses(losses))
    return Section(
        "At which step do substeps become unstable?",
        [
            Text(said["verdict"]),
            Picture(swing, said["jitter"]),
            Text(said["linear"]),
            Grid(named(found, COLUMNS["limits_found"]), said["limits"], "tissue_limits_found"),
            Grid(named(found, COLUMNS["limits_particulars"]), said["particulars"], "tissue_limits_found", folded=True),
            Text(said["losses"]),
            Picture(shown, said["maps"]),
            Grid(named(swings, COLUMNS["swing"]), said["table"], "tissue_swing"),
            Follows(said["follows"]),
        ],
    )


def _limits(found: pd.DataFrame) -> dict[str, Any]:
    return {"agreeing": int(found["agrees"].sum()), "count": len(found)}


def _swings(swings: pd.DataFrame) -> dict[str, Any]:
    """Return each preset with its own substeps, and the most with which cells of the thesis preset are lost."""
    own = [preset(name).numbers().substeps for name in swings["preset"]]
    presets = swings[swings["substeps"] == own].set_index("preset")
    lost = swings[(swings["preset"] == "thesis") & (swings["lost"] > 0)]
    return {
        "thesis": presets.loc["thesis"].to_dict(),
        "published": presets.loc["published"].to_dict(),
        "fewer": lost["substeps"].max() if len(lost) else None,
    }


def _losses(losses: pd.DataFrame) -> dict[str, Any]:
    agreeing = 100 * float(np.average(losses["predicted"], weights=losses["cells"]))
    return {"losses": list(losses.itertuples()), "predicted": agreeing}


PART = Part(_run_stability, _stability)
