"""A run as tables for pandas; the observables of the summary. Lengths in um, times in hours."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from tissue.events.known import EVENTS
from tissue.frames import observables
from tissue.frames.observables import PHASES, ab_positions, areas, extruded, measurable, phases, widths
from tissue.plugins import Observable, registered

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.frames.frame import Frame
    from tissue.state.cells import Integers


def _plain(name: str, meaning: str, measure: Callable[[Frame], float], unit: str = "") -> Observable:
    """Return a number or a time."""
    return Observable(name, meaning, lambda frame, parameters: measure(frame), unit)


def _length(name: str, meaning: str, measure: Callable[[Frame], float]) -> Observable:
    """Return a length, from R_soft to um."""

    def in_um(frame: Frame, parameters: Parameters) -> float:
        return parameters.cell.soft_radius.value * measure(frame)

    return Observable(name, meaning, in_um, "um")


def _area(name: str, meaning: str, measure: Callable[[Frame], float]) -> Observable:
    """Return an area, from R_soft^2 to um^2."""

    def in_um2(frame: Frame, parameters: Parameters) -> float:
        return parameters.cell.soft_radius.value**2 * measure(frame)

    return Observable(name, meaning, in_um2, "um2")


BUILT_IN = (
    _plain("time", "t", lambda frame: frame.t, "h"),
    _plain("cells", "N", lambda frame: len(frame.cells.x)),
    _plain("divisions", "into two cells of the plane", lambda frame: int((frame.cells.mother >= 0).sum())),
    _length("height", "mean height of the apical layer", observables.height),
    _length("nucleus_height", "mean height of the nuclei", observables.nucleus_height),
    _length("apical_width", "extent in x of the apical layer", lambda frame: widths(frame).apical),
    _length("basal_width", "extent in x of the basal layer", lambda frame: widths(frame).basal),
    _length("nuclei_width", "extent in x of the centres of the nuclei", lambda frame: widths(frame).nuclei),
    _plain("nuclear_layers", "soft discs that a vertical line crosses", observables.nuclear_layers),
    _plain("mean_y_ab", "mean position on the apical-basal scale", lambda frame: float(ab_positions(frame).mean())),
    _plain("apically_extruded", "cells with y_AB > 1", lambda frame: extruded(ab_positions(frame)).apically),
    _plain("basally_extruded", "cells with y_AB < 0", lambda frame: extruded(ab_positions(frame)).basally),
)


# Of tubes alone.
TUBE = (
    _area("lumen_area", "what the tube encloses", lambda frame: areas(frame).lumen),
    _area("tissue_area", "what the cells fill between both layers", lambda frame: areas(frame).tissue),
)


def summary_columns(*, tube: bool) -> tuple[Observable, ...]:
    """Return all observables, those of the table first."""
    return (*BUILT_IN, *(TUBE if tube else ()), *registered(Observable))


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

    A state that is not finite, the last one of a run that left the finite numbers, has no rows.

    ======================================================  ========  ===============================================
    ``time_h``                                              float64   t
    ``id``, ``mother``                                      int64     of the cell; of the one it split from, or -1
    ``phase``                                               category  "G1/S", "G2" or "mitosis", in this order
    ``age_h``, ``cycle_h``                                  float64   t - t_birth; t_cycle (3.1)
    ``nucleus_x_um``, ``nucleus_y_um``                      float64   X
    ``apical_x_um``, ``apical_y_um``                        float64   A
    ``basal_x_um``, ``basal_y_um``                          float64   B
    ``hard_radius_um``                                      float64   R_hard at this time
    ``apical_rest_um``, ``basal_rest_um``                   float64   eta_ax (3.2), eta_bx (3.3), without R_soft
    ``junction_rest_um``                                    float64   eta_aa (3.6) of the junction to the next cell
    ``nucleus_z_um``, ``apical_z_um``, ``basal_z_um``       float64   in three dimensions alone: their depths
    ``y_ab``                                                float64   position on the apical-basal scale (3.3.1)
    ``in_apical_layer``, ``in_basal_layer``                 bool      whether it has neighbours there
    ``migrates``, ``divides``                               bool      whether it has INM; may get a second daughter
    ``emt``                                                 int64     number among the EMT cells; -1: control
    ``events``                                              str       EMT events that have begun: "", "A", ..., "ABSP"
    ``type``                                                str       "control", "emt", or the name of a type
    ======================================================  ========  ===============================================
    """
    columns = [dict(_of_cells(frame, parameters)) for frame in measurable(frames)]
    return pd.DataFrame({name: _joined([part[name] for part in columns]) for name in columns[0]})


def summary_table(frames: Iterable[Frame], parameters: Parameters) -> pd.DataFrame:
    """Return one row for each output time; the observables of ``tissue.runs.tables``.

    A state that is not finite has no row. Observables that were registered have columns of their own, behind these.

    ======================================================  ========  ===============================================
    ``time_h``                                              float64   t
    ``cells``                                               int64     N
    ``divisions``                                           int64     into two cells of the plane, since the start
    ``height_um``, ``nucleus_height_um``                    float64   mean height of the apical layer; of the nuclei
    ``apical_width_um``, ``basal_width_um``                 float64   extent in x of the layers
    ``nuclei_width_um``                                     float64   extent in x of the centres of the nuclei
    ``nuclear_layers``                                      float64   soft discs that a vertical line crosses
    ``mean_y_ab``                                           float64   mean position on the apical-basal scale
    ``apically_extruded``, ``basally_extruded``             int64     cells with y_AB > 1, with y_AB < 0  (4.3)
    ``lumen_area_um2``, ``tissue_area_um2``                 float64   of tubes alone: what they enclose, what they fill
    ======================================================  ========  ===============================================
    """
    shown = summary_columns(tube=parameters.curve().ring)
    return pd.DataFrame([{one.column: one.of(frame, parameters) for one in shown} for frame in measurable(frames)])


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
    yield "y_ab", ab_positions(frame)
    yield from (("in_apical_layer", np.isin(each, layers.apical)), ("in_basal_layer", np.isin(each, layers.basal)))
    yield from (("migrates", cells.moves), ("divides", cells.divides))
    yield from (("emt", cells.emt), ("events", _names(cells.events)))
    yield "type", np.array(parameters.type_names)[cells.kind]


def _names(begun: Integers) -> Any:
    """Return the events of each cell."""
    kinds, each = np.unique(begun, return_inverse=True)
    return np.array([EVENTS[k] for k in kinds])[each]


def _joined(parts: Sequence[Any]) -> Any:
    if isinstance(parts[0], pd.Categorical):
        return pd.api.types.union_categoricals(parts)
    return np.concatenate(parts)
