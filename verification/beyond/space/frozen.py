"""Frozen tissues in space: the state they begin from, substeps of it, and the limit of explicit Euler."""

from __future__ import annotations

import ctypes
import math
from typing import NamedTuple

import numpy as np

import dincl
import tissue
from tissue.files.parameters import Parameters, preset
from tissue.frames.frame import Frame
from tissue.kernels.surface_workspace import PAIRS, SurfaceNumbers, SurfaceWorkspaces
from tissue.quasi_steady.frozen import frozen_problem_in_space, made_feasible_in_space, particles, rates_of
from tissue.state.cells import Floats
from tissue.state.numbers import Numbers
from tissue.step.substeps import SURFACE, substeps_address

# Explicit Euler is stable for h lambda below it.
LIMIT = 2.0
# Of the central differences of the drift [R_soft].
DIFFERENCE = 1e-6
POINTS = ("", "a", "b")
_SUBSTEPS = ctypes.CFUNCTYPE(*[ctypes.c_int64] * 4)


class FrozenInSpace(NamedTuple):
    """A tissue whose rules and neighbours stand still."""

    frame: Frame
    numbers: Numbers


def open_sheet(cells: int, hours: float) -> Parameters:
    """Return the published parameters for an open sheet in space that grows for ``age`` hours."""
    end = f"{hours:g} h"
    changes = {"tissue.dimension": 3, "tissue.cells": cells, "space.boundary": "open"}
    return preset("published").changed(changes | {"numerics.t_end": end, "numerics.keep": end})


def begun_in_space(parameters: Parameters, seed: int, tol: float) -> FrozenInSpace:
    """Return the grown tissue of a seed, moved to a nearest state of S."""
    numbers = parameters.numbers()
    frame = tissue.simulate(parameters, seed=seed).final
    return FrozenInSpace(made_feasible_in_space(frame, numbers, dincl.Ipopt(tol=tol)), numbers)


def substepped_in_space(state: FrozenInSpace, steps: int) -> tuple[Floats, int]:
    """Return particles (3n, 3) after dt by the kernel, in substeps without noise, and the pairs it looked at."""
    (frame, numbers), rates, n = state, rates_of(*state), len(state.frame.cells.x)
    scale = numbers.dt / steps
    workspaces = _work(state, steps)
    work = workspaces.flat.value
    work.k_ax[:n], work.k_bx[:n], work.k_axb[:n] = scale * rates.k_ax, scale * rates.k_bx, scale * rates.k_axb
    work.l_ax[:n], work.l_bx[:n] = rates.l_ax, rates.l_bx
    work.moves[:n], work.radius[:n], work.id[:n] = 1.0, frame.cells.radius, np.arange(n)
    work.held[rates.held] = 1.0
    work.k_aa[: len(rates.rest)], work.rest[: len(rates.rest)] = scale * rates.k_aa, rates.rest
    for letter, axis in ((letter, axis) for letter in POINTS for axis in "xyz"):
        getattr(work, letter + axis)[:n] = getattr(frame.cells, letter + axis)
    _SUBSTEPS(substeps_address(SURFACE))(workspaces.flat.address, workspaces.wide.address, n)
    moved = [np.column_stack([getattr(work, letter + axis)[:n] for axis in "xyz"]) for letter in POINTS]
    return np.concatenate(moved), int(work.counts[PAIRS])


def _work(state: FrozenInSpace, steps: int) -> SurfaceWorkspaces:
    """Return a workspace with the edges of both networks, and room for the cells."""
    (frame, numbers), rates = state, rates_of(*state)
    if frame.sheets is None:
        raise RuntimeError("frame.sheets = None: must be those of a run in three dimensions")
    near = frame.sheets.basal.edges
    of_workspace = SurfaceNumbers(steps, numbers.dt / steps * rates.repulsion, numbers.max_basal)
    workspaces = SurfaceWorkspaces(
        len(frame.cells.x), max(len(rates.rest), len(near)), of_workspace, frame.sheets.surface
    )
    work = workspaces.flat.value
    work.junctions[: len(rates.rest)], work.neighbours[: len(near)] = rates.junctions, near
    work.sizes[:] = len(rates.rest), len(near), 0  # a sheet has no order
    return workspaces


def least_steps(state: FrozenInSpace) -> float:
    """Return the steps in dt at the linear limit of explicit Euler, if no projection is active."""
    problem, x = frozen_problem_in_space(*state), particles(state.frame.cells, "xyz")
    slopes = np.empty((x.size, x.size))
    for column, place in enumerate(np.ndindex(x.shape)):
        ends = []
        for side in (1, -1):
            moved = x.copy()
            moved[place] += side * DIFFERENCE
            ends.append(problem.velocity(0.0, moved))
        slopes[column] = ((ends[0] - ends[1]) / (2 * DIFFERENCE)).ravel()
    largest = -float(np.linalg.eigvalsh((slopes + slopes.T) / 2)[0])
    return state.numbers.dt * largest / LIMIT if math.isfinite(largest) else math.inf
