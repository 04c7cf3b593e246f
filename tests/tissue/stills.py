"""States to draw, and where a picture has a colour."""

from functools import cache

import numpy as np
from matplotlib.colors import to_rgb

from tests.tissue.states import layers, tissue
from tissue.events.known import EVENTS
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.pictures.picture import stills
from tissue.runs.simulate import simulate

THESIS = preset("thesis")
UM = 5.0
AGES = {"G1/S": 3.0, "G2": 14.2, "mitosis": 14.7}


def pair(phase="mitosis", distance=12.0, radius=0.7, t=0.0):
    """Two cells that stand upright, of one phase, this far apart."""
    x, a, b = ([[0.0, y], [distance, y]] for y in (4.0, 8.0, 0.0))
    state = tissue(x, a, b, radius=radius, birth=t - AGES[phase], cycle=15.0)
    return Frame(t, state, layers(2))


def drawn(frame):
    return next(iter(stills([frame], THESIS)))


def coloured(still, colour, tolerance=3):
    """Where the picture has this colour: rows and columns of the panel, without the legend below."""
    found = np.abs(still.astype(int) - np.round(255 * np.array(to_rgb(colour)))).max(axis=2) <= tolerance
    return np.nonzero(found[:-90])


@cache
def two_hours():
    """A run, a state every half hour."""
    return simulate(THESIS.changed({"numerics.t_end": "2 h", "numerics.keep": "0.5 h"}), 1)


def trio(events="A"):
    """Two control cells and one EMT cell with these events in the middle."""
    x, a, b = ([[0.0, y], [6.0, y], [12.0, y]] for y in (4.0, 8.0, 0.0))
    state = tissue(x, a, b, cycle=15.0, emt=[-1, 0, -1], events=[0, EVENTS.index(events), 0])
    kept = {"apical": [0, 2] if "A" in events else None, "basal": [0, 2] if "B" in events else None}
    return Frame(0.0, state, layers(3, **kept))
