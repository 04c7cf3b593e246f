"""The colours of cells: of control cells those of their cycle phase, of EMT cells those of their events."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tissue.events.known import EVENTS
from tissue.files.frame import Frame
from tissue.files.parameters import Parameters
from tissue.model.observables import PHASES, phases
from tissue.pictures.emt import EmtLook
from tissue.pictures.sheet import COLOURS, TYPE_COLOURS

MAKES_NO_NUMBERS = True


def colours_of_cells(frame: Frame, parameters: Parameters, look: EmtLook) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
    """Of the disc or ball of each cell, and of the edge of its hard disc."""
    cells, is_emt = frame.cells, frame.cells.emt >= 0
    phase = phases(frame, parameters.numbers(), parameters.named_numbers())
    of_phase = np.array([COLOURS[name] for name in PHASES])[phase]
    of_events = np.array([look.colours[EVENTS[k]] if own else "" for k, own in zip(cells.events, is_emt, strict=True)])
    of_type = np.array(("", "", *TYPE_COLOURS))[cells.kind]
    return np.where(is_emt, of_events, of_phase), np.where(of_type == "", np.where(is_emt, "black", "white"), of_type)
