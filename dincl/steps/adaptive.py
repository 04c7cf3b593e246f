"""Steps of midpoint catch-up whose length follows an estimate of their error.

A step of midpoint catch-up makes a step x^ of linearised catch-up on its way. Six distances estimate its error; in
smooth motion each is O(h^2):

1. max_i |Z_i - X^_i|: the drift and the normals at the start against those in the middle.
2. max_i |sum_r multiplier_r (n_r(m) - n_r(z))_i|: the normals in the middle against those at the end. A particle that a
   linearised row holds back although nothing is in its way has an end whose normal is another one.
3. h/2 max_i |F(t + h, z) - F(t + h/2, m)|_i: a drift that jumps in the second half of a step. The value at z is the
   first one of the next step, so it costs nothing.
4. Contacts that decide over contacts. A new contact at t + theta h may end another one: until then the old contact
   pushes by theta h rho, rho its multiplier over the length of the step before, but the projection of x + h F knows
   only the sum of both pushes. So far as the multiplier of an old contact falls below h rho, the step may be wrong by
   this, unless theta is near 0: the step is repeated to end at the contact. With theta near 1 it hardly falls.
5. Contacts that begin and end in a step. Of two new contacts the later one may end the earlier one, whose multiplier is
   then less than its gap at the end, by the velocity of the last step, tells: the step is repeated to end where the
   earlier one begins. If all of it is missing, passes of any tolerance have the same error until both are apart.
6. Sets that come and go in a step. At the time t + s h a set that depends on time may be where the step did not look:
   the estimate is how far the point between x and z at that time is outside, before what remains of the push of this
   row. For one particle under a drift F that is z - (1 - s) h F, and the largest over all s is exact in one dimension:
   x(t + h) = max_s (w(t + s h) + (1 - s) h F) above a wall w. It is read from parabolas through five times.

The step after an estimate e has the length h (tau / e)^(1/2); a step with e > tau is made again.
"""

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import inner, kernel, reader
from dincl.compiled.arrays import Floats, Offsets
from dincl.constants import LARGEST
from dincl.neighbours import ROW_MARGIN, TOO_WIDE
from dincl.rows.table import CALLBACK, DISPLACEMENTS, GRADIENTS, call_python, gap, is_timed, linearise
from dincl.solvers.envelope_factor import add_row, row_dot
from dincl.steps.catch_up import drift_step
from dincl.steps.loop import Stepping, stepping_at
from dincl.steps.programs import list_sorted, project_onto_linearisation
from dincl.system.arrays import (
    DRIFT,
    NOT_A_NUMBER,
    OK,
    PYTHON,
    SETS,
    WEDGE,
    bounded,
    evaluate,
    farthest,
    longest,
    system_at,
)

# A step is at most so many times, and a repeated one at least this part of, the step before it; aimed at is this part
# of the tolerance.
LARGER, SMALLER, AIM = 3.0, 0.1, 0.9
# Part of its length with which a step is repeated that no projection solves.
UNSOLVED = 0.25
# A new contact farther from the start of a step than 1 / NEAR of its length counts in full. One predicted beyond this
# part of the step is predicted wrongly, or no multiplier would have fallen.
NEAR, LATEST = 4.0, 0.95
# One that is there after this part of a step is there at its start.
TOUCHING = 1e-2
# Looks at sets that depend on time, from the start to the end of a step.
LOOKS = 5
# Shortest step over the longest one, and the code of a run that would need a shorter one.
SHORTEST, TOO_SHORT = 1e-11, -1


class Adapting(NamedTuple):
    """Memory of steps of variable length, from one to the next."""

    middle: Floats  # (n,): x^, the end of the step of linearised catch-up
    first: Floats  # (n,): the drift at the start of a step
    velocity: Floats  # (n,): of the last step
    before: Floats  # (n,): the state before the last step
    row: Offsets  # (n,): rows that pushed in the last step
    multiplier: Floats  # (n,): and their multipliers
    number: Offsets  # (1,): how many they are, -1 before the first try of a step


def adapting(n: int) -> Adapting:
    """Make the memory of steps in n coordinates."""
    return Adapting(
        np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n, np.int64), np.zeros(n), np.full(1, -1)
    )


adapting_at = reader(adapting(0))


@inner
def note_pushing(system: Any, kept: Adapting) -> None:
    """Note the listed rows that pushed in the last step."""
    near, multiplier, count = system.near, system.program.multiplier, 0
    for q in range(near.number[0]):
        r = near.row[q]
        if multiplier[r] > 0.0 and count < kept.row.size:
            kept.row[count], kept.multiplier[count] = r, multiplier[r]
            count += 1
    kept.number[0] = count


