"""Cells copied to the workspace, where substeps are made, and back."""

from __future__ import annotations

import math
from typing import Any

from dincl.compiled import inner
from tissue.kernels.curve import evaluate
from tissue.kernels.lanes import load
from tissue.kernels.lanes import store as put
from tissue.kernels.layers import chained_before
from tissue.kernels.surface_workspace import JUNCTIONS, NEIGHBOURS, SurfaceWorkspace
from tissue.kernels.workspace import FAR, RUNNING, Workspace
from tissue.model.springs import apical_length, basal_length, coefficient
from tissue.state.cells import Floats, Integers
from tissue.state.numbers import Numbers, numbers_at, numbers_of
from tissue.state.running import (
    APICAL,
    BASAL_CORRECTIONS,
    CELLS,
    CORRECTIONS,
    JUMPED,
    SUBSTEPS,
    TissueState,
    state_at,
)
from tissue.state.space import EDGES

# A point that moves in one dt by more than twice the length of its cell and so many R_soft, besides its noise and its
# own run, has jumped: springs that contract move it by the length of the cell at most. In stable runs of all presets
# and events points move by 5 R_soft at most, of which cells up to 23 R_soft long are freed at both ends.
MOST_MOVED = 10.0
# Standard deviations of the noise of one dt that no point ever moves by.
MOST_NOISE = 10.0


@inner
def copy_in(states: Integers, ended: Integers, work: Workspace, numbers: Integers, scale: Floats) -> int:
    """Copy the tissues that run to the workspace, seen flat, and return the largest number of cells; of each tissue
    the address of its numbers, and ``scale`` = h / mu.
    """
    width, largest = len(ended), 0
    work.links[0] = 0
    for k in range(width):
        work.cells[k] = state_at(states[k]).sizes[CELLS] if ended[k] == RUNNING else 0
        largest = max(largest, work.cells[k])
    for k in range(width):
        for i in range(work.cells[k], largest):
            _fill(work, i, width * i + k)
        for i in range(largest):
            work.in_apical[width * i + k] = work.joined[width * i + k] = 0.0
        if ended[k] == RUNNING:
            _copy(state_at(states[k]), k, width, work, numbers_at(numbers[k]), scale[k])
    return largest


@inner
def _copy_cell(state: TissueState, i: int, work: Any, place: int, own: Numbers, power: int, scale: float) -> None:
    """Copy cell i of any tissue to a place, with the coefficients of its springs for the numbers ``own``."""
    cells, motion = state.cells, state.motion
    work.x[place], work.y[place] = cells.x[i], cells.y[i]
    work.ax[place], work.ay[place] = cells.ax[i], cells.ay[i]
    work.bx[place], work.by[place] = cells.bx[i], cells.by[i]
    put(work.z, place, cells.z[i])
    put(work.az, place, cells.az[i])
    put(work.bz, place, cells.bz[i])
    work.radius[place], work.id[place] = cells.radius[i], cells.id[i]
    l_ax, l_bx = own.soft_radius + cells.rest_ax[i], own.soft_radius + cells.rest_bx[i]
    work.l_ax[place], work.l_bx[place] = l_ax, l_bx
    work.k_ax[place] = coefficient(scale, cells.stiff_ax[i], l_ax, power)
    work.k_bx[place] = coefficient(scale, cells.stiff_bx[i], l_bx, power)
    work.k_axb[place] = scale * cells.stiff_axb[i]
    work.moves[place], work.held[place], work.runs[place] = motion.moves[i], motion.held[i], motion.runs[i]


@inner
def _copy(state: TissueState, k: int, width: int, work: Workspace, numbers: Numbers, scale: float) -> None:
    """Copy a tissue to lane k."""
    cells = state.cells
    for i in range(work.cells[k]):
        place, own = width * i + k, numbers_of(numbers, cells.kind[i])
        _copy_cell(state, i, work, place, own, numbers.spring_power, scale)
        work.soft[place], work.stiff_xx[place] = own.soft_radius, scale * own.repulsion
        work.limit[place] = own.max_basal_distance
        if work.bent:
            at = evaluate(work.curve, cells.along[i])
            work.along[place], work.tangent_x[place], work.tangent_y[place] = cells.along[i], at[2], at[3]
    for s in range(state.sizes[APICAL]):
        i, place = state.layers.apical[s], width * state.layers.apical[s] + k
        work.in_apical[place] = 1.0
        if s > 0 or (work.curve.ring > 0.0 and state.sizes[APICAL] > 2):
            before = state.layers.apical[s - 1 if s > 0 else state.sizes[APICAL] - 1]
            work.joined[place], work.rest[place] = 1.0, cells.rest_aa[before]
            work.k_aa[place] = scale * numbers.junction_factor * (0.5 * (cells.stiff_aa[before] + cells.stiff_aa[i]))
    _copy_links(state, k, width, work, scale * numbers.junction_factor)
    for word in range(2):
        work.noise_key[width * word + k] = state.noise_key[word]
        work.counts[width * word + k] = 0.0


