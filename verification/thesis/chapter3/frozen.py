"""Frozen tissues: rules stand still, there is no noise, and every force has come to rest."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from tissue.state.cells import CellLayers, Cells, first
from tissue.state.numbers import Numbers
from verification.thesis.chapter3 import linear
from verification.thesis.chapter3.growing import growing
from verification.thesis.chapter3.jitter import substepped

# The tissue is grown for so long [h], with so many substeps, before it is frozen.
AGE, SEED = 10.0, 0
FINE = {"thesis": 160, "published": 40}
# Rounds of substeps to rest, each with h/mu of this part of the limit of its first state.
ROUNDS, SUBSTEPS, PART = 10, 5000, 0.3
# Soft discs that overlap one, at most; each adds 2 k to the largest eigenvalue at most.
NEIGHBOURS = 20


class Frozen(NamedTuple):
    """A state at rest."""

    cells: Cells
    layers: CellLayers
    numbers: Numbers


@cache
def grown(name: str) -> Frozen:
    """Return the tissue of a preset after AGE."""
    run = growing(name, SEED, substeps=FINE[name])
    run.to(AGE)
    frame = run.frame()
    return Frozen(frame.cells, frame.layers, run.numbers)


def at_rest(state: Frozen) -> Frozen:
    """Return the state after ROUNDS of substeps that are far below the linear limit."""
    cells = state.cells
    for _ in range(ROUNDS):
        scale = PART * _surely_below(state._replace(cells=cells))
        moved = substepped(cells, state.layers, state.numbers, scale, SUBSTEPS)
        if moved is None:
            raise RuntimeError(f"a tissue at rest was lost at h/mu = {scale:g}: must be stable there")
        cells = moved
    return state._replace(cells=cells)


def limit(state: Frozen) -> float:
    """Return 2 / lambda_max: the linear limit of h/mu, if no projection is active."""
    return float(linear.LIMIT / linear.largest(linear.hessian(*state)))


def _surely_below(state: Frozen) -> float:
    """Return a cheap lower bound: 2 over the sum of the largest eigenvalues of all kinds of forces."""
    numbers = state.numbers
    own = linear.largest(linear.own_hessians(state.cells, numbers)).max()
    junction = numbers.junction_factor * state.cells.stiff_aa.max()
    return float(linear.LIMIT / (own + 4 * junction + 2 * NEIGHBOURS * numbers.repulsion))


def stiffened(state: Frozen, **stiffness: float) -> Frozen:
    """Return a copy with another stiffness for all cells: ``stiff_axb``, ``stiff_ax``, ``stiff_bx``."""
    cells = first(state.cells, len(state.cells.x))
    for name, value in stiffness.items():
        getattr(cells, name)[:] = value
    return state._replace(cells=cells)


def disturbed(state: Frozen, size: float) -> Frozen:
    """Return a copy with each unknown off by N(0, size^2)."""
    rng, cells = np.random.default_rng(0), first(state.cells, len(state.cells.x))
    for name in linear.UNKNOWNS:
        getattr(cells, name)[:] += rng.normal(0.0, size, len(cells.x))
    return state._replace(cells=cells)
