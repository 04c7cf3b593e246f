"""The smooth motion between two events: some contacts are held, the others do not matter."""

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats
from dincl.events.arrays import march_at
from dincl.rows.table import VELOCITIES, call_python, linearise
from dincl.solvers.active_set import across
from dincl.solvers.factor import add, append, backward, border, clear, forward, times
from dincl.solvers.sparse_factor import SPARSE_FROM, gram_at, refactor, solve_sparse
from dincl.solvers.sparse_order import analyse, covers
from dincl.system.arrays import COINCIDENT, OK, SETS, SINGULAR, SystemArrays, evaluate, system_at

EPS = 2.220446049250313e-16
# Newton steps back onto the held contacts; from a state that is off by an integration error one or two are enough.
MOST_CORRECTIONS = 8
# Gaps at most this large, relative to the size of the problem, need no step back.
MET = 2e-15
# Part of itself to which a Newton step must shrink the largest gap, if its factor is to serve for the next one.
SHRINKS = 0.1


@inner
def linearise_held(run: int, t: float, x: Floats) -> int:
    """Unit gradients of the held rows at x; ``bound`` has their gaps."""
    march = march_at(run)
    system, held = system_at(march.place), march.held
    if call_python(system.sets, t, x, VELOCITIES) != 0:
        return SETS
    for k in range(held.number[0]):
        r = held.row[k]
        gap = linearise(system.rows, system.sets, r, x, system.program.gradient)
        if gap != gap:
            system.blamed[0] = r
            return COINCIDENT
        system.program.bound[r] = gap
    return OK


@inner
def factorise(run: int) -> int:
    """Factorise the Gram matrix of the held rows: by a sparse factor where they are many, else by its envelope."""
    march = march_at(run)
    system, held, gram = system_at(march.place), march.held, gram_at(march.gram)
    rows, gradient, count = system.rows, system.program.gradient, held.number[0]
    if count >= SPARSE_FROM and (covers(held.row, count, gram) or analyse(rows, held.row, count, gram)):
        for k in range(gram.number[0]):
            gram.used[k] = 0
        for k in range(count):
            gram.used[gram.place[held.row[k]]] = 1
        return OK if refactor(rows, gradient, gram, 4.0 * EPS) == 0 else SINGULAR
    gram.number[1] = 0
    clear(held)
    for k in range(count):
        r = held.row[k]
        border(rows, r, gradient, held)
        square = across(rows, r, gradient, held)
        if not square > 4.0 * EPS:
            held.number[0] = count
            return SINGULAR
        append(rows, held, r, square)
    return OK


@inner
def solve_held(run: int) -> None:
    """Solve with the factor for ``right`` of the held rows, in place."""
    march = march_at(run)
    held, gram = march.held, gram_at(march.gram)
    if gram.number[1] == 0:
        forward(held, 0)
        backward(held)
        return
    for k in range(gram.number[0]):
        gram.right[k] = 0.0
    for k in range(held.number[0]):
        gram.right[gram.place[held.row[k]]] = held.right[k]
    solve_sparse(gram)
    for k in range(held.number[0]):
        held.right[k] = gram.right[gram.place[held.row[k]]]


@inner
def is_factorised(run: int) -> bool:
    """Whether the sparse factor is one of the held rows, though of another state."""
    march = march_at(run)
    held, gram = march.held, gram_at(march.gram)
    if held.number[0] == 0 or gram.number[1] != held.number[0]:
        return False
    for k in range(held.number[0]):
        place = gram.place[held.row[k]]
        if place < 0 or gram.used[place] == 0:
            return False
    return True


@inner
def least_speed(system: SystemArrays, r: int) -> float:
    """n_r . c', the speed at which the set of row r moves along its gradient."""
    rows, speed, total = system.rows, system.sets.speed, 0.0
    if system.sets.address == 0:
        return 0.0
    for p in range(rows.start[r], rows.stop[r]):
        total += system.program.gradient[p] * speed[rows.row[r].family, rows.column[p] % speed.shape[1]]
    return total


@inner
def move(run: int, t: float, x: Floats, rate: Floats, push: Floats) -> int:
    """Write x' = F + sum_k push_k n_k with n_k . x' = b_k into ``rate``, and the pushes, which are refined once."""
    march = march_at(run)
    system, held = system_at(march.place), march.held
    rows, gradient, right = system.rows, system.program.gradient, held.right
    code = evaluate(system.drift, system.sets.shift.shape[1], t, x, rate)
    if code != OK or held.number[0] == 0:
        return code
    code = linearise_held(run, t, x)
    if code == OK:
        code = factorise(run)
    if code != OK:
        return code
    count = held.number[0]
    for k in range(count):
        push[k] = 0.0
    for _ in range(2):
        for k in range(count):
            r = held.row[k]
            right[k] = least_speed(system, r) - times(rows, r, gradient, rate)
        solve_held(run)
        for k in range(count):
            push[k] += right[k]
            add(rows, held.row[k], gradient, right[k], rate)
    return OK


