"""Growth of the height of sheets and slices, in which all daughters stay or those of one division in five."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.frames.frame import Frame
from tissue.frames.observables import basal_area, height
from tissue.frames.section import section
from tissue.runs.simulate import simulate
from tissue.state.cells import Floats, Integers

# The probability that both daughters of a division stay: that of the slice, and that of a sheet.
SOME, ALL = 0.2, 1.0
END, EVERY = 48.0, 6.0  # h
SHEET: Mapping[str, object] = {"tissue.dimension": 3}
FREE: Mapping[str, object] = {**SHEET, "space.boundary": "open"}
# A nucleus of a sheet begins among five times as many soft balls as soft discs in a slice of the same spacing.
WEAK: Mapping[str, object] = {**FREE, "cell.alpha_xx": 0.2}
# So large that the tissue is low over it.
TUBE: Mapping[str, object] = {"layer.shape": "circle", "layer.closed": True, "layer.perimeter": "1000 um"}


class GrowingLayer(NamedTuple):
    """A tissue at the start, and what makes it of the published preset."""

    layer: str
    cells: int
    both: float  # probability that both daughters stay
    changes: Mapping[str, object]

    def parameters(self) -> Parameters:
        """Return the parameters of the runs of a layer."""
        given = {"tissue.cells": self.cells, "tissue.two_daughters": self.both, "numerics.t_end": f"{END:g} h"}
        return preset("published").changed({**given, "numerics.keep": f"{EVERY:g} h", **self.changes})


LAYERS = (
    GrowingLayer("free sheet", 2304, ALL, FREE),
    GrowingLayer("free sheet", 400, ALL, FREE),
    GrowingLayer("periodic sheet", 196, ALL, SHEET),
    GrowingLayer("free sheet", 196, ALL, FREE),
    GrowingLayer("free sheet, weak repulsion", 196, ALL, WEAK),
    GrowingLayer("free sheet", 400, SOME, FREE),
    GrowingLayer("periodic sheet", 196, SOME, SHEET),
    GrowingLayer("free sheet", 196, SOME, FREE),
    GrowingLayer("slice", 180, ALL, {}),
    GrowingLayer("slice", 45, ALL, {}),
    GrowingLayer("slice", 180, SOME, {}),
    GrowingLayer("slice", 45, SOME, {}),
    GrowingLayer("tube", 600, SOME, TUBE),
)


@dataclass(frozen=True)
class SheetForm:
    """How far the study goes: number of seeds, and the layers."""

    seeds: int = 4
    layers: tuple[GrowingLayer, ...] = LAYERS


FULL = SheetForm()


def study(form: SheetForm) -> Study:
    """Plan one run for each layer and seed."""
    runs = [{**name_of(layer), "seed": seed} for layer in form.layers for seed in range(form.seeds)]
    return Study(
        name="space_growth",
        title="Space: growth",
        key=("layer", "cells", "both", "seed"),
        runs=tuple(runs),
        run=partial(grown, layers=form.layers),
        settings={"end": END, "every": EVERY},  # more layers are more runs
    )


def name_of(layer: GrowingLayer) -> dict[str, object]:
    """Return the columns that name a layer."""
    return {"layer": layer.layer, "cells": layer.cells, "both": layer.both}


def grown(key: Key, layers: Sequence[GrowingLayer]) -> list[Row]:
    """Return a row for each kept time; none from where a run is lost."""
    (layer,) = [one for one in layers if all(key[name] == value for name, value in name_of(one).items())]
    run = simulate(layer.parameters(), key["seed"])
    first = run.frames[0]
    frames = run.frames if run.status else run.frames[:-1]
    return [{**key, "t": frame.t} | _measured(frame, first) for frame in frames]


def _measured(frame: Frame, first: Frame) -> dict[str, float]:
    """Measure relative height, cells, cells in the section z = 0, basal extent; apical over basal; roughness."""
    apical, basal = _apical_extent(frame), basal_extent(frame)
    return {
        "height": height(frame) / height(first),
        "number": len(frame.cells.x) / len(first.cells.x),
        "section": len(section(frame).cells.x) / len(section(first).cells.x),
        "basal": basal / basal_extent(first),
        "fan": apical / basal,
        "rough": roughness(frame),
    }


def _apical_extent(frame: Frame) -> float:
    """Return the extent of the apical layer: the length of a path, in space the root of an area [R_soft]."""
    cells = frame.cells
    if frame.sheets is None:
        layer = np.append(frame.layers.apical, frame.layers.apical[: frame.curve.ring])
        return _length(cells.ax[layer], cells.ay[layer])
    over = cells._replace(bx=cells.ax, by=cells.ay, bz=cells.az)
    return math.sqrt(basal_area(over, frame.sheets._replace(basal=frame.sheets.apical)))


def basal_extent(frame: Frame) -> float:
    """Return the extent of the basal layer: the length of a path, in space the root of an area [R_soft]."""
    cells = frame.cells
    if frame.sheets is None:
        layer = np.append(frame.layers.basal, frame.layers.basal[: frame.curve.ring])
        return _length(cells.bx[layer], cells.by[layer])
    return math.sqrt(basal_area(cells, frame.sheets))


def _length(x: Floats, y: Floats) -> float:
    return float(np.hypot(np.diff(x), np.diff(y)).sum())


def roughness(frame: Frame) -> float:
    """Return the root mean square of apical height less the mean height of junction partners [R_soft]."""
    cells, edges = frame.cells, _junctions(frame)
    ends, others = edges.T.ravel(), edges[:, ::-1].T.ravel()
    counts = np.bincount(ends, minlength=len(cells.x))
    inner = counts > 1
    y = frame.heights(cells.ax, cells.ay, cells.az)
    around = np.bincount(ends, weights=y[others], minlength=len(cells.x))[inner] / counts[inner]
    return float(np.sqrt(np.mean((y[inner] - around) ** 2)))


def _junctions(frame: Frame) -> Integers:
    """Return the two cells of each junction, (m, 2)."""
    if frame.sheets is not None:
        return frame.sheets.apical.edges
    layer = np.append(frame.layers.apical, frame.layers.apical[: frame.curve.ring])
    return np.column_stack((layer[:-1], layer[1:]))
