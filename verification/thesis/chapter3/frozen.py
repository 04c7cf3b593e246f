"""Frozen tissues: rules stand still, there is no noise; their substeps and their jitter."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tissue.files.parameters import Parameters, preset
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.group import Group
from tissue.state.cells import CellLayers, Cells
from tissue.state.numbers import Numbers, numbers_pointer
from tissue.state.running import contents, new_state
from tissue.step.advance import apply_rules
from verification.thesis.chapter3.growing import SUCCESS, growing_from

Floats = NDArray[np.float64]
# One rule of the thesis preset changed: desired rest lengths that are not negative, as the published runs have it.
FLOORED = {"rules.floor_rest_length": True}


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


def substepped(state: Frozen, scale: float, substeps: int) -> Cells | None:
    """Return the cells after so many substeps of h = scale mu, without rules and noise; None if cells are lost."""
    cells, layers, numbers = state
    still = numbers._replace(dt=scale * numbers.mu * substeps, substeps=substeps, noise_in_substeps=False)
    group = Group([new_state(cells, layers, capacity=len(cells.x), space=in_plane())], still)
    return contents(group.states[0])[0] if group.make_substeps() else None


def swing(state: Frozen, scale: float) -> Floats | None:
    """Return |a| of each nucleus, shape (n,) [R_soft], of the state and the two after it; None if one of them is lost.

    a is the period-two part of three states in a row: where Z_k = Y + (-1)^k a, it is (Z_{k+1} - 2 Z_k + Z_{k-1})/4.
    Beyond the linear limit of explicit Euler points swing from substep to substep: they jitter.
    """
    now = substepped(state, scale, 1)
    after = None if now is None else substepped(state._replace(cells=now), scale, 1)
    if now is None or after is None:
        return None
    before, here, then = (np.stack((one.x, one.y)) for one in (state.cells, now, after))
    turn = (then - 2 * here + before) / 4
    return np.asarray(np.hypot(turn[0], turn[1]))