@inner
def restore_pushing(system: Any, kept: Adapting) -> None:
    """Set the multipliers of a step that was repeated to those of the step before it, if it is not the first try."""
    near, multiplier = system.near, system.program.multiplier
    if kept.number[0] >= 0:
        for q in range(near.number[0]):
            multiplier[near.row[q]] = 0.0
        for p in range(kept.number[0]):
            multiplier[kept.row[p]] = kept.multiplier[p]


@inner
def fallen(system: Any, kept: Adapting, ratio: float) -> float:
    """Return by how much the multiplier of a row that pushed in the last step fell at most, over equal lengths."""
    multiplier, largest = system.program.multiplier, 0.0
    for p in range(kept.number[0]):
        largest = max(largest, ratio * kept.multiplier[p] - multiplier[kept.row[p]])
    return largest


@inner
def ahead(system: Any, kept: Adapting, r: int, x: Floats, h: float) -> float:
    """Return the linearised gap of a row at the end of a step from x with the velocity of the last one."""
    gradient = system.program.gradient
    now = row_dot(system.rows, r, gradient, x) - system.program.bound[r]
    return float(now + h * row_dot(system.rows, r, gradient, kept.velocity))


@inner
def closing(system: Any, r: int, x: Floats, at_end: float) -> float:
    """Return after which part of a step the gap of a row closes; half where the gap at its end does not say it."""
    open_now = gap(system.rows, system.sets, r, x)
    if open_now <= 0.0:
        return 0.0
    return float(open_now / (open_now - at_end)) if LATEST * (open_now - at_end) >= open_now else 0.5


@inner
def first_contact(system: Any, kept: Adapting, x: Floats, h: float, tau: float, fall: float) -> Any:
    """Return the estimate for the worst of the new contacts, and where in the step the first of those beyond tau is."""
    near, worst, earliest, p = system.near, 0.0, 1.0, 0
    for q in range(near.number[0]):
        r = near.row[q]
        if p < kept.number[0] and kept.row[p] == r:
            p += 1
        elif system.program.multiplier[r] > 0.0:
            place = closing(system, r, x, ahead(system, kept, r, x, h))
            wrong = fall * min(1.0, NEAR * place)
            worst = max(worst, wrong)
            if wrong > tau:
                earliest = min(earliest, place)
    return worst, earliest


@inner
def passing_contact(system: Any, kept: Adapting, x: Floats, h: float, tau: float) -> Any:
    """Return the estimate for new contacts that others end, and where in the step the first contact begins."""
    near, multiplier, gradient, p = system.near, system.program.multiplier, system.program.gradient, 0
    number, first, final, earliest, missing = 0, 1.0, 0.0, 1.0, 0.0
    for q in range(near.number[0]):
        r = near.row[q]
        if p < kept.number[0] and kept.row[p] == r:
            p += 1
            continue
        at_end = ahead(system, kept, r, x, h)
        if at_end < -tau or multiplier[r] > 0.0:
            place, square = closing(system, r, x, at_end), 0.0
            for k in range(system.rows.start[r], system.rows.stop[r]):
                square += gradient[k] ** 2
            number, first, final = number + 1, min(first, place), max(final, place)
            if place > TOUCHING:
                earliest = min(earliest, place)
            if square > 0.0:
                missing = max(missing, -at_end / square - multiplier[r])
    return missing * (final - first) / (1.0 - first) if number > 1 and first < 1.0 else 0.0, earliest


@inner
def normals_at_end(system: Any, t: float, z: Floats, push: Floats) -> bool:
    """Subtract from the push z - y of all rows that of their multipliers along the normals at z; false on failure."""
    near, program = system.near, system.program
    if call_python(system.sets, t, z, GRADIENTS) != 0:
        return False
    for q in range(near.number[0]):
        r = near.row[q]
        multiplier = program.multiplier[r]
        if multiplier > 0.0:
            linearise(system.rows, system.sets, r, z, program.gradient)
            add_row(system.rows, r, program.gradient, -multiplier, push)
    return True


