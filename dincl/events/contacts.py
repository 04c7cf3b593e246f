"""Which contacts are active from an event on: a least-distance program among the velocities.

x' = argmin |v - F| subject to n_r . v >= b_r for all rows r that touch; rows with multipliers > 0 are active.
"""

from dincl.compiled import inner
from dincl.events.many_contacts import VELOCITY, call_many
from dincl.events.motion import set_speed
from dincl.events.workspace import ACTIVE, CLOSED, OPEN, TOUCHING, EventWorkspace
from dincl.neighbours import ROW_MARGIN
from dincl.rows.table import VELOCITIES, call_python, gap, linearise
from dincl.solvers.active_set import CYCLES, nearest
from dincl.solvers.envelope_factor import row_dot
from dincl.solvers.sparse_factor import SPARSE_FROM
from dincl.solvers.wedges import narrowest
from dincl.steps.programs import list_sorted
from dincl.system.arrays import COINCIDENT, OK, SETS, WEDGE, evaluate, longest, system_at

# Multipliers and opening speeds are zero below the tolerance over the time of the run, but for these parts of the
# largest speed at least, for rounding, and at most.
LEAST_ZERO, ZERO = 1e-13, 1e-10
# In narrower wedges, see ``narrowest``, opening speeds are lost in the rounding of the program.
NARROWEST = 1e-8


@inner
def decide_contacts(run: EventWorkspace) -> int:
    """Decide which rows are active and which stay closed, and record the changes; OK or why it failed.

    A contact whose multiplier and opening speed are both zero stays closed without being active. It is decided again
    when one of them has grown to the threshold; or when the gap has become negative, and then any multiplier activates
    it.
    """
    state, system, active = run.state[0], system_at(run.system), run.active
    code = evaluate(system, state.t, run.x, system.program.y)
    if code == OK and call_python(system.sets, state.t, run.x, VELOCITIES) != 0:
        code = SETS
    if code != OK:
        return code
    state.speed = max(state.speed, longest(system.program.y, system.sets.shift.shape[1]))
    count = list_touching(run)
    if count < 0:
        return COINCIDENT
    system.program.answer[1] = narrowest(system.rows, system.near, system.program.gradient, run.touching, count)
    if system.program.answer[1] < NARROWEST:
        return WEDGE
    state.zero = min(max(state.tol / (state.end - state.start), LEAST_ZERO * state.speed), ZERO * state.speed)
    code = nearest_velocity(run, count)
    if code != OK:
        return code
    record_changes(run, count)
    active.number[0] = 0
    for q in range(count):
        r = run.touching[q]
        if run.contact[r] == ACTIVE:
            active.row[active.number[0]] = r
            active.number[0] += 1
    return OK


@inner
def list_touching(run: EventWorkspace) -> int:
    """List the rows whose gap is closed, with gradients and bounds; their number, -1 if one has no direction."""
    state, system, x = run.state[0], system_at(run.system), run.x
    rows, sets, near, program = system.rows, system.sets, system.near, system.program
    allowed, count = TOUCHING * state.size, 0
    list_sorted(system, state.t, x, allowed, ROW_MARGIN)
    for q in range(near.number[0]):
        r = near.row[q]
        if gap(rows, sets, r, x) <= allowed:
            value = linearise(rows, sets, r, x, program.gradient)
            if value != value:
                system.offending[0] = r
                return -1
            program.bound[r] = set_speed(system, r)
            state.speed = max(state.speed, abs(program.bound[r]))
            run.touching[count] = r
            count += 1
    return count


@inner
def nearest_velocity(run: EventWorkspace, count: int) -> int:
    """Solve for the velocity and the multipliers: with a sparse factor if many rows touch."""
    system, speed, code = system_at(run.system), run.state[0].speed, CYCLES
    if run.many != 0 and count >= SPARSE_FROM:
        code = call_many(run.many, run, VELOCITY, count, speed)
    return code if code != CYCLES else nearest(system.rows, run.touching, count, system.program, system.factor, speed)


@inner
def decide(run: EventWorkspace, r: int, overlap: float) -> int:
    """Return the state of a row that touches, from its multiplier and its opening speed.

    Any multiplier activates an open or closed row that overlaps by more than ``overlap``.
    """
    state, system = run.state[0], system_at(run.system)
    rows, program = system.rows, system.program
    overlaps = run.contact[r] != ACTIVE and gap(rows, system.sets, r, run.x) < -overlap
    if program.multiplier[r] > (0.0 if overlaps else state.zero):
        return ACTIVE
    opening = row_dot(rows, r, program.gradient, program.z) - program.bound[r]
    return CLOSED if opening <= state.zero else OPEN


@inner
def record_changes(run: EventWorkspace, count: int) -> None:
    """Set the state of the rows that touch, and of those that touched before; one that closes or opens is an event."""
    state, system, listed, decided = run.state[0], system_at(run.system), run.touching, run.decided
    touching = TOUCHING * state.size
    for q in range(count):
        decided[q] = decide(run, listed[q], 0.5 * touching)
    for q in range(state.closed):
        if not gap(system.rows, system.sets, run.closed[q], run.x) <= touching:
            listed[count], decided[count] = run.closed[q], OPEN
            count += 1
    state.closed = 0
    for q in range(count):
        r = listed[q]
        if (run.contact[r] == OPEN) != (decided[q] == OPEN):
            record_event(run, r, 0.0 if decided[q] == OPEN else 1.0)
        run.contact[r] = decided[q]
        if decided[q] != OPEN:
            run.closed[state.closed] = r
            state.closed += 1


@inner
def record_event(run: EventWorkspace, r: int, closes: float) -> None:
    """Record that row r closes or opens now; what is closed at the start is no event."""
    state, event = run.state[0], run.steps.event
    if state.phase > 0 and state.events < event.shape[0]:
        event[state.events, 0], event[state.events, 1] = state.t, r
        event[state.events, 2], event[state.events, 3] = closes, state.phase
        state.events += 1
