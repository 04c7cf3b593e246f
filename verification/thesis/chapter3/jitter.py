"""Jitter: points that swing from substep to substep, beyond the linear limit of explicit Euler."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tissue.rules.slice import in_plane
from tissue.runs.group import Group
from tissue.state.cells import COORDINATES, CellLayers, Cells
from tissue.state.numbers import Numbers
from tissue.state.running import contents, new_state

Floats = NDArray[np.float64]


class Swing(NamedTuple):
    """The period-two part of three states in a row: a, where Z_k = Y + (-1)^k a, is (Z_{k+1} - 2 Z_k + Z_{k-1})/4."""

    nuclei: Floats  # |a| of each nucleus, shape (n,) [R_soft]
    largest: float  # |a| of any coordinate [R_soft]
    middle: Cells  # the cells at (Z_{k+1} + 2 Z_k + Z_{k-1})/4, where the swing is gone


def substepped(cells: Cells, layers: CellLayers, numbers: Numbers, scale: float, substeps: int) -> Cells | None:
    """Return the cells after so many substeps of h = scale mu, without rules and noise; None if cells are lost."""
    still = numbers._replace(dt=scale * numbers.mu * substeps, substeps=substeps, noise_in_substeps=False)
    group = Group([new_state(cells, layers, capacity=len(cells.x), space=in_plane())], still)
    return contents(group.states[0])[0] if group.make_substeps() else None


def swing(cells: Cells, layers: CellLayers, numbers: Numbers, scale: float) -> Swing | None:
    """Return the swing of the state and the two after it; None if one of them is lost."""
    now = substepped(cells, layers, numbers, scale, 1)
    after = None if now is None else substepped(now, layers, numbers, scale, 1)
    if now is None or after is None:
        return None
    z = [np.stack([getattr(state, name) for name in COORDINATES]) for state in (cells, now, after)]
    turn, middle = (z[2] - 2 * z[1] + z[0]) / 4, (z[2] + 2 * z[1] + z[0]) / 4
    calm = cells._replace(**dict(zip(COORDINATES, middle, strict=True)))
    return Swing(np.hypot(turn[0], turn[1]), float(np.abs(turn).max()), calm)
