"""Nearest points of S(t) in compiled code, by least-distance programs of the near rows."""

from collections.abc import Callable

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats
from dincl.neighbours import ROW_MARGIN
from dincl.neighbours.lists import call_search
from dincl.rows.candidates import distance_from_search, find_candidates, note_search, sort_candidates
from dincl.rows.table import (
    DISPLACEMENTS,
    DISTANCE,
    GRADIENTS,
    call_python,
    gap,
    linearise,
    scaled_length,
    value_of,
)
from dincl.solvers.active_set import nearest
from dincl.solvers.envelope_factor import add_row, row_dot
from dincl.solvers.wedges import is_pair, narrowest
from dincl.system.arrays import COINCIDENT, MISSED, OK, PYTHON, SETS, TOO_FAR, WEDGE, SystemArrays, farthest

# A projection that ends outside of the search radius is repeated with twice its distance, at most this often.
MOST_SEARCHES = 60
# Linearisations for one projection onto a curved set: ten digits where each shortens the error by a tenth. A y that
# violates by less than this part of tol is its own nearest point.
MOST_RELINEARISATIONS, NEGLIGIBLE = 200, 1e-3
# A step shows the curvature of a row if the square of its part across the gradient is more than this share of its own.
ACROSS = 1e-8
FAILED_LIST, SAME_LIST, NEW_LIST = range(3)


def project_of(solve: Callable[..., int]) -> Callable[..., int]:
    """Make the projection of y of a system, which ``solve`` does with the listed rows.

    Only kernels that need them are compiled with repeated linearisations.
    """

    @inner
    def project(system: SystemArrays, t: float, around: Floats, radius: float, later: float, tol: float) -> int:
        """Project y: OK or why not; the system then holds z and the multipliers.

        Parameters
        ----------
        system : SystemArrays
            It holds y, and then z and the multipliers.
        t : float
            The time of the set.
        around : (n,)
            Where the search begins, and where a linearisation is made.
        radius : float
            Rows are listed that can be violated within this distance of ``around`` [length].
        later : float
            A linearisation is carried to this time, each row with its set.
        tol : float
            The residual allowed [length].
        """
        d = system.sets.shift.shape[1]
        carried = carry(system, t, around, later)
        if call_python(system.sets, t, around, DISPLACEMENTS) != 0:
            return SETS
        for _ in range(MOST_SEARCHES):
            if not list_sorted(system, t, around, radius, ROW_MARGIN):
                return PYTHON
            code = solve(system, t, around, later, tol)
            if code != OK:
                return int(code)
            distance = farthest(system.program.z, around, d) + carried
            if distance <= radius:
                return OK if system.sets.failed[0] == 0 else SETS
            radius = 2.0 * distance
        return TOO_FAR

    return project


@inner
def solve_linearised(system: SystemArrays, t: float, around: Floats, later: float, tol: float) -> int:
    """Project onto the listed rows, linearised once."""
    code, residual = linearise_set(system, t, around, later), 0.0
    if code == OK:
        code = nearest_of_near(system)
    if code == OK:
        residual = residual_of_near(system)
    return end_projection(system, code, residual, tol)


@inner
def solve_exactly(system: SystemArrays, t: float, around: Floats, later: float, tol: float) -> int:
    """Project onto the set of the listed rows by linearising again at the point reached, for the same y."""
    program = system.program
    violation = violation_of_y(system, t)
    if violation <= NEGLIGIBLE * tol:
        for k in range(program.z.size):
            program.z[k] = program.y[k]
        code = linearise_near(system, t, program.z) if violation > 0.0 else OK
        return check_wedges(system, tol, False) if violation > 0.0 and code == OK else code
    begin_search(system, around)
    code, residual = linearise_set(system, t, around, later), 0.0
    for _ in range(MOST_RELINEARISATIONS):
        if code == OK:
            code = nearest_of_near(system)
        end_program(system)
        if code == OK:
            code = linearise_near(system, t, program.z)
        if code == OK:
            residual = residual_of_near(system)
        if code != OK or residual <= tol:
            break
        bend(system)
    return end_projection(system, code, residual, tol)