@inner
def _copy_links(state: TissueState, k: int, width: int, work: Workspace, scale: float) -> None:
    """Copy the junctions of a tissue that are apart from its layer; their cells have no other."""
    cells, links = state.cells, work.links
    for i in range(work.cells[k]):
        first = chained_before(cells, i)
        if first >= 0:
            place, number = width * i + k, links[0]
            links[1 + 2 * number], links[2 + 2 * number] = place, width * first + k
            links[0] += 1
            work.rest[place] = cells.rest_aa[first]
            work.k_aa[place] = scale * (0.5 * (cells.stiff_aa[first] + cells.stiff_aa[i]))


@inner
def _fill(work: Workspace, i: int, place: int) -> None:
    """Fill an empty place with a cell that stands upright, far from everything, without forces."""
    work.x[place] = work.ax[place] = work.bx[place] = FAR * (1 + i)
    work.y[place], work.ay[place], work.by[place] = 0.0, 1.0, -1.0
    work.radius[place] = work.k_ax[place] = work.k_bx[place] = work.k_axb[place] = 0.0
    work.moves[place] = work.held[place] = work.runs[place] = 0.0


@inner
def copy_out(work: Workspace, states: Integers) -> None:
    """Copy positions and counts back to the tissues in the workspace, seen flat."""
    width = len(work.cells)
    for k in range(width):
        if work.cells[k] > 0:
            state = state_at(states[k])
            find_jump(work, state, k, width)
            put_back(work, state, k, width)
            state.counts[SUBSTEPS] += work.substeps
            state.counts[CORRECTIONS] += int(work.counts[k])
            state.counts[BASAL_CORRECTIONS] += int(work.counts[width + k])


@inner
def find_jump(work: Any, state: TissueState, first: int, width: int) -> None:
    """Note in the sizes of a tissue a cell of which a point jumped in this dt: steps that are unstable throw it.

    The state has its points before the substeps, the workspace those after: cell i at place ``first`` + ``width`` i.
    """
    cells, sizes = state.cells, state.sizes
    noise = MOST_NOISE * work.deviation[first] * math.sqrt(work.substeps)
    for i in range(sizes[CELLS]):
        place = width * i + first
        length = apical_length(cells, i) + basal_length(cells, i)
        most = MOST_MOVED + noise + 2.0 * length + work.runs[place] * work.substeps
        x, y, z = work.x[place] - cells.x[i], work.y[place] - cells.y[i], load(work.z, place) - cells.z[i]
        farthest = x * x + y * y + z * z
        x, y, z = work.ax[place] - cells.ax[i], work.ay[place] - cells.ay[i], load(work.az, place) - cells.az[i]
        farthest = max(farthest, x * x + y * y + z * z)
        x, y, z = work.bx[place] - cells.bx[i], work.by[place] - cells.by[i], load(work.bz, place) - cells.bz[i]
        farthest = max(farthest, x * x + y * y + z * z)
        if farthest > most * most:
            sizes[JUMPED] = 1 + cells.id[i]


@inner
def put_back(work: Any, state: TissueState, k: int, width: int) -> None:
    """Copy the positions of lane k of the workspace of a slice, or of a surface, back to its tissue."""
    cells = state.cells
    for i in range(state.sizes[CELLS]):
        place = width * i + k
        cells.x[i], cells.y[i], cells.z[i] = work.x[place], work.y[place], load(work.z, place)
        cells.ax[i], cells.ay[i], cells.az[i] = work.ax[place], work.ay[place], load(work.az, place)
        cells.bx[i], cells.by[i], cells.bz[i] = work.bx[place], work.by[place], load(work.bz, place)
        if work.bent:
            cells.along[i] = load(work.along, place)


@inner
def copy_to_workspace(state: TissueState, work: SurfaceWorkspace, numbers: Numbers, scale: float) -> int:
    """Copy a tissue and the edges of its networks to the workspace; ``scale`` = h / mu; how many cells it has."""
    n = work.cells[0] = state.sizes[CELLS]
    for i in range(n):
        _copy_cell(state, i, work, i, numbers, numbers.spring_power, scale)
    for word in range(2):
        work.noise_key[word] = state.noise_key[word]
    for k in range(len(work.counts)):
        work.counts[k] = 0
    apical, basal, alpha = state.space.apical, state.space.basal, state.cells.stiff_aa
    work.sizes[JUNCTIONS], work.sizes[NEIGHBOURS] = apical.sizes[EDGES], basal.sizes[EDGES]
    for edge in range(apical.sizes[EDGES]):
        i, j = apical.edges[edge, 0], apical.edges[edge, 1]
        work.junctions[edge, 0], work.junctions[edge, 1] = i, j
        work.rest[edge] = apical.rest[edge]
        work.k_aa[edge] = scale * numbers.junction_factor * (0.5 * (alpha[i] + alpha[j]))
    for edge in range(basal.sizes[EDGES]):
        work.neighbours[edge, 0], work.neighbours[edge, 1] = basal.edges[edge, 0], basal.edges[edge, 1]
    copied: int = n
    return copied


@inner
def copy_from_workspace(work: SurfaceWorkspace, state: TissueState) -> None:
    """Copy positions and counts back."""
    find_jump(work, state, 0, 1)
    put_back(work, state, 0, 1)
    for counter in (SUBSTEPS, CORRECTIONS, BASAL_CORRECTIONS):
        state.counts[counter] += work.counts[counter]
