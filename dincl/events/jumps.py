"""Stops of a run: where the velocity of a set jumps, and where the drift does, which is found on the way."""

from dincl.compiled import inner
from dincl.events.arrays import march_at
from dincl.events.motion import EPS, allowed_error, at, correct, dense_state, move
from dincl.system.arrays import OK

# The step is to be made again: a shorter one, or one that ends at a jump.
AGAIN = 30
# An estimate below this hides no error as large as the tolerance: the estimate of a step over a jump is at least about
# a thousandth of the error.
NEGLIGIBLE = 1e-4
# The part of a step at which the motion is compared: none of the stages lies there, and it alternates between runs.
PLACES = (0.63, 0.41)
# Largest allowed difference between the derivative of the dense output and the motion, times the step, over the
# tolerance. Without a limit smooth problems take 6 % fewer evaluations, with 10 in place of 30 they take 21 % more.
DEFECT = 30.0
# A step is divided into this many parts to look for a jump. A difference that shrinks below this share of its first
# value while its part is halved is no jump.
PARTS, SHRINKS = 8, 0.3
# Jumps allowed in one run.
MOST_JUMPS = 10_000


@inner
def set_stop(run: int) -> None:
    """Stop next where the velocity of a set jumps, or at the end."""
    march = march_at(run)
    state = march.state[0]
    state.stop = state.resume = state.end
    if 2 * state.kink < march.kinks.size:
        state.stop, state.resume = march.kinks[2 * state.kink], march.kinks[2 * state.kink + 1]


@inner
def pass_stop(run: int) -> int:
    """Go to the other side of a jump, and decide the contacts anew."""
    march = march_at(run)
    state = march.state[0]
    if 2 * state.kink < march.kinks.size and state.stop == march.kinks[2 * state.kink]:
        state.kink += 1
    state.now, state.choose, state.h = state.resume, 1, max(state.h, state.usual)
    if state.pieces > 0:
        march.path.end[state.pieces - 1] = state.now
    set_stop(run)
    return correct(run, state.now, march.x)


@inner
def look_for_jump(run: int, h: float) -> int:
    """Compare the dense output of a step with the motion between its stages: OK, AGAIN or a failure."""
    march = march_at(run)
    state = march.state[0]
    if state.error < NEGLIGIBLE:
        return OK
    # Runs have 1, 2, 4, 8 parts.
    place = PLACES[0] if state.parts % 3 == 1 else PLACES[1]
    code = motion(run, h, place)
    if code != OK:
        return code
    axis, largest = 0, 0.0
    for k in range(march.x.size):
        part = abs(h * defect(run, h, place, k)) / allowed_error(run, k)
        if part > largest:
            axis, largest = k, part
    return search(run, h, axis) if largest > DEFECT else OK


@inner
def search(run: int, h: float, axis: int) -> int:
    """Let the run stop at the jump of this coordinate of its velocity; where there is none the step is too long."""
    state = march_at(run).state[0]
    a, b, first, last, widest, before = 0.0, 1.0, 0.0, 0.0, -1.0, 0.0
    for j in range(1, PARTS + 1):
        code = motion(run, h, j / PARTS)
        if code != OK:
            return code
        value = defect(run, h, j / PARTS, axis)
        if abs(value - before) > widest:
            a, b, first, last, widest = (j - 1) / PARTS, j / PARTS, before, value, abs(value - before)
        before = value
    while (b - a) * h > 2.0 * EPS * (state.now + h):
        middle = 0.5 * (a + b)
        code = motion(run, h, middle)
        if code != OK:
            return code
        value = defect(run, h, middle, axis)
        if abs(value - first) > abs(last - value):
            b, last = middle, value
        else:
            a, first = middle, value
        if not abs(last - first) > SHRINKS * widest:
            state.h = 0.25 * h
            return AGAIN
    rounding = 4.0 * EPS * (state.now + h)
    state.stop, state.resume = state.now + a * h - rounding, min(state.now + b * h + rounding, state.end)
    state.jumps += 1
    code = OK if state.stop > state.now else pass_stop(run)
    return AGAIN if code == OK else code


@inner
def motion(run: int, h: float, theta: float) -> int:
    """The velocity at a part of the step, on its dense output, in the last rate."""
    march = march_at(run)
    dense_state(run, theta)
    return move(run, march.state[0].now + theta * h, march.point, march.rate[16], march.push[16])


@inner
def defect(run: int, h: float, theta: float, k: int) -> float:
    """How far coordinate k of this velocity is from the derivative of the dense output."""
    march = march_at(run)
    return float(march.rate[16, k] - at(march.dense, march.pair.terms, march.x[k], k, theta)[1] / h)
