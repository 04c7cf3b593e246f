"""Which values of several sections go together: checks raise InvalidProblem with key, value and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from dincl.errors import InvalidProblem
from tissue.events.division import BESIDE
from tissue.files.groups import first_of
from tissue.files.quantities import MOST_CELLS, NEVER
from tissue.files.sections import (
    CHAINS,
    OWN_KEYS,
    PAIR_KEYS,
    ROUNDING,
    SCATTERED,
    Cell,
    EmtGroup,
    Tissue,
    TypeKeys,
    above,
    curve_of,
    show,
    wrong,
)
from tissue.kernels.surface_workspace import SHORTEST_PERIOD
from tissue.model.stiffness import LIMIT, cell_stiffness, junction_stiffness, least_substeps
from tissue.network.lattice import FEWEST, ROW, rows_of
from tissue.state.cells import PARAMETERS

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters

SHAPES = {2: ("line", "circle", "ellipse", "points"), 3: ("line", "circle", "sphere")}
IN = {2: "in a slice", 3: "in three dimensions"}
# Numbers of cells, on either side of the one that is given, among which one is looked for that makes a sheet.
MOST_TRIED = 10_000


def check(parameters: Parameters) -> None:
    """Check all that concerns more than one section."""
    tissue, layer, unit = parameters.tissue, parameters.layer, parameters.cell.soft_radius
    named = parameters.types.named()
    of_users = {"own": parameters.own.values()}
    of_users |= {f"types.{name}.own": one.own.given() for name, one in named.items() if one.own}
    for where, values in of_users.items():
        for name, value in values.items():
            if not PARAMETERS[name].fits(value, unit.value):
                raise wrong(f"{where}.{name}", value, PARAMETERS[name].allowed)
    shapes = SHAPES[tissue.dimension]
    if layer.shape not in shapes:
        raise wrong("layer.shape", layer.shape, f"{' or '.join(map(show, shapes))} {IN[tissue.dimension]}")
    curvature = curve_of(layer, unit).largest_curvature
    if curvature * tissue.height.over(unit) >= 1:
        most = f"below {1 / curvature:.4g} R_soft, the smallest curvature radius of the basal layer"
        raise wrong("tissue.height", tissue.height, f"{most} on the side of the tissue")
    if parameters.in_space:
        _check_space(parameters)
    elif layer.shape == "line":
        _check_room(parameters)
    check_groups(named, tissue.cells, parameters.emt)
    _check_cells(parameters, tissue, parameters.cell, "tissue", "cell")
    for name, one in named.items():
        of_type, cell = parameters.of_type(one)
        try:
            cell.check(unit)
        except InvalidProblem as error:
            raise InvalidProblem(f"types.{name}.{error}") from None
        _check_cells(parameters, of_type, cell, f"types.{name}", f"types.{name}")
    junctions = parameters.rules.junction_factor * parameters.cell.alpha_aa
    stiffness = junction_stiffness(junctions, tissue.cells, in_space=parameters.in_space)
    _check_steps(parameters, stiffness, "of junctions (cell.alpha_aa)")


def _check_cells(parameters: Parameters, tissue: Tissue, cell: Cell, of_tissue: str, of_cell: str) -> None:
    """Check values of all cells, or of a type, with those of other sections; ``of_tissue``, ``of_cell``: where."""
    unit, curve = parameters.cell.soft_radius, parameters.curve()
    largest = tissue.max_basal_distance.over(unit)
    if curve.ring and tissue.cells * largest < curve.length * (1 - ROUNDING):
        least = math.ceil(curve.length / largest * (1 - ROUNDING))
        around = f"of fewer the basal points do not go around, {curve.length:.4g} R_soft, within (C2)"
        raise wrong("tissue.cells", tissue.cells, f"at least {least}: {around}")
    if above(tissue.basal_spacing.over(unit), largest):
        most = f"at most {of_tissue}.max_basal_distance = {show(tissue.max_basal_distance)}"
        raise wrong("tissue.basal_spacing", tissue.basal_spacing, f"{most}: otherwise the start breaks (C2)")
    stiffness = cell_stiffness(parameters.numbers_of(tissue, cell))
    _check_steps(parameters, stiffness, f"of cells ({of_cell}.alpha_ax, alpha_bx, alpha_axb, alpha_xx)")


def _check_room(parameters: Parameters) -> None:
    """Check that all hard discs of a straight slice have the area to lie side by side where they begin.

    Parting more would take hours. Near the bound it can still fail, which the start says.
    """
    tissue, start, unit = parameters.tissue, parameters.start, parameters.cell.soft_radius
    d, (low, high) = 2 * parameters.cell.hard_radius.over(unit), start.nuclei_height
    up = (high - low) * tissue.height.over(unit) + d
    # Above their own basal points the room grows with the number of cells.
    each = tissue.basal_spacing.over(unit) if start.nuclei == "own_basal" else 0.0
    width, needed = tissue.width.over(unit) if each == 0 else -each, math.pi / 4 * d**2 - up * each
    if needed > 0 and tissue.cells > (most := int(up * (width + d) / needed)):
        raise wrong("tissue.cells", tissue.cells, f"at most {most}: there is no room for more hard discs")


def _check_steps(parameters: Parameters, stiffness: float, of: str) -> None:
    """Check that substeps are stable."""
    dt, mu, substeps = parameters.numerics.dt.value, parameters.numerics.mu.value, parameters.numerics.substeps
    least = least_substeps(dt, mu, stiffness)
    if substeps < least:
        most = f"{LIMIT / stiffness:.6g}, 2 over the stiffness {of}, to be stable"
        step = f"dt/(substeps mu) = {dt / mu / substeps:.6g} must be below {most}"
        raise wrong("numerics.substeps", substeps, f"at least {least}: {step}")


def check_groups(types: Mapping[str, TypeKeys], cells: int, emt: EmtGroup) -> None:
    """Check that each group has room among so many cells, ``emt`` in the middle, and that two cells keep the layers."""
    before, leaving, first = 0, 0, (cells - emt.cells) // 2
    for name, one in {"emt": emt, **{f"types.{name}": one for name, one in types.items()}}.items():
        most, what = cells - before, f"other groups have {before} of {cells} cells"
        if one.lets_go and cells - 2 - leaving < most:
            most, what = cells - 2 - leaving, f"two of {cells} cells at least stay in both layers"
        if one.cells > max(0, most):
            raise wrong(f"{name}.cells", one.cells, f"at most {max(0, most)}: {what}")
        before, leaving = before + one.cells, leaving + one.cells * one.lets_go
    taken = {"emt": range(first, first + emt.cells)}
    for name, one in types.items():
        if isinstance(one.place, str):
            continue
        begin = first_of(cells, one.cells, one.place)
        mine = range(begin, begin + one.cells)
        for other, theirs in taken.items():
            if max(mine.start, theirs.start) < min(mine.stop, theirs.stop):
                overlap = f"its cells {_span(mine)} from the left overlap with {_span(theirs)} of [{other}]"
                raise wrong(f"types.{name}.place", one.place, f"elsewhere, or {show(SCATTERED)}: {overlap}")
        taken[f"types.{name}"] = mine


def _span(cells: range) -> str:
    return f"{cells.start + 1} to {cells.stop}" if len(cells) > 1 else f"{cells.start + 1}"


def _check_space(parameters: Parameters) -> None:
    """Check what holds in three dimensions."""
    tissue, layer, space, unit = parameters.tissue, parameters.layer, parameters.space, parameters.cell.soft_radius
    apical, basal = tissue.apical_spacing, tissue.basal_spacing
    if layer.shape == "sphere":
        radius = layer.perimeter.over(unit) / (2.0 * math.pi)
        if layer.side == "inside" and tissue.height.over(unit) >= radius:
            raise wrong("tissue.height", tissue.height, f"below {radius:.4g} R_soft, the radius of the basal surface")
    else:
        _check_rows(parameters)
    _check_size(parameters)
    off = abs(apical.over(unit) - basal.over(unit))
    if layer.shape == "line" and space.boundary == "periodic" and off > ROUNDING * basal.over(unit):
        raise wrong("tissue.apical_spacing", apical, f"tissue.basal_spacing = {show(basal)} {IN[3]}")
    times = {f"emt.{name}": time for name, time in parameters.emt.times().items()}
    if (chains := times[f"emt.{CHAINS}"]).ever:
        raise wrong(f"emt.{CHAINS}", chains, f"{show(NEVER)} {IN[3]}: there are no chains")
    if parameters.division.rule != BESIDE.name:
        raise wrong("division.rule", parameters.division.rule, f"{show(BESIDE.name)} {IN[3]}")
    for name, one in parameters.types.named().items():
        for key in one.changes().keys() & set(PAIR_KEYS):
            all_cells = f"{OWN_KEYS[key]}.{key}"
            raise wrong(f"types.{name}.{key}", one.changes()[key], f"left to {all_cells} {IN[3]}")


def _check_rows(parameters: Parameters) -> None:
    """Check what concerns the rows of a plane or cylinder, whatever the number of cells."""
    tissue, layer, space, unit = parameters.tissue, parameters.layer, parameters.space, parameters.cell.soft_radius
    apart = ROW * tissue.basal_spacing.over(unit)
    if space.rows % 2 or 0 < space.rows < FEWEST:
        raise wrong("space.rows", space.rows, f"an even number, {FEWEST} or more, or 0")
    if space.boundary == "periodic" and layer.shape == "line" and 0 < space.rows * apart <= SHORTEST_PERIOD:
        least = 2 * math.floor(SHORTEST_PERIOD / (2.0 * apart)) + 2
        raise wrong("space.rows", space.rows, f"at least {least}, or 0: {_repeats(space.rows * apart)}")


def _check_size(parameters: Parameters) -> None:
    """Check that the cells make a sheet; the message names the nearest numbers of cells that do."""
    cells, emt, types = parameters.tissue.cells, parameters.emt, parameters.types.named()
    fault = _size_fault(parameters, cells)
    if not fault:
        return

    def fits(cells: int) -> bool:
        try:
            check_groups(types, cells, emt)
        except InvalidProblem:
            return False
        return not _size_fault(parameters, cells)

    sides = (
        range(cells - 1, max(0, cells - MOST_TRIED), -1),
        range(cells + 1, min(cells + MOST_TRIED, MOST_CELLS) + 1),
    )
    near = [str(n) for side in sides if (n := next(filter(fits, side), None))]
    nearest = f", the nearest {'are' if len(near) > 1 else 'is'} {' and '.join(near)}" if near else ""
    raise wrong("tissue.cells", cells, f"a size that fits{nearest}: {fault}")


def _size_fault(parameters: Parameters, cells: int) -> str:
    """Return why so many cells make no sheet; "" if they do."""
    layer, space, unit = parameters.layer, parameters.space, parameters.cell.soft_radius
    around, spacing = layer.perimeter.over(unit), parameters.tissue.basal_spacing.over(unit)
    largest, too_few = (
        parameters.tissue.max_basal_distance.over(unit),
        "of so few the basal points do not go around (C2)",
    )
    if layer.shape == "sphere":
        return too_few if above(around**2 / math.pi / (ROW * largest**2), cells) else ""
    try:
        rows = rows_of(cells, space.rows)
    except InvalidProblem:
        return f"columns times {space.rows or 'an even number of'} rows, {FEWEST} or more of each"
    columns = cells / rows
    if layer.shape == "circle":
        spacing = around / columns
        if above(spacing, largest):
            return too_few
    period = min(rows * ROW, columns) * spacing
    return _repeats(period) if space.boundary == "periodic" and period <= SHORTEST_PERIOD else ""


def _repeats(period: float) -> str:
    must = f"must after more than {SHORTEST_PERIOD:g}, twice the range of nuclei"
    return f"the sheet repeats after {period:.4g} R_soft, and {must}"
