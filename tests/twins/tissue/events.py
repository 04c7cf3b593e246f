"""The EMT events again in plain Python, cell by cell, written to be read and not to be fast.

Source: section 2.2 of chapter 4.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeVar

import numpy as np

from tests.twins.tissue.state import Tissue
from tests.twins.tissue.types import Named, of_cell
from tissue.events.known import bit, events
from tissue.frames.frame import Frame
from tissue.frames.observables import ab_positions
from tissue.state.cells import CellLayers, Cells, Emt, Flags, Floats
from tissue.state.numbers import Numbers

Arrays = TypeVar("Arrays", Cells, Emt)


class Motion(NamedTuple):
    """How the basal points move in a dt."""

    forced: Flags  # by the forces
    runs: Floats  # how far by themselves in a substep (4.1)


def motion(cells: Cells, numbers: Numbers) -> Motion:
    """By where the basal points are now: what has [P] runs down to the depth, and then rests or follows the forces."""
    protrudes = (cells.events & bit("p")) > 0
    running = protrudes & (cells.by > -numbers.run_depth)
    forced = ~protrudes | (~running & numbers.forced_below)
    return Motion(forced, np.where(running, numbers.run_speed * numbers.dt / numbers.substeps, 0.0))


def begin_events(tissue: Tissue, t: float, numbers: Numbers, named: Named = ()) -> Tissue:
    """Twin of ``kernels.rules.begin_events``."""
    cells, (apical, basal), emt = _copied(tissue.cells), tissue.layers, _copied(tissue.emt)
    positions = ab_positions(Frame(t, *tissue[:2])) if len(emt.side) else None
    for i in np.flatnonzero(cells.emt >= 0):
        k = cells.emt[i]
        times = {bit(event.name): emt.at[row, k] for row, event in enumerate(events())}
        new = sum(bit for bit, time in times.items() if t >= time and not cells.events[i] & bit)
        emt.new[k] = new
        if new and not cells.events[i] and positions is not None:
            emt.onset_ab[k] = positions[i]
        cells.events[i] += new

    def beginning(name: str) -> list[tuple[int, Numbers]]:
        """The cells in which an event begins, with the numbers of their types."""
        of_emt = np.flatnonzero(cells.emt >= 0)
        mine = of_emt[(emt.new[cells.emt[of_emt]] & bit(name)) > 0]
        return [(int(i), of_cell(numbers, named, cells.kind[i])) for i in mine]

    for i, own in beginning("a"):
        chain = np.flatnonzero(cells.chain == cells.chain[i]) if cells.chain[i] else apical
        if i in chain:
            chain = _without(chain, i, cells, numbers)
            apical, cells.chain[i] = apical if cells.chain[i] else chain, 0
            cells.stiff_ax[i] = numbers.freed_stiffness * own.alpha_ax
    for i, own in beginning("b"):
        if i in basal:
            basal = basal[basal != i]
            cells.stiff_bx[i] = numbers.freed_stiffness * own.alpha_bx
    for i, _ in beginning("s"):
        cells.stiff_axb[i] = numbers.bent_stiffness
    for i, _ in beginning("ac"):
        if i in apical:
            apical = _constricted(apical, i, cells, emt)
    return tissue._replace(cells=cells, layers=CellLayers(apical, basal), emt=emt)


def _without(layer: np.ndarray, i: int, cells: Cells, numbers: Numbers) -> np.ndarray:
    """The apical layer without cell i, and the junction that bridges the gap."""
    left, right = layer[layer < i], layer[layer > i]
    if len(left) and len(right):
        a, b = left[-1], right[0]
        gap = math.hypot(cells.ax[a] - cells.ax[b], cells.ay[a] - cells.ay[b])
        cells.rest_aa[a] = gap if numbers.bridge_present else cells.rest_aa[a] + cells.rest_aa[i]
    return np.concatenate((left, right))


def _constricted(layer: np.ndarray, i: int, cells: Cells, emt: Emt) -> np.ndarray:
    """The apical layer without cell i, which joins the chain of those that constrict beside it in this step."""
    left, right = layer[layer < i], layer[layer > i]
    first = left[-1] + 1 if len(left) else 0
    beside = [j for j in range(first, i) if cells.chain[j] and emt.new[cells.emt[j]] & bit("ac")]
    cells.chain[i] = cells.chain[beside[-1]] if beside else cells.id[i] + 1
    if len(left) and len(right):
        a, b = left[-1], right[0]
        cells.rest_aa[a] = math.hypot(cells.ax[a] - cells.ax[b], cells.ay[a] - cells.ay[b])
    return np.concatenate((left, right))


def last_events(cells: Cells, before: Cells, numbers: Numbers, named: Named = ()) -> Cells:
    """Twin of ``kernels.rules.last_events``; ``before``: with the rest lengths before this dt."""
    cells = _copied(cells)
    for i in np.flatnonzero(cells.events):
        own = of_cell(numbers, named, cells.kind[i])
        if cells.events[i] & bit("a"):
            cells.rest_ax[i] = before.rest_ax[i] * math.exp(-own.rate_ax * own.dt)
        if cells.events[i] & bit("p"):
            cells.rest_bx[i], cells.stiff_bx[i] = _grip(cells, i, before.rest_bx[i], own)
        elif cells.events[i] & bit("b"):
            cells.rest_bx[i] = before.rest_bx[i] * math.exp(-own.rate_bx * own.dt)
    return cells


def _grip(cells: Cells, i: int, rest: float, numbers: Numbers) -> tuple[float, float]:
    """Rest length and stiffness of the basal spring in [P]."""
    stiffness = numbers.freed_stiffness * numbers.alpha_bx
    if cells.by[i] <= 0.0:
        return rest * math.exp(-numbers.dt / numbers.contraction) if numbers.contraction else 0.0, stiffness
    if numbers.spring_gives:
        return rest + numbers.run_speed * numbers.dt, stiffness
    return math.hypot(cells.x[i] - cells.bx[i], cells.y[i] - cells.by[i]) - 1.0, 0.0


def watch_sides(tissue: Tissue, t: float) -> Tissue:
    """Twin of ``scale.watch_sides``: since when each EMT cell is where it is (4.3)."""
    emt = _copied(tissue.emt)
    positions = ab_positions(Frame(t, *tissue[:2])) if len(emt.side) else None
    for i in np.flatnonzero(tissue.cells.emt >= 0):
        k = tissue.cells.emt[i]
        side = int(positions[i] > 1.0) - int(positions[i] < 0.0) if positions is not None else 0
        if side != emt.side[k]:
            emt.side[k], emt.since[k], emt.since_x[k] = side, t, tissue.cells.x[i]
    return tissue._replace(emt=emt)


def _copied(arrays: Arrays) -> Arrays:
    return type(arrays)(*(array.copy() for array in arrays))