@inner
def correct(run: int, t: float, x: Floats) -> int:
    """Move x back onto g(t, x) = 0 of the held rows, along their gradients."""
    march = march_at(run)
    system, held = system_at(march.place), march.held
    if held.number[0] == 0:
        return OK
    factorised, last = is_factorised(run), np.inf
    for _ in range(MOST_CORRECTIONS):
        code, largest = linearise_held(run, t, x), 0.0
        if code != OK:
            return code
        for k in range(held.number[0]):
            largest = max(largest, abs(system.program.bound[held.row[k]]))
        if largest <= MET * march.state[0].size:
            break
        # A sparse factor of a state nearby serves as long as gaps shrink by it.
        factorised, last = factorised and largest <= SHRINKS * last, largest
        if not factorised:
            code = factorise(run)
            if code != OK:
                return code
        for k in range(held.number[0]):
            held.right[k] = system.program.bound[held.row[k]]
        solve_held(run)
        for k in range(held.number[0]):
            add(system.rows, held.row[k], system.program.gradient, -held.right[k], x)
    return OK


@inner
def stage(run: int, h: float, i: int) -> int:
    """The rate of stage i of a step from ``x``, from those before it."""
    march = march_at(run)
    pair, x, point = march.pair, march.x, march.point
    for k in range(x.size):
        point[k] = 0.0
    for j in range(i):
        weight, rate = h * pair.a[i, j], march.rate[j]
        if weight != 0.0:
            for k in range(x.size):
                point[k] += weight * rate[k]
    for k in range(x.size):
        point[k] += x[k]
    if i == pair.stages:
        after = march.after
        for k in range(x.size):
            after[k] = point[k]
    return move(run, march.state[0].now + pair.c[i] * h, march.point, march.rate[i], march.push[i])


@inner
def allowed_error(run: int, k: int) -> float:
    """How much a step may miss coordinate k by: the tolerance, or what rounding leaves."""
    march = march_at(run)
    state = march.state[0]
    return float(max(state.tol, EPS * (state.size + 2.0 * max(abs(march.x[k]), abs(march.after[k])))))


@inner
def error_of(run: int, h: float) -> float:
    """The estimated error of the step over what the tolerance allows, root of the mean square."""
    march = march_at(run)
    weight, rate, count, n = march.pair.error, march.rate, march.pair.stages + 1, march.x.size
    first, second = 0.0, 0.0
    for k in range(n):
        one, other = 0.0, 0.0
        for i in range(count):
            one += weight[0, i] * rate[i, k]
            other += weight[1, i] * rate[i, k]
        scale = allowed_error(run, k)
        first += (one / scale) * (one / scale)
        second += (other / scale) * (other / scale)
    if first == 0.0:
        return 0.0
    return float(h * first / np.sqrt((first + 0.01 * second) * n))


@inner
def interpolate(run: int, h: float) -> None:
    """The dense output of the step, in the nested form of Hairer, Norsett and Wanner."""
    march = march_at(run)
    state, pair, x, after, rate, dense = march.state[0], march.pair, march.x, march.after, march.rate, march.dense
    last, count, terms, weight = pair.stages, pair.stages + 1 + pair.more, pair.terms, pair.dense
    for k in range(x.size):
        change = after[k] - x[k]
        dense[0, k] = change
        dense[1, k] = h * rate[0, k] - change
        dense[2, k] = 2.0 * change - h * (rate[last, k] + rate[0, k])
        for j in range(terms - 3):
            total = 0.0
            for i in range(count):
                total += weight[j, i] * rate[i, k]
            dense[3 + j, k] = h * total
    state.theta, state.made = -1.0, h


@inner
def at(dense: Floats, terms: int, x: float, k: int, theta: float) -> tuple[float, float]:
    """Coordinate k at the part ``theta`` of the step, and its derivative after theta."""
    value, slope = 0.0, 0.0
    for j in range(terms - 1, -1, -1):
        factor, sign = (theta, 1.0) if j % 2 == 0 else (1.0 - theta, -1.0)
        value += dense[j, k]
        slope = slope * factor + sign * value
        value *= factor
    return x + value, slope


@inner
def dense_state(run: int, theta: float) -> None:
    """Write the state at a part of the step into ``point``, and its derivative after theta into the last rate."""
    march = march_at(run)
    x, dense, point, rate, terms = march.x, march.dense, march.point, march.rate, march.pair.terms
    march.state[0].theta = -1.0
    for k in range(x.size):
        point[k], rate[16, k] = at(dense, terms, x[k], k, theta)