@inner
def nearest_of_near(system: SystemArrays) -> int:
    """Find the nearest point of the listed rows, as they are linearised."""
    near, program, factor = system.near, system.program, system.factor
    return int(nearest(system.rows, near.row, near.number[0], program, factor, 0.0))


@inner
def end_projection(system: SystemArrays, code: int, residual: float, tol: float) -> int:
    """Note the residual of a projection, and whether there was one; return its code, or MISSED or WEDGE."""
    program = system.program
    program.answer[1] = residual
    program.answer[2] += 1.0 if code == OK and system.factor.number[0] > 0 else 0.0
    if code == OK:
        code = check_wedges(system, tol, True) if residual <= tol else MISSED
    return code


project_onto_set, project_onto_linearisation = project_of(solve_exactly), project_of(solve_linearised)


@inner
def linearise_set(system: SystemArrays, t: float, x: Floats, later: float) -> int:
    """Linearise the listed rows at x and carry them, with their sets, to a later time."""
    code = linearise_near(system, t, x)
    if code == OK and later != t and system.sets.address != 0:
        carry_bounds(system, t, x, later)
    return code


@inner
def check_wedges(system: SystemArrays, tol: float, solved: bool) -> int:
    """Return OK, or WEDGE if z may lie farther from the nearest point than the tolerance though its gaps do not.

    Rows that make a wedge have gaps of at most the tolerance. What matters is how far z violates them, or is off those
    that have a multiplier, if a program was ``solved``.
    """
    rows, near, program, count, worst = system.rows, system.near, system.program, 0, 0.0
    for q in range(near.number[0]):
        r = near.row[q]
        if not is_pair(rows, r):
            value = row_dot(rows, r, program.gradient, program.z) - program.bound[r]
            if value <= tol:
                near.chosen[count] = r
                count += 1
                worst = max(worst, abs(value) if solved and program.multiplier[r] > 0.0 else -value)
    program.answer[1] = narrowest(rows, near, program.gradient, near.chosen, count) if worst > 0.0 else np.inf
    return WEDGE if worst > tol * program.answer[1] else OK


@inner
def begin_search(system: SystemArrays, around: Floats) -> None:
    """Let a search for the nearest point begin at ``around``, with the identity as its Hessian."""
    program, curved = system.program, system.curvature
    curved.largest[0] = 1.0
    for k in range(around.size):
        curved.y[k], curved.last[k], curved.root[k] = program.y[k], around[k], 1.0


@inner
def end_program(system: SystemArrays) -> None:
    """Put z and y back into coordinates of the system, and note the step from the last point, and its slopes."""
    program, curved, near = system.program, system.curvature, system.near
    for k in range(program.z.size):
        program.z[k] /= curved.root[k]
        program.y[k] = curved.y[k]
        curved.step[k] = curved.root[k] * (program.z[k] - curved.last[k])
    for q in range(near.number[0]):
        curved.slope[near.row[q]] = row_dot(system.rows, near.row[q], program.gradient, curved.step)
    for k in range(program.z.size):
        curved.step[k], curved.last[k] = program.z[k] - curved.last[k], program.z[k]


