"""The tissue kernels again in plain Python: the same numbers to rounding, written to be read and not to be fast.

Nothing is shared with the kernels: all pairs are looked at, there are no lists, and the forces are those of
``energy.forces``. Sums of forces may round differently; projections, noise and events are the same bit for bit, with
random numbers drawn from the same generators in the same order.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.random import Generator

from tests.twins.tissue.events import Motion, begin_events, last_events, motion, watch_sides
from tests.twins.tissue.normals import WORDS, normals
from tests.twins.tissue.state import Tissue
from tests.twins.tissue.types import Named, of_all, of_cell
from tissue.events.known import bit
from tissue.model.energy import forces
from tissue.model.junctions import pairs
from tissue.state.cells import CellLayers, Cells, Emt, Flags, Floats
from tissue.state.numbers import Numbers


def steps(
    tissue: Tissue, made: int, wanted: int, numbers: Numbers, draws: Generator, noise: Generator, named: Named = ()
) -> Tissue:
    """Twin of ``advance.advance``: the steps ``made`` to ``wanted``, the k-th to t = (k + 1) dt (Method 3.7)."""
    for k in range(made, wanted):
        tissue = apply_rules(tissue, (k + 1) * numbers.dt, numbers, draws, noise, named)
        tissue = tissue._replace(cells=make_substeps(tissue.cells, tissue.layers, numbers, noise))
        tissue = watch_sides(tissue, (k + 1) * numbers.dt)
    return tissue


def apply_rules(
    tissue: Tissue, t: float, numbers: Numbers, draws: Generator, noise: Generator, named: Named = ()
) -> Tissue:
    """Twin of ``advance.apply_rules``: divisions, EMT events, phases, rest lengths, noise."""
    tissue = begin_events(divide(tissue, t, numbers, draws, named), t, numbers, named)
    own = of_all(numbers, named, tissue.cells.kind)
    before = set_phases(tissue.cells, t, own)
    adapted = shrink_junctions(adapt_rest_lengths(before, t, own), tissue.layers, own)
    cells = last_events(adapted, before, numbers, named)
    if not numbers.noise_in_substeps:
        cells = add_noise(cells, numbers.variance * numbers.dt, noise)
    return tissue._replace(cells=cells)


def divide(tissue: Tissue, t: float, numbers: Numbers, draws: Generator, named: Named = ()) -> Tissue:
    """Twin of ``cycle.divide`` (section 2.2.5 of chapter 3): cells go from one list to another.

    Layers are lists of ids.
    """
    apical, basal = (tissue.cells.id[layer].tolist() for layer in tissue.layers)
    one_by_one: list[Any] = []
    next_id, emt = tissue.next_id, tissue.emt
    for cell in _each(tissue.cells):
        if t - cell.birth < cell.cycle:
            one_by_one.append(cell)
            continue
        own = of_cell(numbers, named, cell.kind)
        two = cell.divides and draws.random() < own.two_daughters
        first = cell._replace(birth=t, cycle=_new_cycle(own, draws))
        if two:
            second = first._replace(cycle=_new_cycle(own, draws), id=next_id, mother=first.id)
            first = _shifted(first, -numbers.offset)._replace(rest_aa=numbers.new_junction)
            if cell.emt >= 0:
                second = second._replace(emt=len(emt.side))
                emt = Emt(*(np.concatenate((array, array[..., [cell.emt]]), axis=-1) for array in emt))
            one_by_one += [first, _shifted(second, numbers.offset)]
            for layer in (apical, basal):
                if first.id in layer:
                    layer.insert(layer.index(first.id) + 1, next_id)
            next_id += 1
        else:
            one_by_one.append(first)
    cells = Cells(*(np.array(fields).T for fields in zip(*one_by_one, strict=True)))
    place = {name: i for i, name in enumerate(cells.id.tolist())}
    layers = CellLayers(*(np.array([place[name] for name in layer], np.int64) for layer in (apical, basal)))
    return tissue._replace(cells=cells, layers=layers, next_id=next_id, emt=emt)


def set_phases(cells: Cells, t: float, numbers: Any) -> Cells:
    """Twin of ``cycle.set_phases``: hard radius (3.4), (3.8), and stiffness of the apical junctions."""
    changes = cells.moves | numbers.resting_cells_enlarge
    late = changes & _in_g2(cells, t, numbers)
    mitosis = changes & (t - cells.birth >= cells.cycle - numbers.mitosis)
    return cells._replace(
        radius=np.where(late if numbers.enlarge_in_g2 else mitosis, numbers.enlarged_radius, numbers.hard_radius),
        stiff_aa=numbers.alpha_aa * np.where(late, numbers.g2_stiffening, 1.0),
    )


def adapt_rest_lengths(cells: Cells, t: float, numbers: Any) -> Cells:
    """Twin of ``cycle.adapt_rest_lengths``: (3.2), (3.3), (3.6) solved exactly over dt for a desired length at rest."""
    rises = cells.moves & _in_g2(cells, t, numbers)
    to_a = np.hypot(cells.x - cells.ax, cells.y - cells.ay)
    to_b = np.hypot(cells.x - cells.bx, cells.y - cells.by)
    whole = np.hypot(cells.ax - cells.bx, cells.ay - cells.by)
    wanted_ax = np.where(rises, 0.0, to_a - 1.0)
    wanted_bx = np.where(rises, whole - 2.0, to_b - 1.0)
    if numbers.floor_rest_length:
        wanted_ax, wanted_bx = np.maximum(wanted_ax, 0.0), np.maximum(wanted_bx, 0.0)
    free_a, free_b = cells.events & bit("a") > 0, cells.events & bit("b") > 0
    total = np.where(free_a, 0.0, wanted_ax) + np.where(free_b, 0.0, wanted_bx)
    share = np.divide(numbers.max_cytoskeleton, total, out=np.ones(len(total)), where=total > numbers.max_cytoskeleton)
    wanted_ax, wanted_bx = share * wanted_ax, share * wanted_bx
    return cells._replace(
        rest_ax=wanted_ax + (cells.rest_ax - wanted_ax) * np.exp(-numbers.rate_ax * numbers.dt),
        rest_bx=wanted_bx + (cells.rest_bx - wanted_bx) * np.exp(-numbers.rate_bx * numbers.dt),
    )


def shrink_junctions(cells: Cells, layers: CellLayers, numbers: Any) -> Cells:
    """Twin of ``junctions.shrink_junctions``: the mean rate of both cells, for what is no junction that of its cell."""
    rate = np.broadcast_to(numbers.rate_aa, len(cells.x)).astype(float)
    i, j = pairs(cells, layers, closed=False)
    rate[i] = 0.5 * (rate[i] + rate[j])
    return cells._replace(rest_aa=cells.rest_aa * np.exp(-rate * numbers.dt))


def add_noise(cells: Cells, variance: float, noise: Generator) -> Cells:
    """Reference of ``tissue.model.noise.add_noise``: for each nucleus first x, then y."""
    kicks = math.sqrt(variance) * noise.standard_normal((len(cells.x), 2))
    return cells._replace(x=cells.x + kicks[:, 0], y=cells.y + kicks[:, 1])


def make_substeps(cells: Cells, layers: CellLayers, numbers: Numbers, noise: Generator) -> Cells:
    """Twin of ``substeps.make_substeps``: all PBD steps in one dt (3.34)."""
    h, own = numbers.dt / numbers.substeps, motion(cells, numbers)
    key = [int(WORDS * noise.random()) for _ in range(2)] if numbers.noise_in_substeps else None
    for number in range(numbers.substeps):
        if key is not None:
            shake_x, shake_y = math.sqrt(numbers.variance * h) * normals(key, cells.id, number)
            cells = cells._replace(x=cells.x + shake_x, y=cells.y + shake_y)
        cells = swept(moved(cells, layers, numbers, h, own), layers, numbers)
    return cells


def moved(cells: Cells, layers: CellLayers, numbers: Numbers, h: float, own: Motion) -> Cells:
    """Z - (h / mu) grad W(Z); basal points of the layer stay on the basal line (C3), others may run ahead (4.1)."""
    push = forces(cells, layers, numbers)
    push.by[layers.basal] = 0.0
    push.bx[~own.forced] = push.by[~own.forced] = 0.0
    end = {name: getattr(cells, name) + h / numbers.mu * force for name, force in push._asdict().items()}
    ahead = np.array([cells.bx - cells.x, cells.by - cells.y])
    ahead *= own.runs / np.hypot(*ahead)
    return cells._replace(**end | {"bx": end["bx"] + ahead[0], "by": end["by"] + ahead[1]})


def swept(cells: Cells, layers: CellLayers, numbers: Numbers) -> Cells:
    """One sweep of projections: hard spheres, basal order, basal distance."""
    x, y = separate(cells.x, cells.y, cells.radius)
    bx = cells.bx.copy()
    bx[layers.basal] = limit(order(bx[layers.basal]), numbers.max_basal_distance)
    return cells._replace(x=x, y=y, bx=bx)


def separate(x: Floats, y: Floats, radius: Floats) -> tuple[Floats, Floats]:
    """Twin of ``sweeps.separate``: |X_i - X_j| >= R_i + R_j (C1) for i, then j < i; each moves by half an overlap."""
    xs, ys, radii = x.tolist(), y.tolist(), radius.tolist()
    for i in range(len(radii)):
        for j in range(i):
            dx, dy = xs[i] - xs[j], ys[i] - ys[j]
            reach, square = radii[i] + radii[j], dx * dx + dy * dy
            if square < reach * reach:
                part = 0.5 * (reach / math.sqrt(square) - 1.0)
                xs[i], ys[i] = xs[i] + part * dx, ys[i] + part * dy
                xs[j], ys[j] = xs[j] - part * dx, ys[j] - part * dy
    return np.array(xs), np.array(ys)


def order(b: Floats) -> Floats:
    """b_{k+1} - b_k >= 0 from left to right: a pair in the wrong order meets in its middle (C4)."""
    b = b.copy()
    for k in range(len(b) - 1):
        half = 0.5 * (b[k + 1] - b[k])
        if half < 0.0:
            b[k : k + 2] += (half, -half)
    return b


def limit(b: Floats, largest: float) -> Floats:
    """b_{k+1} - b_k <= largest from left to right: each moves by half of the excess (C2)."""
    b = b.copy()
    for k in range(len(b) - 1):
        half = 0.5 * (b[k + 1] - b[k] - largest)
        if half > 0.0:
            b[k : k + 2] += (half, -half)
    return b


def _in_g2(cells: Cells, t: float, numbers: Any) -> Flags:
    late: Flags = t - cells.birth >= cells.cycle - numbers.g2 - numbers.mitosis
    return late


def _each(cells: Cells) -> Iterator[Any]:
    """The cells one after another, each as Cells of scalars."""
    return (Cells(*fields) for fields in zip(*(array.T.tolist() for array in cells), strict=True))


def _new_cycle(numbers: Numbers, draws: Generator) -> float:
    """t_cycle ~ U(T_min, T_max)  (3.1)."""
    return numbers.min_cycle + (numbers.max_cycle - numbers.min_cycle) * draws.random()


def _shifted(cell: Any, by: float) -> Any:
    """All three points moved along the tissue (3.7)."""
    return cell._replace(x=cell.x + by, ax=cell.ax + by, bx=cell.bx + by)
