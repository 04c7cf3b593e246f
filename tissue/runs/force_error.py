"""Whether a force of a user is minus the slope of its energy."""

from __future__ import annotations

import numpy as np

from dincl.checks import instance, number
from dincl.errors import InvalidProblem
from tissue.frames.observables import measurable
from tissue.kernels import kernel
from tissue.plugins import Force
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import answered, code_of, users_of
from tissue.runs.run import Run
from tissue.runs.start import space_of
from tissue.state.basal_curve import curve_numbers
from tissue.state.cells import Floats
from tissue.state.numbers import Numbers, numbers_pointer
from tissue.state.running import CELLS, TissueState, new_state
from tissue.step.user_forces import call_energy, call_push, clear

# [R_soft]: what central differences miss, and what they lose by rounding, are both near 1e-10.
SHIFT = 1e-5


def force_error(force: Force, run: Run, strength: float = 1.0) -> float:
    """Return how far a force is from minus the slope of its energy, over all points of the last state of a run.

    max |F + D| / max(|F|, |D|),  D = (W(Z + h e) - W(Z - h e)) / (2 h),  h = 1e-5 R_soft

    Below 1e-6 for a force that is right, unless W is large, or bends within h of a point.

    Parameters
    ----------
    force
        One with an energy.
    run
        Of any parameters: its last state with finite coordinates is looked at.
    strength
        > 0

    Raises
    ------
    InvalidProblem
        If the force has no energy, one of both raises, cannot be compiled or is not finite, or neither does anything in
        this state.
    """
    instance("force", force, Force, "a tissue.Force")
    instance("run", run, Run, "a tissue.Run")
    if force.energy is None:
        raise InvalidProblem(f"Force {force.name}: energy = None: must be a function to compare push with")
    strength = number("strength", strength, positive=True)
    frame = measurable(run.frames)[-1]
    past = frame.past
    curve, n = curve_numbers(frame.curve), len(frame.cells.x)
    space = in_plane() if frame.sheets is None else space_of(frame.sheets, run.parameters.longest_edge(), n)
    state = new_state(frame.cells, frame.layers, past.next_id, past.emt, capacity=n, curve=curve, space=space)
    state.clock[:] = frame.t
    slopes, forces = np.zeros((2, 6 if frame.sheets is None else 9, n))
    (push,), (energy,) = code_of("push", [force]), code_of("energy", [force])
    numbers = numbers_pointer(run.parameters.numbers())
    with answered(users_of(more=(push, energy))):
        _compare((int(push), int(energy)), state, strength, numbers, slopes, forces)
    if not np.isfinite([slopes, forces]).all():
        raise InvalidProblem(f"Force {force.name} at t = {frame.t:g} h: must give finite forces and energies")
    largest = np.abs([slopes, forces]).max()
    if largest == 0:
        raise InvalidProblem(f"Force {force.name} at t = {frame.t:g} h: must act on a point, to be compared")
    return float(np.abs(slopes + forces).max() / largest)


@kernel
def _compare(
    addresses: tuple[int, int], state: TissueState, strength: float, numbers: Numbers, slopes: Floats, forces: Floats
) -> None:
    """Compute the forces on the points of n cells, and the slopes of the energy there, each (6, n), in space (9, n)."""
    push, energy = addresses
    cells, on = state.cells, state.on
    clear(state)
    call_push(push, state, on, strength, numbers)
    pairs = (cells.x, on.x), (cells.y, on.y), (cells.ax, on.ax), (cells.ay, on.ay), (cells.bx, on.bx), (cells.by, on.by)
    deep = (cells.z, on.z), (cells.az, on.az), (cells.bz, on.bz)
    for row, (z, force) in enumerate(pairs + deep):
        for i in range(state.sizes[CELLS] if row < len(slopes) else 0):
            here = z[i]
            z[i] = high = here + SHIFT
            above = call_energy(energy, state, strength, numbers)
            z[i] = low = here - SHIFT
            below = call_energy(energy, state, strength, numbers)
            z[i] = here
            slopes[row, i] = (above - below) / (high - low)
            forces[row, i] = force[i]
