"""Whether the steps of running tissues are stable: points that swing from substep to substep, or that jumped.

Explicit Euler with steps h multiplies a disturbance along an eigenvector of the Hessian of W by 1 - h lambda / mu.
Above h lambda / mu = 2 it swings and grows until forces that are not linear bound it, or without bound. What the
parameters tell of lambda is checked with them (``tissue.files.together``); the rest shows while a tissue runs:
cells in each other's way, events and forces of users that stiffen them, nuclei close to the ends of their cells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tissue.model.stiffness import LIMIT, cell_stiffness, junction_stiffness
from tissue.runs.group import Group
from tissue.state.cells import Floats
from tissue.state.running import CELLS, JUMPED, TissueState, grown

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters

# Mean amplitude of the swing of nuclei above which a run is unstable [R_soft]. Measured with 16 seeds in each of 260
# sets of parameters and substeps: below it mean heights are within 5 % of those of 320 substeps, above it they are off
# by 3 to 10 % and soon by any amount.
MOST_SWING = 0.04
# The same where desired rest lengths may be negative: some nuclei come so close to the ends of their cells that they
# swing with any step, and the presets "thesis" and "corrected" have 0.02 to 0.07, with heights off by 2 to 6 %.
MOST_SWING_AT_ENDS = 0.08
# Over so many cells at least, so that one in mitosis is not a tissue.
FEWEST_CELLS = 10
# Cells of a long row, whose junctions are as stiff as they can be.
LONG_ROW = 10_000
# Steps below this part of the limit of all tissues do not swing: none of those sets did.
SURELY = 0.25
# How often in a run it is looked for, besides the end.
LOOKS = 8


def surely_stable(parameters: Parameters) -> bool:
    """Return whether steps are so short for all forces and events that no swing needs to be looked for."""
    numbers, kinds = parameters.numbers(), (parameters.numbers(), *parameters.named_numbers())
    stiffer = max(1.0, numbers.g2_stiffening, numbers.freed_stiffness)
    bent = (one._replace(alpha_axb=max(one.alpha_axb, one.bent_stiffness)) for one in kinds)
    alpha = numbers.junction_factor * max(one.alpha_aa for one in kinds)
    stiffest = max(junction_stiffness(alpha, LONG_ROW, in_space=parameters.in_space), *map(cell_stiffness, bent))
    return not parameters.forces.acting() and numbers.scale * stiffer * stiffest < SURELY * LIMIT


def stability_fault(state: TissueState, swing: float, *, floored: bool) -> str:
    """Say what shows that the steps of a tissue are unstable; "" if nothing does.

    ``floored``: whether its desired rest lengths are not negative.
    """
    most = MOST_SWING if floored else MOST_SWING_AT_ENDS
    if state.sizes[JUMPED]:
        return f"a point of cell {state.sizes[JUMPED] - 1} has moved farther in one dt than its forces can move it"
    if not swing <= most:
        return f"nuclei swing from substep to substep by {swing:.2g} R_soft on average, at most {most:g} is sound"
    return ""


def swings(group: Group) -> Floats:
    """Compute the mean amplitude of the swing of the nuclei of each tissue of a group [R_soft].

    The amplitude is that of the part of period two of three states in a row, |X_2 - 2 X_1 + X_0| / 4, of which two come
    from one more substep each, without noise, on copies. inf where a tissue is lost.
    """
    copies = [_copied(state) for state in group.states]
    one = group.with_single_substeps(copies)
    nuclei = [[_nuclei(state) for state in copies]]
    for _ in range(2):
        one.make_substeps()
        nuclei.append([_nuclei(state) for state in copies])
    with np.errstate(over="ignore", invalid="ignore"):
        amplitudes = [np.linalg.norm(x - 2 * y + z, axis=0) / 4 for x, y, z in zip(*nuclei, strict=True)]
        means = np.array([one.sum() / max(FEWEST_CELLS, len(one)) for one in amplitudes])
    return np.where(np.isfinite(means), means, np.inf)


def _copied(state: TissueState) -> TissueState:
    copy, n = grown(state), state.sizes[CELLS]
    for mine, theirs in zip(copy.motion, state.motion, strict=True):
        mine[:n] = theirs[:n]
    return copy


def _nuclei(state: TissueState) -> Floats:
    n, cells = state.sizes[CELLS], state.cells
    return np.stack((cells.x[:n], cells.y[:n], cells.z[:n]))
