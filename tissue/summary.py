"""The observables of the summary table, in the order of its columns; what is registered follows."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from tissue.model import observables
from tissue.model.observables import ab_positions, areas, extruded, widths
from tissue.observable import Observable
from tissue.registry import registered

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.frame import Frame


def _plain(name: str, meaning: str, measure: Callable[[Frame], float], unit: str = "") -> Observable:
    """A number or a time."""
    return Observable(name, meaning, lambda frame, parameters: measure(frame), unit)


def _length(name: str, meaning: str, measure: Callable[[Frame], float]) -> Observable:
    """A length, from R_soft to um."""

    def in_um(frame: Frame, parameters: Parameters) -> float:
        return parameters.cell.soft_radius.value * measure(frame)

    return Observable(name, meaning, in_um, "um")


def _area(name: str, meaning: str, measure: Callable[[Frame], float]) -> Observable:
    """An area, from R_soft^2 to um^2."""

    def in_um2(frame: Frame, parameters: Parameters) -> float:
        return parameters.cell.soft_radius.value**2 * measure(frame)

    return Observable(name, meaning, in_um2, "um2")


HOUSE = (
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
    """All observables, those of the table first."""
    return (*HOUSE, *(TUBE if tube else ()), *registered(Observable))
