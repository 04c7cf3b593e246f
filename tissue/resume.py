"""A run that goes on from a kept state: as if it had not stopped, or with other parameters from there on."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe
from dincl.checks import seed as checked_seed
from dincl.errors import InvalidProblem
from tissue.events.known import bit
from tissue.files.combinations import ROUNDING
from tissue.files.frames import checked
from tissue.kernels.board import LOST
from tissue.kernels.curve import curve_numbers
from tissue.kernels.store import IN_PLANE, Store, stored
from tissue.resumed_types import typed
from tissue.space.start import space_of
from tissue.start import of_kinds
from tissue.state.cells import Cells
from tissue.state.checkpoint import TissueCheckpoint, resumed_streams
from tissue.state.frame import A_START, Frame
from tissue.state.streams import streams
from tissue.step.advance import find_lost

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.streams import Streams


def resumed(parameters: Parameters, start: Frame, seed: int) -> tuple[Store, Streams]:
    """The tissue and the random numbers with which a run goes on from ``start``.

    With the seed of the run that ``start`` is of, the streams go on where they stood; with another one they begin.

    Raises
    ------
    InvalidProblem
        If the state is not of a run or was lost, or does not go with the parameters; the message names what must
        change.
    """
    past = checkpoint_of(start)
    goes_on = checked_seed("seed", seed) == past.seed
    random = resumed_streams(seed, past.generators) if goes_on else streams(seed)
    cells = Cells._make(array.copy() for array in start.cells)
    emt = typed(parameters, start, cells, random)
    _stiffen(parameters, cells)
    _refuse_layer(parameters, start)
    curve = curve_numbers(parameters.curve())
    capacity = 2 * len(cells.x)
    space = IN_PLANE if start.sheets is None else space_of(start.sheets, parameters.exchange(), capacity)
    held = stored(cells, start.layers, past.next_id, emt, capacity=capacity, curve=curve, space=space)
    held.counts[:] = past.counts
    lost = find_lost(held)
    if lost >= 0:
        raise InvalidProblem(
            f"start at t = {start.t:g} h: cell {cells.id[lost]} has a coordinate that is not finite, or beyond "
            f"{LOST:g} R_soft: must be a state before the run failed"
        )
    return held, random


def _refuse_layer(parameters: Parameters, start: Frame) -> None:
    """Refuse a basal layer on which the basal points of the start do not lie."""
    if parameters.in_space != (start.sheets is not None):
        raise InvalidProblem(f"tissue.dimension = {parameters.tissue.dimension}: must be that of the start")
    if start.sheets is not None and start.sheets.surface != parameters.lattice().surface:
        raise InvalidProblem("the basal surface of [layer], [space] and [tissue]: must be that of the start")
    mine, theirs = parameters.curve(), start.curve
    if not (mine.ring == theirs.ring and np.array_equal(mine.table, theirs.table)):
        raise InvalidProblem(f'layer.shape = "{parameters.layer.shape}": [layer] must be that of the start')


def checkpoint_of(start: Frame) -> TissueCheckpoint:
    """What a run is besides its cells; raises InvalidProblem if it is not there."""
    if not isinstance(start, Frame):
        raise InvalidProblem(f"start = {describe(start)}: must be {A_START}")
    checked("start", (*start[:4], start.past, start.sheets))
    return start.past


def steps_made(parameters: Parameters, start: Frame) -> int:
    """How many steps dt have led to ``start``; raises InvalidProblem if it is no whole number, or too many."""
    checkpoint_of(start)
    dt, end = parameters.numerics.dt, parameters.numerics.t_end
    made, last = start.t / dt.value, round(end.value / dt.value)
    if abs(made - round(made)) > ROUNDING * made:
        raise InvalidProblem(f'numerics.dt = "{dt}": must divide the time of the start, t = {start.t:g} h')
    if round(made) > last:
        raise InvalidProblem(f'numerics.t_end = "{end}": must be at least the time of the start, t = {start.t:g} h')
    return round(made)


def _stiffen(parameters: Parameters, cells: Cells) -> None:
    """Give the springs the stiffness of the parameters, as rules and events would have; see ``tissue.events``."""
    numbers = parameters.numbers()
    own = partial(of_kinds, cells.kind, (numbers, numbers, *parameters.named_numbers()))
    freed_a, freed_b = cells.events & bit("a") > 0, cells.events & bit("b") > 0
    cells.stiff_ax[:] = np.where(freed_a, own("alpha_ax") * numbers.freed_stiffness, own("alpha_ax"))
    free = np.where(freed_b, own("alpha_bx") * numbers.freed_stiffness, own("alpha_bx"))
    cells.stiff_bx[:] = np.where(cells.events & bit("p") > 0, cells.stiff_bx, free)  # [P] gives its own in each dt
    cells.stiff_axb[:] = np.where(cells.events & bit("s") > 0, numbers.bent_stiffness, own("alpha_axb"))
