"""How the cells of a run will look, known before it begins: what a legend has, in the colours of the pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tissue.events.known import EVENTS
from tissue.pictures.emt import colours_of
from tissue.pictures.sheet import COLOURS, GREY, TYPE_COLOURS

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.cells import Emt, Floats, Integers

MAKES_NO_NUMBERS = True

# Of cells of no named type, where colours tell types apart.
UNNAMED_COLOURS = (GREY, "#e8590c")
# Of the basal layer, where it bends.
POINTS = 361


def events_to_come(emt: Emt, kept: Floats) -> set[int]:
    """The sets of events that EMT cells will have at the kept times [h], which begin with the start.

    An event begins in the first step whose end is not before its time; all times are drawn at the start.
    """
    if not len(emt.side):
        return set()
    first = np.searchsorted(kept, emt.at)  # (events, m): from which kept time on
    bits = 1 << np.arange(len(first))
    sets = [(bits[:, None] * (first <= k)).sum(axis=0) for k in np.unique(np.append(first[first < len(kept)], 0))]
    return set(np.concatenate(sets).tolist())


def looks_of(begun: set[int]) -> tuple[list[dict[str, str]], Integers]:
    """The looks of EMT cells with these sets of events, and by each set its place among them; empty without any."""
    colours = colours_of(begun)
    places = {name: place for place, name in enumerate(colours)}
    looks = [{"name": name, "colour": colour} for name, colour in colours.items()]
    of_events = np.full(max(begun, default=-1) + 1, -1)
    for events in begun:
        of_events[events] = places[EVENTS[events]]
    return looks, of_events


def phases_and_types(parameters: Parameters) -> dict[str, Any]:
    """The phases of control cells, and the types by their numbers."""
    kinds = zip(parameters.type_names, (*UNNAMED_COLOURS, *TYPE_COLOURS), strict=False)
    return {
        "phases": [{"name": name, "colour": colour} for name, colour in COLOURS.items()],
        "types": [{"name": name, "colour": colour} for name, colour in kinds],
    }


def basal_layer(parameters: Parameters) -> dict[str, Any]:
    """The polygon of the basal layer [um], none for a line, and on which side the tissue is."""
    curve, um = parameters.curve(), parameters.cell.soft_radius.value
    if curve.pieces == 0:
        return {"layer": [], "closed": False, "inside": False, "ring": False}
    points = um * curve.course(np.linspace(0.0, curve.length, POINTS) - curve.origin)[0].T
    inside = curve.around and curve.area > 0
    return {"layer": points.round(3).tolist(), "closed": curve.around, "inside": inside, "ring": curve.ring}
