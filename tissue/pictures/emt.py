"""Appearance of EMT cells: a colour for each set of events, points that have left their layer, chains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from tissue.events.known import EVENTS

if TYPE_CHECKING:
    from tissue.frames.frame import Frame
    from tissue.state.cells import Flags, Integers


# By the events that have begun: lighter than control cells or of another hue, the redder for [P], blue-green for [AC].
EMT_COLOURS = {
    "": "#bdbdbd",
    "A": "#009e73",
    "B": "#cc79a7",
    "S": "#8c6d31",
    "AB": "#3a3a3a",
    "AS": "#5f7a1f",
    "BS": "#a0527d",
    "BP": "#e8590c",
    "ABS": "#7d7d7d",
    "ABP": "#c1121f",
    "BSP": "#f4894b",
    "ABSP": "#67000d",
    "AC": "#17becf",
    "AAC": "#0b6e75",
    "BAC": "#9467bd",
    "ABAC": "#4b2e83",
}
# Of all other sets, those with events of users among them.
OTHER_COLOURS = ("#7cb342", "#ff8fb1", "#5d4037", "#c0ca33", "#a1887f", "#00695c", "#d7a6e8", "#9e0059")


def event_colours(frames: Sequence[Frame]) -> dict[str, str]:
    """Return the sets of events that EMT cells of these states have, in the order of the legend, with their colours."""
    return colours_of({int(k) for frame in frames for k in frame.cells.events[frame.cells.emt >= 0]})


def colours_of(begun: set[int]) -> dict[str, str]:
    """Choose a colour for each set of events, by name; without a colour of its own by the events alone."""
    names = {EVENTS[k]: k for k in sorted(begun)}
    found = {name: colour for name, colour in EMT_COLOURS.items() if name in names}
    for name in (name for name in names if name not in EMT_COLOURS):
        begin = names[name] >> 4
        turned = [OTHER_COLOURS[(begin + k) % len(OTHER_COLOURS)] for k in range(len(OTHER_COLOURS))]
        found[name] = next((colour for colour in turned if colour not in found.values()), turned[0])
    return found


def label_of(events: str) -> str:
    """Return the entry of a legend for EMT cells with a set of events."""
    return f"EMT: {f'[{events}]' if events else 'no event yet'}"


def free_points(frame: Frame) -> tuple[Flags, Flags]:
    """Return whether each cell is an EMT cell whose apical, whose basal point has left its layer."""
    is_emt = frame.cells.emt >= 0
    apical, basal = is_emt.copy(), is_emt.copy()
    apical[frame.layers.apical] = False
    basal[frame.layers.basal] = False
    return apical, basal


def chains(frame: Frame) -> Iterator[Integers]:
    """Give the cells of each chain of two or more that have left the apical layer together, in their order."""
    for number in np.unique(frame.cells.chain[frame.cells.chain > 0]):
        members = np.flatnonzero(frame.cells.chain == number)
        if len(members) > 1:
            yield members
