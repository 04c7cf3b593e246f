"""Curved basal layers: does the way out of a tissue depend on curvature, and does a large circle become the line?

``python -m verification.beyond.curved.curved FOLDER`` makes the runs that are missing in FOLDER, 36,000 in half
an hour on two cores, and ``verification/data/curved_*.parquet``.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pandas as pd

from dincl.study import read_sealed, workers
from tissue.files.parameters import preset
from tissue.state.cells import Floats
from tissue.statistics.proportions import wilson
from tissue.study.outcomes import SIDES, outcomes
from tissue.study.read import Results
from tissue.study.run import run_study
from verification.page.kept import DATA, keep
from verification.thesis.chapter3.intervals import over_seeds

STUDY = "curved_published"
LAYERS = ("line", "inside", "outside")
# Perimeters of the circles that become the line [um], the side of their tissue, and the runs of each.
PERIMETERS, RUNS = (400, 800, 1600, 3200, 6400), 400
HEIGHT = "height_um_54h"


def main(folder: Path) -> None:
    """Complete the study, measure the limit, and keep both tables."""
    with workers() as executor:
        results = run_study(STUDY, folder, executor)
    keep(pd.DataFrame(_ways_out(results)), file("ways_out"), main)
    keep(pd.DataFrame(_limit()), file("limit"), main)


def file(name: str) -> Path:
    """Return the path of a kept table."""
    return DATA / f"curved_{name}.parquet"


def table(name: str) -> pd.DataFrame:
    """Read a kept table."""
    return read_sealed(file(name))


def _ways_out(results: Results) -> Iterator[dict[str, object]]:
    """Return a row for each set of events, layer and side: cells that have ended there, with Wilson's interval."""
    for scenario in results.study.scenarios:
        events, layer = scenario.rsplit(", ", 1)
        ended = results.cells(scenario, ["extruded"])["extruded"]
        for side in (SIDES[0], SIDES[-1]):
            count = int((ended == side).sum())
            low, high = wilson(count / len(ended), len(ended))
            yield {
                "events": events,
                "layer": layer,
                "side": side,
                "count": count,
                "of": len(ended),
                "value": count / len(ended),
                "low": float(low),
                "high": float(high),
            }


def _limit() -> Iterator[dict[str, object]]:
    """Return a row for each circle and the line: mean height at the end, interval, difference from the line."""
    line = _heights({})
    mean = line.mean()
    for side in ("inside", "outside"):
        for perimeter in PERIMETERS:
            found = _heights({"layer.shape": "circle", "layer.perimeter": f"{perimeter} um", "layer.side": side})
            away = over_seeds(found - line)  # the same seeds: most of the noise cancels
            yield {
                "side": side,
                "perimeter_um": perimeter,
                "height_um": float(found.mean()),
                "line_um": float(mean),
                "away_um": away.mean,
                "low": away.low,
                "high": away.high,
                "runs": RUNS,
            }


def _heights(changes: dict[str, object]) -> Floats:
    """Return the mean height of the apical layer at the end, of each run."""
    parameters = preset("published").changed({"tissue.cells": 51, "numerics.keep": ["54 h"], **changes})
    heights: Floats = outcomes(parameters, range(RUNS), range(RUNS)).runs.to_pandas()[HEIGHT].to_numpy()
    return heights


if __name__ == "__main__":
    main(Path(sys.argv[1]))
