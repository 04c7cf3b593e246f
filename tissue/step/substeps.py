"""The substeps of position based dynamics between two updates of the rules (Method 3.7, (3.34)).

A substep adds noise, moves all points by the forces, and sweeps once over the constraints. That of a slice is written
once, and compiled twice: for one tissue, with a double for each cell, and for eight, with eight.
"""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import WIDTH
from tissue.kernels.pair_lists import refresh_lists
from tissue.kernels.rules import ALL_SUBSTEPS, address_of
from tissue.kernels.surface_workspace import (
    FRESH,
    SurfaceWorkspace,
    surface_workspace_at,
    wide_surface_workspace_at,
)
from tissue.kernels.workspace import Workspace, wide_workspace_at, workspace_at
from tissue.model.balls import separate_balls
from tissue.model.basal_layer import lay, order_basal
from tissue.model.basal_network import hold_together, put_on_surface
from tissue.model.discs import separate
from tissue.model.junctions import pull_along_edges, pull_junctions, pull_links
from tissue.model.motion import move
from tissue.model.noise import add_substep_noise
from tissue.model.repulsion import push_in_pairs, push_in_rows
from tissue.model.soft_balls import push_nuclei
from tissue.state.running import SUBSTEPS
from tissue.step.user_forces import call_part, call_part_in_space, user_forces_at

# Kinds of tissues: one slice, eight slices side by side, one sheet or closed surface.
SLICE, SLICES, SURFACE = range(3)


@inner
def make_substep(work: Workspace, n: int, wide: Workspace, rows: int, flat: Workspace) -> None:
    """Make a substep of the n cells of slices when their nuclei know how they push: forces, one sweep of projections.

    What a cell does by itself is done for eight at once: ``wide`` is the workspace in ``rows`` of eight cells, of one
    tissue or of eight; ``flat`` is the workspace in single numbers.
    """
    pull_junctions(work, n, wide, rows)
    pull_links(flat)
    own = user_forces_at(flat.forces)
    if flat.forces:
        call_part(own.evaluate, own, flat)
    move(wide, rows)
    if flat.forces:
        call_part(own.follow, own, flat)
    separate(work, n)
    order_basal(work, n)
    if work.bent:
        lay(wide, rows)


@inner
def make_surface_substep(work: SurfaceWorkspace, n: int, wide: SurfaceWorkspace, rows: int, number: int) -> None:
    """Make a substep of the n cells of a sheet or a closed surface; ``wide`` is its workspace in ``rows`` of eight."""
    add_substep_noise(wide, rows, number)
    refresh_lists(work, n, wide, rows)
    push_nuclei(work, n)
    pull_along_edges(work, n)
    own = user_forces_at(work.forces)
    if work.forces:
        call_part_in_space(own.evaluate, own, work)
    move(wide, rows)
    if work.forces:
        call_part_in_space(own.follow, own, work)
    separate_balls(work, n, wide, rows)
    hold_together(work)
    put_on_surface(wide, rows)


@inner
def _spread_key(work: Any, in_rows: Any) -> None:
    """Give all lanes of a tissue alone its key of the noise."""
    for word in range(2):
        for lane in range(WIDTH):
            in_rows.noise_key[word, lane] = work.noise_key[word]


def _alone(flat: int, wide: int, n: int) -> int:
    """Make all substeps of one dt for a slice of n cells, whose workspace has these addresses; return 0."""
    work, in_rows, rows = workspace_at(flat), wide_workspace_at(wide), (n + WIDTH - 1) // WIDTH
    _spread_key(work, in_rows)
    for number in range(work.substeps):
        add_substep_noise(in_rows, rows, number)
        push_in_rows(work, n, in_rows, rows)
        make_substep(work, n, in_rows, rows, work)
    return 0


def _abreast(flat: int, wide: int, n: int) -> int:
    """Make all substeps of one dt for eight slices of up to n cells; return 0."""
    work = wide_workspace_at(wide)
    for number in range(work.substeps):
        add_substep_noise(work, n, number)
        push_in_pairs(work, n)
        make_substep(work, n, work, n, workspace_at(flat))
    return 0


def _on_surface(flat: int, wide: int, n: int) -> int:
    """Make all substeps of one dt for a sheet or a closed surface; return 0.

    The lists are made anew: what a step does is a function of what is in the workspace.
    """
    work, in_rows, rows = surface_workspace_at(flat), wide_surface_workspace_at(wide), (n + WIDTH - 1) // WIDTH
    _spread_key(work, in_rows)
    work.state[FRESH] = 0
    for number in range(work.substeps):
        make_surface_substep(work, n, in_rows, rows, number)
    work.counts[SUBSTEPS] += work.substeps
    return 0


def substeps_address(kind: int) -> int:
    """Return the address of the machine code of all substeps of one dt for a kind of tissues, compiled on first use."""
    return address_of(ALL_SUBSTEPS, (_alone, _abreast, _on_surface)[kind])
