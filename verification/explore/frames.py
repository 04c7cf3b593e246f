"""A run of the tissue as a stream of pictures that comes while the run goes on; and how its cells will look."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import InvalidProblem
from dincl.status import Status
from tissue.events.known import EVENTS
from tissue.files.quantities import Quantity
from tissue.frames.frame import Frame
from tissue.frames.observables import is_measurable, phases
from tissue.model.measures import measure
from tissue.pictures.emt import chains, colours_of, free_points
from tissue.pictures.picture import box_of
from tissue.pictures.sheet import COLOURS, GREY, TYPE_COLOURS
from tissue.runs.batch import Batch, output_steps
from tissue.state.cells import CellLayers, Cells
from tissue.state.running import APICAL, BASAL, CELLS
from tissue.state.space import Sheets
from tissue.state.surface import PLANE
from verification.explore.ensemble import Cancelled
from verification.explore.streams import ending, message

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.cells import Emt, Floats, Integers


# Of cells of no named type, where colours tell types apart.
UNNAMED_COLOURS = (GREY, "#e8590c")
# Of the basal layer, where it bends.
POINTS = 361


def events_to_come(emt: Emt, kept: Floats) -> set[int]:
    """Return the sets of events that EMT cells will have at the output times [h], which begin with the start.

    An event begins in the first step whose end is not before its time; all times are drawn at the start.
    """
    if not len(emt.side):
        return set()
    first = np.searchsorted(kept, emt.at)  # (events, m): from which output time on
    bits = 1 << np.arange(len(first))
    sets = [(bits[:, None] * (first <= k)).sum(axis=0) for k in np.unique(np.append(first[first < len(kept)], 0))]
    return set(np.concatenate(sets).tolist())


def looks_of(begun: set[int]) -> tuple[list[dict[str, str]], Integers]:
    """Return the styles of EMT cells with these sets of events, and by each set its place among them."""
    colours = colours_of(begun)
    places = {name: place for place, name in enumerate(colours)}
    looks = [{"name": name, "colour": colour} for name, colour in colours.items()]
    of_events = np.full(max(begun, default=-1) + 1, -1)
    for events in begun:
        of_events[events] = places[EVENTS[events]]
    return looks, of_events


def phases_and_types(parameters: Parameters) -> dict[str, Any]:
    """Return the phases of control cells, and the types by their numbers."""
    kinds = zip(parameters.type_names, (*UNNAMED_COLOURS, *TYPE_COLOURS), strict=False)
    return {
        "phases": [{"name": name, "colour": colour} for name, colour in COLOURS.items()],
        "types": [{"name": name, "colour": colour} for name, colour in kinds],
    }


def basal_layer(parameters: Parameters) -> dict[str, Any]:
    """Return the polygon of the basal layer [um], none for a line, and on which side the tissue is."""
    curve, um = parameters.curve(), parameters.cell.soft_radius.value
    if curve.pieces == 0:
        return {"layer": [], "closed": False, "inside": False, "ring": False}
    points = um * curve.evaluate(np.linspace(0.0, curve.length, POINTS) - curve.origin)[0].T
    inside = curve.around and curve.area > 0
    return {"layer": points.round(3).tolist(), "closed": curve.around, "inside": inside, "ring": curve.ring}


MOST = 160  # output times after the start: the player draws what is between them
CHUNK = 0.015  # seconds of work that are sent together
# The columns of a frame: the id, lengths [um], and these others, counted from the last one.
PHASE, KIND, LOOK, FREE, OTHERS = -5, -4, -3, -2, 6
FREE_APICAL, FREE_BASAL = 1, 2


def stream(parameters: Parameters, seed: int, stopped: Callable[[], bool] = lambda: False) -> Iterator[bytes]:
    """Run a tissue and give its pictures as they come, several messages of ``explore.streams`` joined.

    The cells are those of ``tissue.simulate`` with these parameters and seed, at up to 161 times: when states are kept
    changes no run. The first picture comes with the head, before the first step.

    Parameters
    ----------
    parameters
        From ``load`` or ``preset``; the times that they keep are not looked at.
    seed
        An integer >= 0.
    stopped
        Asked every now and then: once it says True the stream ends there, without a last message.

    Raises
    ------
    InvalidProblem
        As ``tissue.simulate``, before anything is given.
    """

    def ask() -> None:
        if stopped():
            raise Cancelled

    kind = _SheetPictures if parameters.in_space else _Pictures
    run = kind(finely_kept(parameters), seed)
    joined, begun = [run.head()], perf_counter()
    with suppress(Cancelled):
        for t in run.batch.times(ask):
            ask()
            joined.append(run.picture(t))
            if t == 0 or perf_counter() - begun > CHUNK:
                yield b"".join(joined)
                joined, begun = [], perf_counter()
            if not run.batch.goes_on(0):
                break
        yield b"".join((*joined, ending(run.batch.status(0), run.batch.failure(0))))


def finely_kept(parameters: Parameters) -> Parameters:
    """Return the parameters with output times that are fine enough for a smooth picture: whole dt, at most 160."""
    dt = parameters.numerics.dt.value
    every = -(-round(parameters.t_end / dt) // MOST)
    numerics = parameters.numerics.model_copy(update={"keep": Quantity(every * dt, "h")})
    return parameters.model_copy(update={"numerics": numerics})


class _Pictures:
    """A run whose states are written as messages."""

    painter = "tissue"
    lengths: tuple[str, ...] = ("x", "y", "ax", "ay", "bx", "by", "radius")

    def __init__(self, parameters: Parameters, seed: int) -> None:
        self.batch, self._parameters, self._um = (
            Batch(parameters, [seed]),
            parameters,
            parameters.cell.soft_radius.value,
        )
        self._curve, self._numbers, self._named = parameters.curve(), parameters.numbers(), parameters.named_numbers()
        kept = np.array([0, *output_steps(parameters)]) * parameters.numerics.dt.value
        self._looks, self._places = looks_of(events_to_come(self.batch.state(0).emt, kept))

    def head(self) -> bytes:
        """Return what holds for the whole run."""
        box = box_of([self._seen(0.0)], self._parameters)
        common = {"kind": "head", "painter": self.painter, "unit": "µm", "timeUnit": "h", "end": self._parameters.t_end}
        own = {"box": [float(side) for side in box], "soft": self._um, "looks": self._looks}
        return message({**common, **own, **phases_and_types(self._parameters), **self._layer()})

    def picture(self, t: float) -> bytes:
        """Return the present state, at time t; none of a state that is not finite."""
        frame = self._seen(t)
        if not self.batch.goes_on(0):
            frame = self.batch.frame(0, t)
            if self.batch.status(0) is Status.NON_FINITE or not is_measurable(frame):
                return b""
        columns = np.empty((len(self.lengths) + OTHERS, len(frame.cells.x)), "<f4")
        measured = self._scaled(columns[-1])
        self._write(frame, columns)
        linked = self._write_emt(frame, columns.view("<i4"))
        further, members = self._further(frame, linked)
        header = {"kind": "frame", "t": frame.t, "cells": len(frame.cells.x), **measured, **further}
        return message(header, columns.tobytes() + np.concatenate(members).astype("<i4").tobytes())

    def _layer(self) -> dict[str, Any]:
        """Return the basal layer, for the head."""
        return basal_layer(self._parameters)

    def _further(self, frame: Frame, linked: list[Any]) -> tuple[dict[str, Any], list[Any]]:
        """Return what stands behind the columns: for the header, and the members of layers and chains."""
        sizes = {"layer": len(frame.layers.apical), "chains": [len(members) for members in linked]}
        return sizes, [frame.layers.apical, *linked]

    def _seen(self, t: float) -> Frame:
        """Return the present state where it is, without a copy: as long as the run does not go on."""
        store = self.batch.state(0)
        n, apical, basal = store.sizes[CELLS], store.sizes[APICAL], store.sizes[BASAL]
        layers = CellLayers(store.layers.apical[:apical], store.layers.basal[:basal])
        return Frame(t, Cells._make(array[:n] for array in store.cells), layers, self._curve)

    def _scaled(self, positions: Any) -> dict[str, Any]:
        """Write y_AB, zeros where it cannot be measured; return the height [um], None where it means nothing, and why
        the apical layer is folded.
        """
        state = self.batch.state(0)
        found = self.batch.measures[0] or (measure(state) if state.sizes[APICAL] else None)
        if found is None or not np.isfinite(found.positions.y_ab).all():
            positions[:] = 0.0
            return {"height": None, "folded": "" if found is None else found.fold}
        positions[:] = found.positions.y_ab
        return {"height": None if found.fold else self._um * found.extents.height, "folded": found.fold}

    def _write(self, frame: Frame, columns: Any) -> None:
        """Write the columns of all cells."""
        cells, whole = frame.cells, columns.view("<i4")
        for place, name in enumerate(self.lengths, 1):
            np.multiply(getattr(cells, name), self._um, out=columns[place], casting="same_kind")
        whole[0], whole[KIND] = cells.id, cells.kind
        whole[PHASE] = phases(frame, self._numbers, self._named)

    def _write_emt(self, frame: Frame, whole: Any) -> list[Any]:
        """Write the columns of EMT cells; return the members of each of their chains."""
        whole[LOOK], whole[FREE] = -1, 0
        if not len(self._places):
            return []
        np.copyto(whole[LOOK], self._places[frame.cells.events], where=frame.cells.emt >= 0, casting="same_kind")
        apical, basal = free_points(frame)
        whole[FREE] = FREE_APICAL * apical + FREE_BASAL * basal
        return list(chains(frame)) if frame.cells.chain.any() else []


class _SheetPictures(_Pictures):
    """A run in three dimensions: with z, and the triangles of the apical network in place of layers."""

    painter = "sheet"
    lengths = ("x", "y", "z", "ax", "ay", "az", "bx", "by", "bz", "radius")

    def _layer(self) -> dict[str, Any]:
        """Return the basal surface, its periods, and how far sections may be moved [um]."""
        frame = self._seen(0.0)
        sheets, um = _sheets_of(frame), self._um
        surface = sheets.surface
        periods = [um * period if math.isfinite(period) else None for period in (surface.period_x, surface.period_z)]
        depths = np.concatenate((frame.cells.z, frame.cells.bz))
        half = surface.period_z / 2 if periods[1] else 0.0
        deep = (-half, half) if half else (depths.min() - 1.0, depths.max() + 1.0)
        round_one = surface.bends != PLANE
        told = {"bends": surface.bends, "radius": um * surface.radius if round_one else None, "side": surface.side}
        return {"surface": told, "periods": periods, "deep": [um * float(end) for end in deep]}

    def _further(self, frame: Frame, _: list[Any]) -> tuple[dict[str, Any], list[Any]]:
        triangles = _sheets_of(frame).apical.triangles
        return {"triangles": len(triangles)}, [triangles.ravel()]

    def _seen(self, t: float) -> Frame:
        """Return a copy of the present state: the networks are read where nothing changes them."""
        return self.batch.frame(0, t)


def _sheets_of(frame: Frame) -> Sheets:
    if frame.sheets is None:
        raise InvalidProblem(f"frame of t = {frame.t:g} h: must be of a tissue in three dimensions")
    return frame.sheets
