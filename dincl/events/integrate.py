"""From event to event: a run of the event-driven method, in pieces that fill the room there is."""

import numpy as np

from dincl.compiled import inner, kernel
from dincl.compiled.arrays import Floats, Offsets
from dincl.events.arrays import march_at
from dincl.events.choice import choose
from dincl.events.jumps import AGAIN, MOST_JUMPS, look_for_jump, pass_stop
from dincl.events.motion import at, correct, move
from dincl.events.signals import NEVER
from dincl.events.steps import NO_STEP, STUCK, arrive, make_step, take
from dincl.events.watch import first_event
from dincl.solvers.sparse_factor import gram_at
from dincl.system.arrays import OK, SETS, bounded, longest, system_at

# How a call ends besides the codes of ``system`` and ``event_steps``: the time is reached; the room is full, so that it
# is to be called again; too many steps are needed; the drift jumps too often.
DONE, FULL, SLOW, JUMPS = 20, 21, 24, 25
# Changes of the contacts at one time.
MOST_AT_ONCE = 100
# Steps of a run: a hundred discs with 300 events take about a thousand. After this many it is asked how many it needs.
MOST_STEPS, LOOK = 100_000, 5_000
# An event before a jump by no more than this part of the run is at the jump.
MEETS = 1e-12
# The share of the last phase in the mean of their lengths. In runs of many particles a step is at most this many times
# that mean, for a run in one part, in two parts two thirds of it; twice as much after each step without an event.
SHARE, PHASES = 0.1, 3.0
# Pieces for which there is room at the beginning of a step: on the way to an event.
ROOM = 32


@inner
def begin_phase(run: int) -> int:
    """Count the phase that begins once the contacts are decided; its longest step, and the first one of a run."""
    march = march_at(run)
    state = march.state[0]
    state.at_once = state.at_once + 1 if state.phase > 0 and state.now == state.chosen_at else 0
    if state.phase > 0 and state.now > state.chosen_at:
        share = max(SHARE, 1.0 / state.phase)
        state.usual_phase += share * (state.now - state.chosen_at - state.usual_phase)
    state.chosen_at, state.choose = state.now, 0
    state.phase += 1
    state.longest = (state.end - state.now) / state.parts
    if state.cuts != 0 and state.usual_phase > 0.0:
        # A longer step would be cut at the next event, and its error estimate, for all of it, would be in the way.
        state.longest = min(state.longest, PHASES * 2.0 / (1.0 + state.parts) * state.usual_phase)
    if state.at_once > MOST_AT_ONCE:
        return STUCK
    if state.h == 0.0:
        reach = state.size * min(1.0, state.tol / state.size) ** (1.0 / (march.pair.order + 1.0))
        state.h = min(state.longest, 0.1 * reach / state.speed if state.speed > 0.0 else state.longest)
    return OK


@inner
def decide(run: int) -> int:
    """Decide the contacts, and begin a phase with them."""
    march = march_at(run)
    state, system = march.state[0], system_at(march.place)
    # What started small and went far rounds as what is large.
    state.size = max(state.size, longest(march.x, system.sets.shift.shape[1]))
    code = OK
    if state.stop < state.end and state.stop - state.now <= MEETS * state.end:
        code = pass_stop(run)
    if code == OK:
        code = choose(run)
    if code == OK:
        code = begin_phase(run)
    if code == OK:
        code = correct(run, state.now, march.x)
    return code if code != OK else move(run, state.now, march.x, march.rate[0], march.push[0])


@inner
def is_slow(run: int) -> bool:
    """Whether the run is not to end within the steps that it may have, as its last ones tell."""
    state = march_at(run).state[0]
    made = state.steps - state.marked
    if made < LOOK:
        return False
    needed = (state.end - state.now) / (state.now - state.mark) * made if state.now > state.mark else np.inf
    state.marked, state.mark = state.steps, state.now
    return bool(state.steps + needed > MOST_STEPS)


@inner
def go_on(run: int) -> int:
    """Make a step, to the next event at most: OK, DONE or a failure."""
    march = march_at(run)
    state, sets = march.state[0], system_at(march.place).sets
    left = state.stop - state.now
    if not left > 0.0:
        return DONE
    code, h = make_step(run, min(state.longest, left))
    if code == OK:
        code = look_for_jump(run, h)
    if code != OK:
        return OK if code == AGAIN else code
    part, closing = first_event(run)
    if state.code != OK or sets.request[1] != 0.0:
        return int(state.code) if state.code != OK else SETS
    if part < NEVER:
        code = arrive(run, h, state.now + part * h, closing)
    elif h < left:
        take(run, h, state.now + h)
        state.longest = min(2.0 * state.longest, (state.end - state.chosen_at) / state.parts)
    else:
        take(run, h, state.stop)
        code = pass_stop(run) if state.stop < state.end else OK
    return code if code != OK or bounded(march.x, state.most) else NO_STEP


@kernel
def march_on(run: int, most: int) -> int:
    """Go on until the end, until the room for the path is full, or ``most`` steps: DONE, FULL or a failure."""
    march = march_at(run)
    state, path = march.state[0], march.path
    for _ in range(most):
        code = decide(run) if state.choose != 0 else OK
        if code == OK:
            code = go_on(run)
        if code != OK:
            return code
        if state.jumps > MOST_JUMPS:
            return JUMPS
        if is_slow(run):
            return SLOW
        if state.pieces > path.end.size - ROOM or state.events > path.event.shape[0] - march.closed.size:
            return FULL
    return FULL


@inner
def hold(run: int, p: int) -> None:
    """Hold the rows of piece p; a state is to depend on its time alone, so that no factor of another one serves."""
    march = march_at(run)
    gram_at(march.gram).number[1] = 0
    march.held.number[0] = march.path.number[p]
    for k in range(march.held.number[0]):
        march.held.row[k] = march.path.held[p, k]


@kernel
def states_at(run: int, t: Floats, piece: Offsets, x: Floats) -> int:
    """Write the states at times t that lie in these pieces into x (K, n): the dense output, put onto the contacts."""
    march = march_at(run)
    path = march.path
    for q in range(t.size):
        p = piece[q]
        hold(run, p)
        part = (t[q] - path.start[p]) / path.length[p]
        for k in range(march.x.size):
            march.point[k] = at(path.dense[p], march.pair.terms, path.x[p, k], k, part)[0]
        code = correct(run, t[q], march.point)
        if code != OK:
            return code
        for k in range(march.x.size):
            x[q, k] = march.point[k]
    return OK


@kernel
def rate_at(run: int, t: float, p: int, x: Floats, rate: Floats) -> int:
    """Write x' at a state of piece p into ``rate``."""
    march = march_at(run)
    hold(run, p)
    return move(run, t, x, rate, march.push[16])