@inner
def moves_within(system: Any, t: float, h: float, x: Floats) -> float:
    """Return how far the sets are at most, within a step, from where they are at its start, near x."""
    if system.sets.address == 0:
        return 0.0
    start, shift, largest = system.move, system.sets.shift, 0.0
    for k in range(LOOKS):
        system.sets.since[0] = t
        call_python(system.sets, t + k / (LOOKS - 1) * h, x, DISPLACEMENTS)
        for f in range(start.shape[0]):
            square = 0.0
            for c in range(start.shape[1]):
                if k == 0:
                    start[f, c] = shift[f, c]
                square += (shift[f, c] - start[f, c]) ** 2
            largest = max(largest, np.sqrt(square), system.sets.change[f])
    # The list of rows is compared with the sets at the start.
    system.sets.since[0] = system.near.time[0]
    call_python(system.sets, t, x, DISPLACEMENTS)
    return largest


@inner
def gap_before(system: Any, r: int, x: Floats, part: float) -> float:
    """Return the gap of a row at the point x of a step, for particles that its push has not reached yet.

    They will be pushed by this part of what all rows together, and at most this one, push them along its gradient.
    """
    rows, sets, program, square = system.rows, system.sets, system.program, 0.0
    gradient, push = program.gradient, 0.0
    if program.multiplier[r] > 0.0:
        for p in range(rows.start[r], rows.stop[r]):
            square += gradient[p] * gradient[p]
            push += gradient[p] * (program.z[rows.column[p]] - program.y[rows.column[p]])
        push = part * min(program.multiplier[r], max(0.0, push) / square)
    if push == 0.0:
        return float(gap(rows, sets, r, x))
    if rows.row[r].kind == CALLBACK:  # Python has evaluated it at x only
        return float(gap(rows, sets, r, x) + square * push)
    add_row(rows, r, gradient, push, x)
    value = gap(rows, sets, r, x)
    add_row(rows, r, gradient, -push, x)
    return float(value)


@inner
def outside_within(system: Any, t: float, h: float, x: Floats, point: Floats) -> float:
    """Return how far a step from x to z is outside of sets at a time within it; infinite if one has no value.

    Between three looks that is a parabola. Bounds and lengths of the program, not needed any more, take the last two.
    """
    rows, sets, near, program, worst, timed = system.rows, system.sets, system.near, system.program, 0.0, 0
    for q in range(near.number[0]):
        timed += is_timed(sets, rows.row[near.row[q]])
    for look in range(LOOKS if timed > 0 else 0):
        s = look / (LOOKS - 1)
        for k in range(x.size):
            point[k] = s * program.z[k] + (1.0 - s) * x[k]
        if call_python(sets, t + s * h, point, GRADIENTS) != 0:
            return np.inf
        for q in range(near.number[0]):
            r = near.row[q]
            if not is_timed(sets, rows.row[r]):
                continue
            now = -gap_before(system, r, point, 1.0 - s)
            if look > 0 and look % 2 == 0:
                worst = max(worst, highest(program.bound[r], program.length[r], now))
            program.bound[r], program.length[r] = program.length[r], now
    return worst


@inner
def highest(a: float, b: float, c: float) -> float:
    """Return the largest value of the parabola with the values a, b and c at the ends and in the middle of a part."""
    slope, bend = 0.5 * (c - a), 0.5 * (a + c) - b
    largest = max(a, b, c)
    return largest if abs(slope) >= -2.0 * bend else max(largest, b - slope * slope / (4.0 * bend))


