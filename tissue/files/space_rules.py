"""Which values go together in three dimensions, and which need them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from dincl.errors import InvalidProblem
from tissue.events.division import BESIDE
from tissue.files.rule import Rule, show
from tissue.files.timing import Timing
from tissue.files.units import Measure, reduced
from tissue.kernels.surface_workspace import SHORTEST_PERIOD
from tissue.model.lattice import ROW, rows_of
from tissue.plugins import Force, registered
from tissue.state.space import FLAT

IN_SPACE = "in three dimensions"
# Two descriptions of one length differ by rounding.
ROUNDING = 1e-12
# Cells up to which a sheet is looked for that has enough of them.
MOST_TRIED = 20_000


def _shape(shape: str, dimension: int) -> str | None:
    """Check the shape: an ellipse and a curve are layers of a slice, a sphere of three dimensions."""
    allowed = ("line", "circle", "ellipse", "points") if dimension == FLAT else ("line", "circle", "sphere")
    if shape in allowed:
        return None
    return f"{' or '.join(map(show, allowed))} {'in a slice' if dimension == FLAT else IN_SPACE}"


def _below_the_middle(
    height: Measure, dimension: int, shape: str, side: str, around: Measure, soft: Measure
) -> str | None:
    """Check that apical points inside a sphere do not come to its middle; see ``_bends`` for a cylinder."""
    radius = reduced(around, soft) / (2.0 * math.pi)
    if dimension == FLAT or shape != "sphere" or side == "outside" or reduced(height, soft) < radius:
        return None
    return f"below {radius:.4g} R_soft, the radius of the basal surface"


def _rows(rows: int, cells: int, dimension: int, shape: str, boundary: str) -> str | None:
    return _refused("space.rows", rows, cells, dimension, shape, boundary)


def _fill(cells: int, rows: int, dimension: int, shape: str, boundary: str) -> str | None:
    return _refused("tissue.cells", rows, cells, dimension, shape, boundary)


def _refused(key: str, rows: int, cells: int, dimension: int, shape: str, boundary: str) -> str | None:
    """Return what this key must be if it is the one for which the cells do not fill rows."""
    if dimension == FLAT or shape == "sphere":
        return None
    try:
        rows_of(cells, rows, strip=_may_be_strip(shape, boundary))
    except InvalidProblem as error:
        named, _, allowed = str(error).partition(": must be ")
        return allowed if named.startswith(key) else None
    return None


def _may_be_strip(shape: str, boundary: str) -> bool:
    """Return whether one row of cells may stand alone: around an open cylinder."""
    return shape == "circle" and boundary == "open"


def _calm(noise: Measure, dimension: int, rows: int) -> str | None:
    """Refuse noise in a strip: it takes nuclei out of the plane, and the row tears."""
    return None if dimension == FLAT or rows != 1 or noise.value == 0.0 else '"0 um^2/h" with space.rows = 1'


def _wide(cells: int, dimension: int, shape: str, boundary: str, rows: int, *lengths: Measure) -> str | None:
    """Check that nuclei meet one image of each other; see ``tissue.kernels.surface_workspace.period``."""
    if dimension == FLAT or shape == "sphere" or boundary == "open":
        return None
    around, spacing = (reduced(length, lengths[-1]) for length in lengths[:-1])
    try:
        across = rows_of(cells, rows)
    except InvalidProblem:
        return None
    if shape == "circle":
        spacing = around * across / cells
    periods = (across * ROW * spacing, cells / across * spacing if shape == "line" else around)
    if min(periods) > SHORTEST_PERIOD:
        return None
    return (
        f"more, in more rows or columns: the sheet repeats after {min(periods):.4g} R_soft, and must after more than "
        f"{SHORTEST_PERIOD:g}, twice the range of nuclei"
    )


def _dense(
    cells: int, dimension: int, shape: str, boundary: str, rows: int, around: Measure, largest: Measure, soft: Measure
) -> str | None:
    """Check that the basal points go around a cylinder or a sphere within (C2)."""
    if dimension == FLAT or shape == "line":
        return None
    length, most = reduced(around, soft), reduced(largest, soft)
    if shape == "sphere":
        least = length**2 / math.pi / (math.sqrt(3.0) / 2.0 * most**2)
    else:
        try:
            least = length / most * rows_of(cells, rows, strip=_may_be_strip(shape, boundary))
        except InvalidProblem:
            return None
    ok = cells >= least * (1.0 - ROUNDING)
    return None if ok else f"at least {math.ceil(least)}: of fewer the basal points do not go around within (C2)"


def _same_spacing(
    apical: Measure, dimension: int, basal: Measure, shape: str, boundary: str, soft: Measure
) -> str | None:
    """Check that a periodic sheet has one period."""
    if dimension == FLAT or shape != "line" or boundary == "open":
        return None
    one, other = reduced(apical, soft), reduced(basal, soft)
    return None if abs(one - other) <= ROUNDING * other else f"tissue.basal_spacing = {show(basal)} {IN_SPACE}"


def _beside(rule: str, dimension: int) -> str | None:
    """Refuse rules of divisions in space, where daughters have a rule of their own."""
    return None if dimension == FLAT or rule == BESIDE.name else f"{show(BESIDE.name)} {IN_SPACE}"


def _no_chains(time: Timing, dimension: int) -> str | None:
    return None if dimension == FLAT or not time.ever else f'"never" {IN_SPACE}: there are no chains'


def no_forces() -> list[Rule]:
    """Return the rules of registered forces, which act in a slice alone."""
    return [Rule((f"forces.{force.name}", "tissue.dimension"), _no_force) for force in registered(Force)]


def _no_force(strength: float, dimension: int) -> str | None:
    return None if dimension == FLAT or strength == 0 else f"0 {IN_SPACE}: registered forces act in a slice alone"


SPACE_RULES = (
    Rule(("layer.shape", "tissue.dimension"), _shape),
    Rule(
        ("tissue.height", "tissue.dimension", "layer.shape", "layer.side", "layer.perimeter", "cell.soft_radius"),
        _below_the_middle,
    ),
    Rule(("space.rows", "tissue.cells", "tissue.dimension", "layer.shape", "space.boundary"), _rows),
    Rule(("tissue.cells", "space.rows", "tissue.dimension", "layer.shape", "space.boundary"), _fill),
    Rule(
        (
            *("tissue.cells", "tissue.dimension", "layer.shape", "space.boundary", "space.rows", "layer.perimeter"),
            *("tissue.max_basal_distance", "cell.soft_radius"),
        ),
        _dense,
    ),
    Rule(
        (
            *("tissue.cells", "tissue.dimension", "layer.shape", "space.boundary", "space.rows", "layer.perimeter"),
            *("tissue.basal_spacing", "cell.soft_radius"),
        ),
        _wide,
    ),
    Rule(
        (
            *("tissue.apical_spacing", "tissue.dimension", "tissue.basal_spacing", "layer.shape", "space.boundary"),
            "cell.soft_radius",
        ),
        _same_spacing,
    ),
    Rule(("tissue.diffusion", "tissue.dimension", "space.rows"), _calm),
    Rule(("division.rule", "tissue.dimension"), _beside),
    Rule(("emt.ac", "tissue.dimension"), _no_chains),
)


def becomes_space(base: Mapping[str, Any], changes: Mapping[str, Any]) -> bool:
    """Return whether changes make a tissue in space of a slice, and leave the number of cells open."""
    before, now = base.get("tissue", {}), changes.get("tissue", {})
    is_new = isinstance(now, Mapping) and now.get("dimension") != FLAT and "dimension" in now
    return is_new and before.get("dimension", FLAT) == FLAT and "cells" not in now


def fewest_cells(values: Mapping[str, Any]) -> int | None:
    """Return the fewest cells, not below those of the slice, that fill a tissue in space; None if no number does.

    ``values``: checked values by key, such as "tissue.cells".
    """
    rules = [rule for rule in SPACE_RULES if "tissue.cells" in rule.keys]
    if not {key for rule in rules for key in rule.keys} <= values.keys():
        return None
    for cells in range(values["tissue.cells"], MOST_TRIED):
        known = {**values, "tissue.cells": cells}
        if not any(rule.allowed(*(known[key] for key in rule.keys)) for rule in rules):
            return cells
    return None
