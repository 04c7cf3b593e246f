"""A run of the tissue as a stream of pictures that comes while the run goes on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.status import Status
from tissue.explore.ensemble import NotWanted
from tissue.explore.looks import basal_layer, events_to_come, looks_of, phases_and_types
from tissue.explore.messages import ending, message
from tissue.explore.scaled import scaled
from tissue.files.frame import Frame
from tissue.files.units import Measure
from tissue.model.observables import is_measurable, phases
from tissue.pictures.emt import chains, free_points
from tissue.pictures.picture import box_of
from tissue.runs.batch import Lot, kept_steps
from tissue.state.cells import CellLayers, Cells
from tissue.state.store import APICAL, BASAL, CELLS

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters

MAKES_NO_NUMBERS = True

MOST = 160  # kept times after the start: the player draws what is between them
CHUNK = 0.015  # seconds of work that are sent together
# The columns of a frame: places of those that are integers, and of the last one; the others are lengths [um].
ID, PHASE, KIND, LOOK, FREE, SCALE, COLUMNS = 0, 8, 9, 10, 11, 12, 13
LENGTHS = ("x", "y", "ax", "ay", "bx", "by", "radius")
FREE_APICAL, FREE_BASAL = 1, 2


def stream(parameters: Parameters, seed: int, stopped: Callable[[], bool] = lambda: False) -> Iterator[bytes]:
    """Run a tissue and give its pictures as they come, several messages joined; see ``tissue.explore.messages``.

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
            raise NotWanted

    run = _Pictures(finely_kept(parameters), seed)
    joined, begun = [run.head()], perf_counter()
    with suppress(NotWanted):
        for t in run.lot.times(ask):
            ask()
            joined.append(run.picture(t))
            if t == 0 or perf_counter() - begun > CHUNK:
                yield b"".join(joined)
                joined, begun = [], perf_counter()
            if not run.lot.goes_on(0):
                break
        yield b"".join((*joined, ending(run.lot.status(0), run.lot.failure(0))))


def finely_kept(parameters: Parameters) -> Parameters:
    """The same parameters with kept times fine enough for a smooth picture: a whole number of dt, at most 160."""
    dt = parameters.numerics.dt.value
    every = -(-round(parameters.t_end / dt) // MOST)
    numerics = parameters.numerics.model_copy(update={"keep": Measure(every * dt, "h")})
    return parameters.model_copy(update={"numerics": numerics})


class _Pictures:
    """A run whose states are written as messages."""

    def __init__(self, parameters: Parameters, seed: int) -> None:
        self.lot, self._parameters, self._um = Lot(parameters, [seed]), parameters, parameters.cell.soft_radius.value
        self._curve, self._numbers, self._named = parameters.curve(), parameters.numbers(), parameters.named_numbers()
        kept = np.array([0, *kept_steps(parameters)]) * parameters.numerics.dt.value
        self._looks, self._places = looks_of(events_to_come(self.lot.store(0).emt, kept))

    def head(self) -> bytes:
        """What holds for the whole run."""
        box = box_of([self._seen(0.0)], self._parameters)
        common = {"kind": "head", "painter": "tissue", "unit": "µm", "timeUnit": "h", "end": self._parameters.t_end}
        own = {"box": [float(side) for side in box], "soft": self._um, "looks": self._looks}
        return message({**common, **own, **phases_and_types(self._parameters), **basal_layer(self._parameters)})

    def picture(self, t: float) -> bytes:
        """The present state, at time t; none of a state that is not finite."""
        frame = self._seen(t)
        if not self.lot.goes_on(0):
            frame = self.lot.frame(0, t)
            if self.lot.status(0) is Status.NON_FINITE or not is_measurable(frame):
                return b""
        columns = np.empty((COLUMNS, len(frame.cells.x)), "<f4")
        height = self._scaled(columns[SCALE])
        linked = self._write_emt(frame, columns.view("<i4"))
        self._write(frame, columns)
        header = {"kind": "frame", "t": frame.t, "cells": len(frame.cells.x), "layer": len(frame.layers.apical)}
        header |= {"height": height, "chains": [len(members) for members in linked]}
        members = np.concatenate((frame.layers.apical, *linked)).astype("<i4")
        return message(header, columns.tobytes() + members.tobytes())

    def _seen(self, t: float) -> Frame:
        """The present state where it is, without a copy: as long as the run does not go on."""
        store = self.lot.store(0)
        n, apical, basal = store.sizes[CELLS], store.sizes[APICAL], store.sizes[BASAL]
        layers = CellLayers(store.layers.apical[:apical], store.layers.basal[:basal])
        return Frame(t, Cells._make(array[:n] for array in store.cells), layers, self._curve)

    def _scaled(self, positions: Any) -> Any:
        """Write y_AB; the height [um], or None and zeros where there is no apical layer to measure by."""
        store = self.lot.store(0)
        height = self._um * scaled(store, positions) if store.sizes[APICAL] else None
        if height is None or not np.isfinite(positions).all():
            positions[:] = 0.0
            return None
        return height

    def _write(self, frame: Frame, columns: Any) -> None:
        """The columns of all cells."""
        cells, whole = frame.cells, columns.view("<i4")
        for place, name in enumerate(LENGTHS, ID + 1):
            np.multiply(getattr(cells, name), self._um, out=columns[place], casting="same_kind")
        whole[ID], whole[KIND] = cells.id, cells.kind
        whole[PHASE] = phases(frame, self._numbers, self._named)

    def _write_emt(self, frame: Frame, whole: Any) -> list[Any]:
        """The columns of EMT cells, and the members of each chain of them."""
        whole[LOOK], whole[FREE] = -1, 0
        if not len(self._places):
            return []
        np.copyto(whole[LOOK], self._places[frame.cells.events], where=frame.cells.emt >= 0, casting="same_kind")
        apical, basal = free_points(frame)
        whole[FREE] = FREE_APICAL * apical + FREE_BASAL * basal
        return list(chains(frame)) if frame.cells.chain.any() else []
