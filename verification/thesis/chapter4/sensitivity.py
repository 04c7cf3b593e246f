"""Which mechanical parameters basal extrusion depends on: variance-based sensitivity as a study of its own."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from tissue.files.parameter_files import flat
from tissue.files.parameters import preset
from tissue.statistics.categories import kept_times, outcome
from tissue.statistics.ratios import ratio
from tissue.study.plan import TissueStudy
from tissue.study.read import Results
from tissue.study.sensitivity import Plan, analyse, plan_sensitivity

NAME = "sensitivity"
# A group that leaves without protrusions as often as not, so that the ratio can go both ways. With the 20 substeps of
# the preset, one of the points would be unstable.
HEAD: dict[str, str | int] = {
    "title": "Sensitivity of basal extrusion to the mechanics",
    "base": "thesis",
    "replicates": 48,
    "seed": 24,
}
GROUP: dict[str, dict[str, str | int]] = {
    "emt": {"cells": 10, "inm": 0, "b": "6 h"},
    "numerics": {"keep": "48 h", "substeps": 21},
}
# Half to one and a half times the values of the preset; the damping where all runs are stable.
BOUNDS = {
    "cell.alpha_aa": (2.5, 7.5),
    "cell.alpha_ax": (1.0, 3.0),
    "cell.alpha_bx": (1.0, 3.0),
    "cell.alpha_xx": (0.5, 1.5),
    "cell.alpha_axb": (7.5, 22.5),
    "numerics.mu": ("0.1 h", "0.2 h"),
    "tissue.diffusion": ("1.25 um^2/h", "3.75 um^2/h"),
    "tissue.two_daughters": (0.1, 0.3),
}
BASE_POINTS, SEED = 32, 0


def plan() -> Plan:
    """The points: ten for each of ``BASE_POINTS``."""
    return plan_sensitivity(preset(str(HEAD["base"])).changed(flat(GROUP)), BOUNDS, BASE_POINTS, SEED)


def study() -> TissueStudy:
    """Their runs."""
    points, base = plan(), preset(str(HEAD["base"])).changed(flat(GROUP))
    scenarios = {name: base.changed(flat(sections)) for name, sections in points.scenarios().items()}
    return TissueStudy(
        title=str(HEAD["title"]),
        replicates=int(HEAD["replicates"]),
        seed=int(HEAD["seed"]),
        trajectories=(),
        scenarios=scenarios,
        text=points.toml(HEAD, GROUP),
    )


def indices(results: Mapping[str, Results]) -> pd.DataFrame:
    """S1 and ST of each parameter for the ratio of basal extrusion, with 95 % intervals, noise taken out."""
    found = results[NAME]
    cells = {scenario: found.cells(scenario) for scenario in found.study.scenarios}
    ratios = {
        name: ratio(outcome(table, "basal", kept_times(table)[-1]), table["replicate"]) for name, table in cells.items()
    }
    result = analyse(plan(), ratios, seed=SEED)
    return result.table.assign(noise=result.noise, deviation=result.deviation).reset_index()
