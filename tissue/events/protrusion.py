"""[P]: protrusive activity (section 2.2.4 of chapter 4), which begins when the basal point is free, after [B]."""

from __future__ import annotations

import math

from tissue.model.extents import height_above
from tissue.model.springs import basal_length
from tissue.plugins import EmtEvent
from tissue.state.numbers import Numbers
from tissue.state.running import ANY, TissueState

# A point that is no farther above a layer is on it [R_soft]: where the layer bends, its height is 0 up to rounding.
ON_LAYER = 1e-9


def last(state: TissueState, i: int, rest_ax: float, rest_bx: float, numbers: Numbers) -> None:
    """Set how the basal point of cell i moves, and what its spring does, by where the point is now.

    Above the depth at which the run ends it moves by itself (4.1), below it rests, or follows the forces. There is
    nothing to hold on to above the basal line: the spring has no force, or gives way as fast as the point runs. Below
    the line its rest length tends from that before this dt to 0.
    """
    cells, motion = state.cells, state.motion
    height = height_above(state, cells.bx[i], cells.by[i], cells.bz[i], ANY)
    running = height > -numbers.run_depth
    moves = 1.0 if not running and numbers.forced_below else 0.0
    motion.moves[i] = moves
    motion.runs[i] = numbers.run_speed * numbers.dt / numbers.substeps if running else 0.0
    stiffness = numbers.alpha_bx * numbers.freed_stiffness
    if height <= ON_LAYER:
        cells.rest_bx[i] = rest_bx * math.exp(-numbers.dt / numbers.contraction)
    elif numbers.spring_gives:
        cells.rest_bx[i] = rest_bx + numbers.run_speed * numbers.dt
    else:
        cells.rest_bx[i] = basal_length(cells, i) - numbers.soft_radius
        stiffness = 0.0
    cells.stiff_bx[i] = stiffness


EVENT = EmtEvent(
    name="p",
    meaning="protrusive activity: the basal point runs away from the nucleus and pulls it along",
    source="section 2.2.4 of chapter 4",
    last=last,
    after="b",
)