@inner
def bend(system: SystemArrays) -> None:
    """Give the next program the curvature of the set.

    The nearest point obeys z - y = sum_r lambda_r a_r(z) with unit gradients a_r. A program with the identity as its
    Hessian takes them from the last point: as a_r turns by a part kappa_r of the move across it, errors change by the
    factor lambda_r kappa_r, and grow where y is farther outside of a container than its radius of curvature. Therefore
    the program is

        min 1/2 (z - x).D (z - x) + (x - y).(z - x)   subject to the rows linearised at x,

    with D = 1 + sum of lambda_r kappa_r over the rows in which a coordinate takes part, and kappa_r >= 0 as the last
    step showed it: -(change of a_r).step / |step across a_r|^2. As two particles of one row contribute up to twice the
    curvature of each, the Hessian of the Lagrangian is at most 2 D - 1, so that errors fall for any curvature of
    containers. Multiplied by the root of D coordinates have the identity as their Hessian again, and y is
    x + (y - x) / D. Obstacles, with kappa_r < 0, are left alone: there errors fall where the nearest point is unique.
    """
    rows, program, curved, near = system.rows, system.program, system.curvature, system.near
    for k in range(program.y.size):
        curved.root[k] = 1.0
    for q in range(near.number[0]):
        r = near.row[q]
        multiplier, length, square = program.multiplier[r], 0.0, 0.0
        if not multiplier > 0.0:
            continue
        for p in range(rows.start[r], rows.stop[r]):
            if program.gradient[p] != 0.0:
                length += program.gradient[p] * program.gradient[p]
                square += curved.step[rows.column[p]] * curved.step[rows.column[p]]
        along = row_dot(rows, r, program.gradient, curved.step)
        across, turn = square - along * along / max(length, 1e-300), curved.slope[r] - along
        if turn > 0.0 and across > ACROSS * square:
            for p in range(rows.start[r], rows.stop[r]):
                if program.gradient[p] != 0.0:
                    curved.root[rows.column[p]] += multiplier * turn / across
    for k in range(program.y.size):
        if curved.root[k] > 1.0:
            program.y[k] = program.z[k] + (program.y[k] - program.z[k]) / curved.root[k]
            curved.root[k] = np.sqrt(curved.root[k])
            program.y[k] *= curved.root[k]
            curved.largest[0] = max(curved.largest[0], curved.root[k] * curved.root[k])
    for q in range(near.number[0]):
        for p in range(rows.start[near.row[q]], rows.stop[near.row[q]]):
            program.gradient[p] /= curved.root[rows.column[p]]


@inner
def carry_bounds(system: SystemArrays, t: float, around: Floats, later: float) -> None:
    """Carry the linearised rows, with their sets, to a later time: general sets by the change of the gap.

    The distance from a point that passes the particle is carried along its gradient.
    """
    general = False
    rows, sets, near, program = system.rows, system.sets, system.near, system.program
    for q in range(near.number[0]):
        r = near.row[q]
        family = rows.row[r].family
        general = general or sets.general[family] != 0
        for p in range(rows.start[r], rows.stop[r]):
            program.bound[r] += program.gradient[p] * system.move[family, rows.column[p] % system.move.shape[1]]
    if not general:
        return
    call_python(sets, later, around, GRADIENTS)
    for q in range(near.number[0]):
        r = near.row[q]
        row = rows.row[r]
        if sets.general[row.family] == 0:
            continue
        before = row_dot(rows, r, program.gradient, around)
        if row.kind == DISTANCE and row.j < 0 and row.plain != 0:
            from_point = before  # how far the particle is from the point, along the arrow that led there from it
            for p in range(rows.start[r], rows.stop[r]):
                from_point -= program.gradient[p] * rows.coefficient[p]
            if row.sign * from_point < 0.0:
                program.bound[r] = before - from_point + row.sign * row.length
                continue
        program.bound[r] -= gap(rows, sets, r, around) - (before - program.bound[r])
    call_python(sets, t, around, GRADIENTS)


@inner
def list_near(system: SystemArrays, t: float, x: Floats, radius: float, margin: float) -> int:
    """List every row that matters within ``radius`` of x, in the order of the table.

    Returns FAILED_LIST, SAME_LIST, or NEW_LIST: a list for ``margin`` times the radius, see ``dincl.neighbours``.
    """
    sets, near = system.sets, system.near
    if distance_from_search(sets, x, near) + radius <= near.radius[0]:
        return SAME_LIST
    if near.search == 0:
        find_candidates(system.rows, sets, t, x, margin * radius, near)
    else:
        near.radius[0] = margin * radius
        if call_search(near.search, t, x, 0) != 0:
            return FAILED_LIST
        note_search(sets, t, x, margin * radius, near)
    return NEW_LIST


