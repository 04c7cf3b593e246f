"""The preset ``sheet`` over two days, beside a slice made a sheet: heights, areas and outlines of cells, nuclei."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd
from scipy.spatial import Voronoi, cKDTree

from dincl.study import Key, Row, Study
from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from tissue.state.cells import Floats

EVERY, SEEDS = 6.0, 8  # h
FITTED, SLICE = "sheet", "published, as a sheet"
CROWDED = {"tissue.dimension": 3, "tissue.cells": 196, "tissue.two_daughters": 1, "numerics.t_end": "24 h"}
# The preset and its changes: the fitted one, and a slice that is made a sheet, whose daughters all stay.
TISSUES: Mapping[str, tuple[str, Mapping[str, object]]] = {
    FITTED: ("sheet", {"numerics.t_end": "48 h"}),
    SLICE: ("published", CROWDED),
}
COLUMNS = {
    "tissue": "Tissue",
    "t": "Time [h]",
    "height": "Height [µm]",
    "lowest": "Lowest of a run",
    "highest": "Highest of a run",
    "area": "Area of a cell [µm²]",
    "outline": "Apical outline [µm]",
    "crossed": "Nuclei above each other",
    "layers": "Soft balls above each other",
    "outside": "Cells outside [%]",
    "folded": "Runs folded",
    "runs": "Runs",
}


def study(smallest: bool = False) -> Study:
    """Return one run for each tissue and seed."""
    tissues, seeds = ((FITTED,), 1) if smallest else (tuple(TISSUES), SEEDS)
    runs = tuple({"tissue": name, "seed": seed} for name in tissues for seed in range(seeds))
    settings = {"every": EVERY, "tissues": TISSUES}
    return Study("space_sheet", "Space: sheet", ("tissue", "seed"), runs, kept, settings, COLUMNS, by=("t",))


def kept(key: Key) -> list[Row]:
    """Return a row for each output time [h, um, um^2].

    A nucleus counts as wide as nuclei are apart, in the mean over the nearest ones: of a width w a normal crosses
    pi w^2/4 over the area of a cell. ``layers`` are those of soft balls, which overlap.
    """
    name, changes = TISSUES[key["tissue"]]
    given = preset(name).changed({**changes, "numerics.keep": f"{EVERY:g} h"})
    unit, surface = given.cell.soft_radius.value, given.lattice().surface
    periods = np.array([surface.period_x, surface.period_z])
    made, rows = simulate(given, key["seed"], throw=False), list[Row]()
    for frame, told in zip(made.frames, made.summary().itertuples(), strict=True):
        cells, apical, area = frame.cells, frame.layers.apical, periods.prod() / len(frame.cells.x)
        heights, centres = np.tile(cells.y, 9), images(np.column_stack((cells.x, cells.z)), periods)
        nuclei = np.column_stack((centres, heights))
        apart = cKDTree(nuclei).query(nuclei[: len(cells.x)], k=2)[0][:, 1].mean()
        outside = told.apically_extruded + told.basally_extruded
        found = {"height": told.height_um, "area": area * unit**2, "crossed": math.pi * apart**2 / 4 / area}
        found |= {"outline": unit * outline(np.column_stack((cells.ax, cells.az))[apical], periods)}
        found |= {"layers": told.nuclear_layers, "outside": 100 * outside / len(cells.x)}
        rows.append({**key, "t": frame.t, **found, "folded": told.folded != "no"})
    return rows


def images(points: Floats, periods: Floats) -> Floats:
    """Return points (n, 2) in a sheet with these periods, followed by their eight images, (9 n, 2)."""
    shifts = [(0, 0), *((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j)]
    return np.concatenate([points % periods + np.array(shift) * periods for shift in shifts])


def outline(points: Floats, periods: Floats) -> float:
    """Return the mean perimeter of the Voronoi cells of points (n, 2) in a sheet with these periods."""
    found = Voronoi(images(points, periods))
    ridges = np.array(found.ridge_vertices)
    lengths = np.linalg.norm(np.diff(found.vertices[ridges], axis=1)[:, 0], axis=1)
    # Each ridge is of two cells; those of the images are not counted, nor ridges that have no end.
    sides = (found.ridge_points < len(points)).sum(axis=1)
    return float((lengths * sides).sum() / len(points))


def means(table: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each tissue and time: means over the runs, the lowest and highest height, folded runs."""
    groups = table.groupby(["tissue", "t"], sort=False)
    found = groups[["height", "area", "outline", "crossed", "layers", "outside"]].mean()
    heights = groups["height"].agg(["min", "max"]).to_numpy().T
    found["lowest"], found["highest"] = heights
    found["folded"], found["runs"] = groups["folded"].sum(), groups.size()
    return found.reset_index()
