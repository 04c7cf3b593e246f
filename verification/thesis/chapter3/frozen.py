"""Frozen tissues: rules stand still, there is no noise; their substeps, their jitter, and states at rest."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tissue.files.parameters import Parameters, preset
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.group import Group
from tissue.state.cells import COORDINATES, CellLayers, Cells, first
from tissue.state.numbers import Numbers, numbers_pointer
from tissue.state.running import contents, new_state
from tissue.step.advance import apply_rules
from verification.thesis.chapter3 import linear
from verification.thesis.chapter3.growing import SUCCESS, growing, growing_from

Floats = NDArray[np.float64]
# One rule of the thesis preset changed: desired rest lengths that are not negative, as the published runs have it.
FLOORED = {"rules.floor_rest_length": True}
# The tissue is grown for so long [h], with so many substeps, before it is frozen.
AGE, SEED = 10.0, 0
FINE = {"thesis": 160, "published": 40}
# Rounds of substeps to rest, each with h/mu of this part of the limit of its first state.
ROUNDS, SUBSTEPS, PART = 10, 5000, 0.3
# Soft discs that overlap one, at most; each adds 2 k to the largest eigenvalue at most.
NEIGHBOURS = 20


class Frozen(NamedTuple):
    """A state whose rules stand still."""

    cells: Cells
    layers: CellLayers
    numbers: Numbers


def floored() -> Parameters:
    """Return the thesis preset with desired rest lengths that are not negative, with which DAHA terminates."""
    return preset("thesis").changed(FLOORED)


@cache
def begun(parameters: Parameters, seed: int, t: float) -> Frozen:
    """Return the state from which the step that ends at t + dt begins: rules and noise applied, nothing moved yet.

    The tissue was grown by PBD. The state need not be in S.
    """
    run = growing_from(parameters, seed)
    run.to(t)
    if run.status != SUCCESS:
        raise RuntimeError(f"seed {seed}: the tissue was lost before t = {t:g} h: {run.status}")
    t, numbers = (run.made + 1) * run.numbers.dt, numbers_pointer(run.numbers)
    apply_rules(run.held, t, numbers, rules_pointer([run.held]), run.random.cycle, run.random.noise)
    return Frozen(*contents(run.held), run.numbers)


@cache
def grown(name: str) -> Frozen:
    """Return the tissue of a preset after AGE."""
    run = growing(name, SEED, substeps=FINE[name])
    run.to(AGE)
    frame = run.frame()
    return Frozen(frame.cells, frame.layers, run.numbers)


def substepped(state: Frozen, scale: float, substeps: int) -> Cells | None:
    """Return the cells after so many substeps of h = scale mu, without rules and noise; None if cells are lost."""
    cells, layers, numbers = state
    still = numbers._replace(dt=scale * numbers.mu * substeps, substeps=substeps, noise_in_substeps=False)
    group = Group([new_state(cells, layers, capacity=len(cells.x), space=in_plane())], still)
    return contents(group.states[0])[0] if group.make_substeps() else None


class Swing(NamedTuple):
    """The period-two part of three states in a row: a, where Z_k = Y + (-1)^k a, is (Z_{k+1} - 2 Z_k + Z_{k-1})/4."""

    nuclei: Floats  # |a| of each nucleus, shape (n,) [R_soft]
    largest: float  # |a| of any coordinate [R_soft]
    middle: Cells  # the cells at (Z_{k+1} + 2 Z_k + Z_{k-1})/4, where the swing is gone


def swing(state: Frozen, scale: float) -> Swing | None:
    """Return the swing of the state and the two after it; None if one of them is lost.

    Beyond the linear limit of explicit Euler points swing from substep to substep: they jitter.
    """
    now = substepped(state, scale, 1)
    after = None if now is None else substepped(state._replace(cells=now), scale, 1)
    if now is None or after is None:
        return None
    z = [np.stack([getattr(one, name) for name in COORDINATES]) for one in (state.cells, now, after)]
    turn, middle = (z[2] - 2 * z[1] + z[0]) / 4, (z[2] + 2 * z[1] + z[0]) / 4
    calm = state.cells._replace(**dict(zip(COORDINATES, middle, strict=True)))
    return Swing(np.hypot(turn[0], turn[1]), float(np.abs(turn).max()), calm)


def at_rest(state: Frozen) -> Frozen:
    """Return the state after ROUNDS of substeps that are far below the linear limit."""
    for _ in range(ROUNDS):
        scale = PART * _surely_below(state)
        moved = substepped(state, scale, SUBSTEPS)
        if moved is None:
            raise RuntimeError(f"a tissue at rest was lost at h/mu = {scale:g}: must be stable there")
        state = state._replace(cells=moved)
    return state


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