@inner
def list_sorted(system: SystemArrays, t: float, x: Floats, radius: float, margin: float) -> bool:
    """List every row that matters within ``radius`` of x, in the order of the cloud; false on failure."""
    listed = list_near(system, t, x, radius, margin)
    if listed == NEW_LIST:
        sort_candidates(system.rows, x, system.sets.shift.shape[1], system.near)
    return listed != FAILED_LIST


@inner
def linearise_near(system: SystemArrays, t: float, x: Floats) -> int:
    """Linearise the listed rows at x: a_r . z >= bound_r with unit gradients."""
    rows, sets, near, program = system.rows, system.sets, system.near, system.program
    if call_python(sets, t, x, GRADIENTS) != 0:
        return SETS
    for q in range(near.number[0]):
        r = near.row[q]
        value = linearise(rows, sets, r, x, program.gradient)
        if value != value:
            system.offending[0] = r
            return COINCIDENT
        program.bound[r] = row_dot(rows, r, program.gradient, x) - value
        program.length[r] = scaled_length(rows, sets, r)
    return OK


@inner
def residual_of_near(system: SystemArrays) -> float:
    """Compute the residual of ``Projected`` of z as the nearest point to y, for the listed rows, in units of the user.

    The largest of |z - y - A^T multiplier|, the violations -g, and |min(multiplier, g)|. A row of the user has the
    gradient ``length`` a, the gap ``length`` (a . z - b) and the multiplier over ``length``.
    """
    program, near, residual, z = system.program, system.near, 0.0, system.program.z
    for k in range(z.size):
        program.direction[k] = z[k] - program.y[k]
    for q in range(near.number[0]):
        r = near.row[q]
        multiplier, length = program.multiplier[r], program.length[r]
        value = length * (row_dot(system.rows, r, program.gradient, z) - program.bound[r])
        residual = max(residual, -value, abs(min(multiplier / length, value)))
        if multiplier > 0.0:
            add_row(system.rows, r, program.gradient, -multiplier, program.direction)
    for k in range(z.size):
        residual = max(residual, abs(program.direction[k]))
    return residual


@inner
def violation_of_y(system: SystemArrays, t: float) -> float:
    """Compute by how much y violates the listed rows [units of g]; infinite if one is not defined."""
    largest = 0.0
    if call_python(system.sets, t, system.program.y, GRADIENTS) != 0:
        return np.inf
    for q in range(system.near.number[0]):
        value = value_of(system.rows, system.sets, system.near.row[q], system.program.y)
        largest = max(largest, -value) if value == value else np.inf
    return largest


@inner
def carry(system: SystemArrays, t: float, x: Floats, later: float) -> float:
    """Write how far each set is carried from t to a later time into ``move``; return the largest change near x."""
    if system.sets.address == 0 or later == t:
        return 0.0
    move, shift, longest, since = system.move, system.sets.shift, 0.0, system.sets.since
    since[0] = t
    call_python(system.sets, later, x, DISPLACEMENTS)
    for f in range(move.shape[0]):
        longest = max(longest, system.sets.change[f])
        for k in range(move.shape[1]):
            move[f, k] = shift[f, k]
    since[0] = system.near.time[0]
    call_python(system.sets, t, x, DISPLACEMENTS)
    for f in range(move.shape[0]):
        square = 0.0
        for k in range(move.shape[1]):
            move[f, k] -= shift[f, k]
            square += move[f, k] * move[f, k]
        longest = max(longest, np.sqrt(square))
    return longest
