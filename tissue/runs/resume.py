"""A run that goes on from a saved state: as if it had not stopped, or with other numbers from there on."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe
from dincl.checks import seed as checked_seed
from dincl.errors import InvalidProblem
from tissue.events.known import bit, events
from tissue.files.groups import crowd_of
from tissue.files.parameter_files import flat
from tissue.files.quantities import Timing
from tissue.files.sections import ROUNDING, UNNAMED
from tissue.files.together import check_groups
from tissue.frames.frame import A_START, Frame
from tissue.frames.frame_files import checked
from tissue.kernels.workspace import LOST
from tissue.network.lattice import Lattice
from tissue.network.neighbours import apical_points, basal_points
from tissue.network.triangulation import triangulate
from tissue.plugins import EmtEvent, registered
from tissue.rules.slice import in_plane
from tissue.runs.start import of_kinds, space_of
from tissue.state.basal_curve import curve_numbers
from tissue.state.cells import CONTROL, Cells, Emt
from tissue.state.checkpoint import resumed_streams, streams
from tissue.state.running import TissueState, copied, new_state
from tissue.step.advance import find_lost

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.checkpoint import Streams, TissueCheckpoint

# Keys of groups of cells that were used at the start, besides the times of events.
OF_GROUPS = ("cells", "inm", "place", "divides", "initial_rest_length")


def resumed(parameters: Parameters, start: Frame, seed: int) -> tuple[TissueState, Streams]:
    """Return the tissue and the random numbers with which a run goes on from ``start``.

    With the seed of the run that ``start`` is of, the streams go on where they stood; with another one they begin.
    Cells keep their types and the times of their events. A tissue of control cells gets its groups now, where the
    parameters have them.

    Raises
    ------
    InvalidProblem
        If the state is not of a run or was lost, or does not go with the parameters; the message names what must
        change.
    """
    past = checkpoint_of(start)
    goes_on = checked_seed("seed", seed) == past.seed
    random = resumed_streams(seed, past.generators) if goes_on else streams(seed)
    cells, emt = Cells._make(array.copy() for array in start.cells), copied(past.emt)
    of_controls = bool((cells.kind == CONTROL).all() and (cells.emt < 0).all())
    _refuse_other(parameters, start, past, of_controls=of_controls)
    if of_controls:
        emt = _with_groups(parameters, start, cells, random)
    _stiffen(parameters, cells)
    changed = start.cells.events & sum(bit(event.name) for event in registered(EmtEvent)) > 0
    for name in ("stiff_ax", "stiff_bx", "stiff_axb"):  # as events of users have left them
        getattr(cells, name)[changed] = getattr(start.cells, name)[changed]
    curve = curve_numbers(parameters.curve())
    capacity = 2 * len(cells.x)
    space = in_plane() if start.sheets is None else space_of(start.sheets, parameters.longest_edge(), capacity)
    state = new_state(cells, start.layers, past.next_id, emt, capacity=capacity, curve=curve, space=space)
    state.counts[:], state.clock[:] = past.counts, start.t
    if (lost := find_lost(state)) >= 0:
        what = f"cell {cells.id[lost]} has a coordinate that is not finite, or beyond {LOST:g} R_soft"
        raise InvalidProblem(f"start at t = {start.t:g} h: {what}: must be a state before the run failed")
    for _, points in (apical_points(state), basal_points(state)) if start.sheets is not None else ():
        try:
            triangulate(space.surface, points, space.longest)
        except InvalidProblem as error:
            what = f"start at t = {start.t:g} h: must be a state before the run failed, but its network is torn"
            raise InvalidProblem(f"{what}: {error}") from None
    return state, random


def _refuse_other(parameters: Parameters, start: Frame, past: TissueCheckpoint, *, of_controls: bool) -> None:
    """Refuse another unit of length, another layer, and other groups of a tissue that has some."""
    mine, theirs = flat(parameters.as_dict()), flat(past.tables)
    drawn = {*OF_GROUPS, *(event.name for event in events())}
    for key in dict.fromkeys((*mine, *theirs)):
        section, _, name = key.rpartition(".")
        of_group = (section in UNNAMED or section.startswith("types.")) and name in drawn
        fixed = key in ("cell.soft_radius", "tissue.dimension") or section == "layer"
        if (fixed or (of_group and not of_controls)) and mine.get(key) != theirs.get(key):
            was = "left out" if key not in theirs else f"{describe(theirs[key])}"
            raise InvalidProblem(f"{key} = {describe(mine.get(key))}: must be that of the start, {was}")
    if not of_controls and parameters.type_names != (*UNNAMED, *past.types):
        raise InvalidProblem(f"[types]: must be in the order of the start, {', '.join(past.types)}")
    if start.sheets is not None and start.sheets.surface != parameters.lattice().surface:
        raise InvalidProblem("the basal surface of [layer], [space] and [tissue]: must be that of the start")
    if not np.array_equal(start.curve.table, parameters.curve().table):
        raise InvalidProblem("the basal layer of [layer] and [tissue]: must be that of the start")


def checkpoint_of(start: Frame) -> TissueCheckpoint:
    """Return the checkpoint of a frame; raises InvalidProblem if there is none."""
    if not isinstance(start, Frame):
        raise InvalidProblem(f"start = {describe(start)}: must be {A_START}")
    past = start.past
    checked("start", start)
    return past


def steps_made(parameters: Parameters, start: Frame) -> int:
    """Count the steps dt to ``start``; raises InvalidProblem if it is no whole number, or too many."""
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


def _with_groups(parameters: Parameters, start: Frame, cells: Cells, random: Streams) -> Emt:
    """Give a tissue of control cells the groups of the parameters; return the EMT cells."""
    n = len(cells.x)
    check_groups(parameters.types.named(), n, parameters.emt)
    lattice = None
    if start.sheets is not None:
        lattice = Lattice(start.sheets.surface, np.stack((cells.bx, cells.by, cells.bz)), spacing=0.0)
    crowd = crowd_of(parameters.groups(), n, random, lattice)
    mine = crowd.kind != CONTROL
    cells.kind[:], cells.emt[:] = crowd.kind, crowd.numbers()
    cells.moves[mine], cells.divides[mine] = crowd.moves[mine], crowd.divides[mine]
    emt = crowd.emt()
    for i in np.flatnonzero(cells.emt >= 0) if start.t > 0 else ():
        name = parameters.type_names[cells.kind[i]]
        group = parameters.emt if name in UNNAMED else parameters.types.named()[name]
        section = name if name in UNNAMED else f"types.{name}"
        for event, time in zip(events(), emt.at[:, cells.emt[i]], strict=True):
            if time <= start.t:
                given = getattr(group, event.name, Timing())
                raise InvalidProblem(
                    f'{section}.{event.name} = "{given}": must be after the time of the start, t = {start.t:g} h; this '
                    f"seed draws {time:g} h for cell {cells.id[i]}"
                )
    return emt
