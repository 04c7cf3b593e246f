"""A run as tables for pandas; the observables of the summary. Lengths in um, times in hours."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

from tissue.events.known import EVENTS
from tissue.frames.observables import PHASES, areas, measurable, phases, state_of
from tissue.model.measures import Measures, measure
from tissue.plugins import Observable, registered
from tissue.state.cells import VARIABLES

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.frames.frame import Frame


class Column(NamedTuple):
    """A column of the summary, taken from what is measured of each frame once."""

    name: str
    meaning: str
    value: Callable[[Frame, Measures], float]
    unit: str = ""
    power: int = 0  # of R_soft, to the unit um^power: 1 for a length
    of_layer: bool = False  # whether it means nothing where the apical layer is folded

    @property
    def column(self) -> str:
        """Its name in tables."""
        return f"{self.name}_{self.unit}" if self.unit else self.name


SUMMARY_COLUMNS = (
    Column("time", "t", lambda frame, _: frame.t, "h"),
    Column("cells", "N", lambda frame, _: len(frame.cells.x)),
    Column("divisions", "into two cells of the plane", lambda frame, _: int((frame.cells.mother >= 0).sum())),
    Column("height", "mean height of the apical layer", lambda _, of: of.extents.height, "um", 1, of_layer=True),
    Column("nucleus_height", "mean height of the nuclei", lambda _, of: of.extents.nucleus_height, "um", 1),
    Column("apical_width", "extent in x of the apical layer", lambda _, of: of.extents.apical_width, "um", 1),
    Column("basal_width", "extent in x of the basal layer", lambda _, of: of.extents.basal_width, "um", 1),
    Column("nuclei_width", "extent in x of the centres of the nuclei", lambda _, of: of.extents.nuclei_width, "um", 1),
    Column("nuclear_layers", "nuclei one above the other, on average", lambda _, of: of.extents.nuclear_layers),
    Column(
        "mean_y_ab",
        "mean position on the apical-basal scale",
        lambda _, of: float(of.positions.y_ab.mean()),
        of_layer=True,
    ),
    Column(
        "apically_extruded",
        "cells with y_AB > 1; in a tube beyond the apical layer, as in its lumen",
        lambda _, of: int(of.positions.apically.sum()),
        of_layer=True,
    ),
    Column("basally_extruded", "cells with y_AB < 0", lambda _, of: int(of.positions.basally.sum()), of_layer=True),
    Column("crossings", "pairs of junctions of the apical layer that cross", lambda _, of: of.folds.crossings),
    Column("backward", "part of the apical layer that runs backwards", lambda _, of: of.folds.backward),
    Column("stretch", "length of the apical layer over that of the tissue", lambda _, of: of.folds.stretch),
    Column("controls_outside", "part of the control cells outside", lambda _, of: of.controls_outside, of_layer=True),
)


# Of tubes alone.
TUBE_COLUMNS = (
    Column("lumen_area", "what the tube encloses", lambda frame, _: areas(frame).lumen, "um2", 2, of_layer=True),
    Column("tissue_area", "what the cells fill", lambda frame, _: areas(frame).tissue, "um2", 2, of_layer=True),
)
# Names that observables of users do not take.
SUMMARY_NAMES = frozenset(("folded", *(one.name for one in (*SUMMARY_COLUMNS, *TUBE_COLUMNS))))


# Columns that are lengths, and the array of Cells each one is taken from.
LENGTHS = {
    "nucleus_x_um": "x",
    "nucleus_y_um": "y",
    "apical_x_um": "ax",
    "apical_y_um": "ay",
    "basal_x_um": "bx",
    "basal_y_um": "by",
    "hard_radius_um": "radius",
    "apical_rest_um": "rest_ax",
    "basal_rest_um": "rest_bx",
    "junction_rest_um": "rest_aa",
}


# In three dimensions these, too.
DEPTH_LENGTHS = {"nucleus_z_um": "z", "apical_z_um": "az", "basal_z_um": "bz"}


def cell_table(frames: Iterable[Frame], parameters: Parameters) -> pd.DataFrame:
    """Return one row for each output time and cell, by time, then along the tissue.

    A state that is not finite, the last one of a run that left the finite numbers, has no rows. ``y_ab`` is NaN where
    the apical layer is folded (``tissue.model.measures``), but for numerics.folded = "keep".

    The arclength begins at the lowest point of a circle or ellipse around the tissue, the
    highest one of a tissue outside; in the middle of an open curve through points, at the first point of a closed one.

    The columns: docs/reference/columns.md, ``table``.
    """
    columns = [dict(_of_cells(frame, parameters)) for frame in measurable(frames)]
    return pd.DataFrame({name: _joined([part[name] for part in columns]) for name in columns[0]})


def summary_table(frames: Iterable[Frame], parameters: Parameters) -> pd.DataFrame:
    """Return one row for each output time.

    A state that is not finite has no row. Observables that were registered have columns of their own, behind these.
    Where the apical layer is folded, ``folded`` has the reason, see ``tissue.model.measures``, and what means nothing
    then is NaN, but for numerics.folded = "keep": height, y_AB, cells and controls outside, areas.

    The columns: docs/reference/columns.md, ``summary``.
    """
    rows: list[dict[str, Any]] = []
    for frame in measurable(frames):
        found = measure(state_of(frame))
        row = summary_row(frame, found, parameters)
        rows.append({"time_h": row.pop("time_h"), "folded": found.fold or "no", **row})
    return pd.DataFrame(rows)


def summary_row(
    frame: Frame, found: Measures, parameters: Parameters, names: Collection[str] | None = None
) -> dict[str, Any]:
    """Return the columns of the summary of one state, of which ``found`` was measured; ``names``: all if None."""
    shown, own = (*SUMMARY_COLUMNS, *(TUBE_COLUMNS if parameters.curve().ring else ())), registered(Observable)
    hidden, row = found.fold and parameters.numerics.folded != "keep", {}
    for one in (one for one in shown if names is None or one.column in names):
        value = math.nan if hidden and one.of_layer else one.value(frame, found)
        row[one.column] = _um(parameters) ** one.power * value if one.power else value
    return row | {one.column: one.of(frame, parameters) for one in own if names is None or one.column in names}


def _um(parameters: Parameters) -> float:
    """R_soft in um."""
    return parameters.cell.soft_radius.value


def _of_cells(frame: Frame, parameters: Parameters) -> Iterator[tuple[str, Any]]:
    cells, layers, each = frame.cells, frame.layers, np.arange(len(frame.cells.x))
    yield "time_h", np.full(len(each), frame.t)
    yield from (("id", cells.id), ("mother", cells.mother))
    yield (
        "phase",
        pd.Categorical.from_codes(
            phases(frame, parameters.numbers(), parameters.named_numbers()), PHASES, ordered=True
        ),
    )
    yield from (("age_h", frame.t - cells.birth), ("cycle_h", cells.cycle))
    lengths = LENGTHS | (DEPTH_LENGTHS if parameters.in_space else {})
    yield from ((column, _um(parameters) * getattr(cells, name)) for column, name in lengths.items())
    if curved(parameters):
        yield from _on_layer(frame, parameters)
    found = measure(state_of(frame))
    hidden = found.fold and parameters.numerics.folded != "keep"
    yield "y_ab", np.full(len(each), math.nan) if hidden else found.positions.y_ab
    yield from (("in_apical_layer", np.isin(each, layers.apical)), ("in_basal_layer", np.isin(each, layers.basal)))
    begun, of_cell = np.unique(cells.events, return_inverse=True)
    yield from (("migrates", cells.moves), ("divides", cells.divides))
    yield from (("emt", cells.emt), ("events", np.array([EVENTS[k] for k in begun])[of_cell]))
    yield "type", np.array(parameters.type_names)[cells.kind]
    yield from ((one.column, row) for one, row in zip(VARIABLES.values(), cells.own, strict=True))


def curved(parameters: Parameters) -> bool:
    """Return whether the basal layer of a tissue bends, so that its cell table has heights and arclengths."""
    return parameters.layer.shape != "line"


def _on_layer(frame: Frame, parameters: Parameters) -> Iterator[tuple[str, Any]]:
    """Give the height of the points of all cells along the normal of the basal layer, and where along the layer."""
    for name, part in (("nucleus", ""), ("apical", "a"), ("basal", "b")):
        x, y, z = (getattr(frame.cells, part + axis) for axis in "xyz")
        yield f"{name}_height_um", _um(parameters) * frame.heights(x, y, z)
        if (along := frame.along(x, y)) is not None:
            yield f"{name}_along_um", _um(parameters) * along


def _joined(parts: Sequence[Any]) -> Any:
    if isinstance(parts[0], pd.Categorical):
        return pd.api.types.union_categoricals(parts)
    return np.concatenate(parts)
