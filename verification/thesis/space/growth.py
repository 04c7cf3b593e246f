"""Growth of the height of sheets and slices, in which all daughters stay or those of one division in five.

``python -m verification.thesis.space.growth FOLDER`` makes the runs that are missing in FOLDER, in half an hour on two
cores, and ``verification/thesis/data/space_growth.parquet``.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study, workers
from tissue.files.parameters import Parameters, preset
from tissue.first_order import simulate
from tissue.model.observables import height
from tissue.space.measures import basal_area
from tissue.state.cells import Floats, Integers
from tissue.state.frame import Frame
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.kept import DATA, keep

FILE = DATA / "space_growth.parquet"
SEEDS = 12
# The probability that both daughters of a division stay: that of the slice, and that of a sheet.
SOME, ALL = 0.2, 1.0
END, EVERY = 48.0, 6.0  # h
SHEET: Mapping[str, object] = {"tissue.dimension": 3}
FREE: Mapping[str, object] = {**SHEET, "space.boundary": "open"}
# So large that the tissue is low over it.
TUBE: Mapping[str, object] = {"layer.shape": "circle", "layer.closed": True, "layer.perimeter": "1000 um"}


class GrowingLayer(NamedTuple):
    """A tissue at the start, and what makes it of the published preset."""

    layer: str
    cells: int
    both: float  # probability that both daughters stay
    changes: Mapping[str, object]

    def parameters(self) -> Parameters:
        """Those of its runs."""
        given = {"tissue.cells": self.cells, "tissue.two_daughters": self.both, "numerics.t_end": f"{END:g} h"}
        return preset("published").changed({**given, "numerics.keep": f"{EVERY:g} h", **self.changes})


LAYERS = (
    GrowingLayer("free sheet", 784, ALL, FREE),
    GrowingLayer("free sheet", 400, ALL, FREE),
    GrowingLayer("periodic sheet", 196, ALL, SHEET),
    GrowingLayer("free sheet", 196, ALL, FREE),
    GrowingLayer("free sheet", 400, SOME, FREE),
    GrowingLayer("periodic sheet", 196, SOME, SHEET),
    GrowingLayer("free sheet", 196, SOME, FREE),
    GrowingLayer("slice", 180, ALL, {}),
    GrowingLayer("slice", 45, ALL, {}),
    GrowingLayer("slice", 180, SOME, {}),
    GrowingLayer("slice", 45, SOME, {}),
    GrowingLayer("tube", 600, SOME, TUBE),
)


def study() -> Study:
    """One run for each layer and seed."""
    runs = [{**name_of(layer), "seed": seed} for layer in LAYERS for seed in range(SEEDS)]
    return Study("space_growth", "Space: growth", ("layer", "cells", "both", "seed"), tuple(runs), grown)


def name_of(layer: GrowingLayer) -> dict[str, object]:
    """The columns that name it."""
    return {"layer": layer.layer, "cells": layer.cells, "both": layer.both}


def grown(key: Key) -> list[Row]:
    """One row for each kept time; none from where a run is lost."""
    (layer,) = [one for one in LAYERS if all(key[name] == value for name, value in name_of(one).items())]
    run = simulate(layer.parameters(), key["seed"])
    first = run.frames[0]
    frames = run.frames if run.status else run.frames[:-1]
    return [{**key, "t": frame.t} | _measured(frame, first) for frame in frames]


def _measured(frame: Frame, first: Frame) -> dict[str, float]:
    """Height, number of cells and basal extent over those of the start; apical over basal extent; roughness."""
    apical, basal = _extents(frame)
    return {
        "height": height(frame) / height(first),
        "number": len(frame.cells.x) / len(first.cells.x),
        "basal": basal / _extents(first)[1],
        "fan": apical / basal,
        "rough": roughness(frame),
    }


def _extents(frame: Frame) -> tuple[float, float]:
    """Of the apical and of the basal layer: lengths of paths, in space the roots of areas."""
    cells = frame.cells
    if frame.sheets is None:
        apical, basal = (np.append(layer, layer[: frame.curve.ring]) for layer in frame.layers)
        return _length(cells.ax[apical], cells.ay[apical]), _length(cells.bx[basal], cells.by[basal])
    over = cells._replace(bx=cells.ax, by=cells.ay, bz=cells.az)
    area = basal_area(over, frame.sheets._replace(basal=frame.sheets.apical))
    return float(np.sqrt(area)), float(np.sqrt(basal_area(cells, frame.sheets)))


def _length(x: Floats, y: Floats) -> float:
    return float(np.hypot(np.diff(x), np.diff(y)).sum())


def roughness(frame: Frame) -> float:
    """Root mean square of the height of an apical point less the mean of those that it has junctions with [R_soft]."""
    cells, edges = frame.cells, _junctions(frame)
    ends, others = edges.T.ravel(), edges[:, ::-1].T.ravel()
    counts = np.bincount(ends, minlength=len(cells.x))
    inner = counts > 1
    y = frame.heights(cells.ax, cells.ay, cells.az)
    around = np.bincount(ends, weights=y[others], minlength=len(cells.x))[inner] / counts[inner]
    return float(np.sqrt(np.mean((y[inner] - around) ** 2)))


def _junctions(frame: Frame) -> Integers:
    """The cells that each joins, (m, 2)."""
    if frame.sheets is not None:
        return frame.sheets.apical.edges
    layer = np.append(frame.layers.apical, frame.layers.apical[: frame.curve.ring])
    return np.column_stack((layer[:-1], layer[1:]))


def summed(table: pd.DataFrame) -> Iterator[dict[str, object]]:
    """One row for each layer and time: means over the seeds, that of the height with its interval."""
    for name, mine in table.groupby(["layer", "cells", "both", "t"], sort=False):
        mean, low, high = over_seeds(mine["height"])
        about = dict(zip(("layer", "cells", "both", "t"), name, strict=True))
        others = {column: mine[column].mean() for column in ("number", "basal", "fan", "rough")}
        yield (
            about | {"height": mean, "low": low, "high": high} | others | {"runs": len(mine), "lost": SEEDS - len(mine)}
        )


def table() -> pd.DataFrame:
    """The kept table."""
    return pd.read_parquet(FILE)


def main(folder: Path) -> None:
    """Complete the study, and keep its means."""
    with workers() as executor:
        rows = study().complete(folder, executor)
    keep(pd.DataFrame(summed(rows)), FILE, main)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