@inner
def adaptive_step(
    run: Stepping, kept: Adapting, t: float, h: float, last: float, tau: float, tol: float, timed: bool
) -> Any:
    """Make a step of length h from the state x, write z to ``after`` and F(t + h, z) to ``rate``.

    Returns how it ended, the estimate of its error, and the part of it after which it is repeated if the estimate is
    for a contact, 0 if not. ``last`` is the length of the step before, 0 for none; ``timed`` whether sets depend on
    time.
    """
    system = system_at(run.system)
    restore_pushing(system, kept)
    start, middle, z, y, d = run.x, run.after, system.program.z, system.program.y, system.sets.shift.shape[1]
    for k in range(start.size):
        y[k] = start[k] + h * kept.first[k]
        if last == 0.0:
            kept.velocity[k] = kept.first[k]
    length = h * longest(kept.first, d)
    # A list that long steps have made holds too many rows for short ones, unless it is sets that move far in them.
    if system.sets.address == 0 and system.near.radius[0] > TOO_WIDE * length > 0.0:
        system.near.radius[0] = -1.0
    # The rows are linearised where they are at t, before anything can have passed a particle within the step.
    reach = moves_within(system, t, h, start) if timed else 0.0
    if not list_sorted(system, t, start, 2.0 * length + reach, ROW_MARGIN):
        return PYTHON, 0.0, 0.0
    search = system.near.number[1]
    note_pushing(system, kept)
    code = project_onto_linearisation(system, t, start, 2.0 * length, t + h, max(tol, np.sqrt(tol * length)))
    if code != OK:
        return code, 0.0, 0.0
    error = 0.0
    if last > 0.0 and system.near.number[1] == search:
        fall = fallen(system, kept, h / last)
        if fall > tau:
            error, earliest = first_contact(system, kept, start, h, tau, fall)
            if error > tau:
                return OK, error, earliest
    if system.near.number[1] == search:
        passing, earliest = passing_contact(system, kept, start, h, tau)
        error = max(error, passing)
        if error > tau:
            return OK, error, earliest
    for k in range(start.size):
        kept.middle[k] = z[k]
        middle[k] = 0.5 * (start[k] + z[k])
    code = drift_step(system, t + 0.5 * h, middle, h, start, run.rate)
    if code == OK:
        code = project_onto_linearisation(system, t + 0.5 * h, middle, 2.0 * length, t + h, tol)
    if code != OK:
        return code, 0.0, 0.0
    error = max(error, farthest(z, kept.middle, d))
    if timed:
        outside = outside_within(system, t, h, start, middle)
        if outside == np.inf:
            return SETS, 0.0, 0.0
        error = max(error, outside)
    # ``middle`` holds the push at the end from here on, then the drift in the middle.
    for k in range(z.size):
        middle[k] = z[k] - y[k]
    if not normals_at_end(system, t + h, z, middle):
        return SETS, 0.0, 0.0
    error = max(error, longest(middle, d))
    for k in range(z.size):
        middle[k] = run.rate[k]
    code = evaluate(system, t + h, z, run.rate)
    error = max(error, 0.5 * h * farthest(run.rate, middle, d))
    for k in range(z.size):
        middle[k] = z[k]
    return code, error, 0.0


@kernel
def adapt(
    place: int,
    memory: int,
    t: float,
    end: float,
    stop: float,
    h: float,
    last: float,
    tau: float,
    longest_step: float,
    tol: float,
    timed: bool,
    most: int,
) -> tuple[int, float, float, float, int, int]:
    """Make steps from t towards ``end``, until ``stop`` is reached, with estimates of at most ``tau``.

    ``h`` is about the length of the first one, ``last`` that of the step before, 0 for none. At most ``most`` steps are
    made or repeated; ``timed`` says whether sets depend on time. Returns how the last one ended, the time reached, the
    length of the next step, that of the last one, and how many were made and repeated. A step that fails leaves the
    state as it was; TOO_SHORT: one of SHORTEST of the longest one has an estimate beyond ``tau``.
    """
    run, kept = stepping_at(place), adapting_at(memory)
    system = system_at(run.system)
    made, repeated, least = 0, 0, SHORTEST * longest_step
    code = evaluate(system, t, run.x, kept.first)
    while t < stop and code == OK and made + repeated < most:
        h = min(h, longest_step)
        step, number = h, np.ceil((end - t) / h * (1.0 - 1e-12))
        # Two equal steps in place of a long and a tiny one.
        if number <= 2.0:
            step = (end - t) / number
        code, error, contact = adaptive_step(run, kept, t, step, last, tau, tol, timed)
        if code == OK and contact == 0.0 and not bounded(run.after, LARGEST):
            code = NOT_A_NUMBER
        if code == OK and contact == 0.0 and error <= tau:
            for k in range(run.x.size):
                kept.velocity[k] = (run.after[k] - run.x[k]) / step
                kept.before[k] = run.x[k]
                run.x[k] = run.after[k]
                kept.first[k] = run.rate[k]
            kept.number[0] = -1
            t = end if number <= 1.0 else t + step
            made += 1
            last = step
            growth = LARGER if error == 0.0 else min(LARGER, max(0.5, AIM * np.sqrt(tau / error)))
            h = max(step * growth, h if growth >= 1.0 else 0.0)
        elif step <= least:
            code = TOO_SHORT if code == OK else code
        elif code not in (DRIFT, SETS, PYTHON, WEDGE):
            repeated += 1
            if contact > 0.0:
                h = max(contact, SMALLER) * step
            else:
                h = step * (UNSOLVED if code != OK else max(SMALLER, AIM * min(1.0, np.sqrt(tau / error))))
            code = OK
    return code, t, h, last, made, repeated
