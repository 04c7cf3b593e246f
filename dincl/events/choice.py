"""Which contacts push from an event on: a least-distance program among the velocities."""

from dincl.compiled import inner
from dincl.events.arrays import CLOSED, HELD, OPEN, march_at
from dincl.events.motion import least_speed
from dincl.neighbours import ROW_MARGIN
from dincl.rows.table import VELOCITIES, call_python, gap, linearise
from dincl.solvers.active_set import CYCLES, nearest
from dincl.solvers.factor import times
from dincl.solvers.sparse_active_set import nearest_sparse
from dincl.solvers.sparse_factor import SPARSE_FROM, gram_at
from dincl.solvers.sparse_order import FEW, analyse, covers
from dincl.steps.catch_up import list_sorted
from dincl.system.arrays import COINCIDENT, OK, SETS, evaluate, longest, system_at

# Gaps up to this are contacts, relative to the size of the problem; rounding leaves 1e-15.
TOUCHING = 1e-13
# Pushes and opening speeds are zero below the tolerance over the time of the run, but for these parts of the largest
# speed at least, for rounding, and at most.
LEAST_ZERO, ZERO = 1e-13, 1e-10
# Usual phases to look ahead for rows that are analysed with those that touch.
COMING = 10.0


@inner
def choose(run: int) -> int:
    """Decide which rows are held, which stay closed, and note the changes; OK, or why it failed.

    A contact whose push and opening speed are both zero stays closed without being held. That is watched, and decided
    when one of them has grown to the threshold; or when the gap has become negative, and then any push holds it.
    """
    march = march_at(run)
    state, system, held = march.state[0], system_at(march.place), march.held
    program, x, d = system.program, march.x, system.sets.shift.shape[1]
    code = evaluate(system.drift, system.sets.shift.shape[1], state.now, x, program.y)
    if code == OK and call_python(system.sets, state.now, x, VELOCITIES) != 0:
        code = SETS
    if code != OK:
        return code
    state.speed = max(state.speed, longest(program.y, d))
    count = list_touching(run)
    if count < 0:
        return COINCIDENT
    state.slow = min(max(state.tol / state.end, LEAST_ZERO * state.speed), ZERO * state.speed)
    code = nearest_velocity(run, count)
    if code != OK:
        return code
    note_changes(run, count)
    held.number[0] = 0
    for q in range(count):
        r = march.touching[q]
        if march.closed[r] == HELD:
            held.row[held.number[0]] = r
            held.number[0] += 1
    return OK


@inner
def nearest_velocity(run: int, count: int) -> int:
    """Find the nearest velocity to the drift, and the pushes: with a sparse factor where many rows touch."""
    march = march_at(run)
    system, gram, speed = system_at(march.place), gram_at(march.gram), march.state[0].speed
    rows, program, code = system.rows, system.program, CYCLES
    if count >= SPARSE_FROM:
        covered = covers(march.touching, count, gram)
        if covered or analyse(rows, march.touching, list_coming(run, count), gram):
            code = nearest_sparse(rows, march.touching, count, program, gram, speed)
    return code if code != CYCLES else nearest(rows, march.touching, count, program, system.chosen, speed)


@inner
def list_coming(run: int, count: int) -> int:
    """List after the rows that touch those that do so soon if all goes on as before; the number of all.

    They are analysed with the others, switched off, so that the analysis serves for more than one event.
    """
    march = march_at(run)
    state, system, x, point = march.state[0], system_at(march.place), march.x, march.point
    rows, sets, near, found = system.rows, system.sets, system.near, count
    for k in range(x.size):
        point[k] = x[k] + COMING * state.usual_phase * march.rate[0, k]
    for q in range(near.number[0]):
        r = near.row[q]
        touches = gap(rows, sets, r, x) <= TOUCHING * state.size
        if not touches and found < count + FEW and gap(rows, sets, r, point) <= 0.0:
            march.touching[found] = r
            found += 1
    return found


@inner
def list_touching(run: int) -> int:
    """List the rows whose gap is closed, with gradients and least speeds; their number, -1 if one has no direction."""
    march = march_at(run)
    state, system, x = march.state[0], system_at(march.place), march.x
    rows, sets, near, program = system.rows, system.sets, system.near, system.program
    allowed, count = TOUCHING * state.size, 0
    list_sorted(march.place, state.now, x, allowed, ROW_MARGIN)
    for q in range(near.number[0]):
        r = near.row[q]
        if gap(rows, sets, r, x) <= allowed:
            value = linearise(rows, sets, r, x, program.gradient)
            if value != value:
                system.blamed[0] = r
                return -1
            program.bound[r] = least_speed(system, r)
            state.speed = max(state.speed, abs(program.bound[r]))
            march.touching[count] = r
            count += 1
    return count


@inner
def note_changes(run: int, count: int) -> None:
    """Say what each row is now; a row that closes or opens is an event, but for those at the start."""
    march = march_at(run)
    state, system = march.state[0], system_at(march.place)
    program, rows = system.program, system.rows
    zero, overlap = state.slow, -0.5 * TOUCHING * state.size
    for q in range(count):
        r = march.touching[q]
        opening = times(rows, r, program.gradient, program.z) - program.bound[r]
        least = zero if march.closed[r] == HELD or not gap(rows, system.sets, r, march.x) < overlap else 0.0
        if program.multiplier[r] > least:
            march.change[r] = HELD
        elif opening <= zero:
            march.change[r] = CLOSED
    for q in range(state.listed):
        r = march.listed[q]
        if march.change[r] == OPEN:
            march.closed[r] = OPEN
            note_event(run, r, 0.0)
    state.listed = 0
    for q in range(count):
        r = march.touching[q]
        if march.change[r] != OPEN:
            if march.closed[r] == OPEN:
                note_event(run, r, 1.0)
            march.closed[r], march.change[r] = march.change[r], OPEN
            march.listed[state.listed] = r
            state.listed += 1


@inner
def note_event(run: int, r: int, closes: float) -> None:
    """Note that row r closes or opens now, but not at the start."""
    march = march_at(run)
    state, event = march.state[0], march.path.event
    if state.phase > 0 and state.events < event.shape[0]:
        event[state.events, 0], event[state.events, 1] = state.now, r
        event[state.events, 2], event[state.events, 3] = closes, state.phase
        state.events += 1
