"""The problem: drift, constraints, start."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dincl.callables import UserFunction
from dincl.checks import array, describe, function, items, lengths, number, spread
from dincl.constraints.base import Constraint
from dincl.constraints.selection import select
from dincl.constraints.smooth import Smooth, check_jacobian
from dincl.drifts import compiled
from dincl.drifts.base import CompiledDrift, CountedCompiledDrift, CountedDrift
from dincl.errors import InvalidProblem, StepFailure
from dincl.rows.base import MappedRows, RowsOfOneKind, StackedRows
from dincl.rows.kinds import SmoothRows
from dincl.status import Status

if TYPE_CHECKING:
    from dincl.mobility import Scaling
    from dincl.plotting import Axes

Floats = NDArray[np.float64]

# A start may miss a constraint by this much, times the largest coordinate, radius or offset: contacts in decimal
# numbers are not exact, and the gap of a wall, n . x - offset - radius, rounds with its largest part.
START_TOLERANCE = 1e-9

DRIFT = UserFunction("drift", ("t", "x"), Status.DRIFT_FAILED)

Drift = Callable[[float, Floats], Any]


@dataclass(frozen=True, eq=False, repr=False)
class Problem:
    """The differential inclusion x' in F(t, x) - N(S, x), x(0) = x0  (1.24), (1.25); with mobilities x' in B (F - N).

    Parameters
    ----------
    x0
        Start, shape (N, d), N, d >= 1, feasible to 1e-9 of the largest coordinate, radius or offset [length].
        Coordinates are of magnitude at most 1e100; radii, lengths, tolerances and time steps lie between 1e-100 and
        1e100, so that their squares are numbers, too. Others are refused.
    drift
        F: (t, x) -> velocity of the unconstrained particles, (N, d) -> (N, d) [length / time]. x is read-only.
        ``dincl.drifts`` has the usual ones.
    constraints
        The sets whose intersection is S, in the order in which PBD projects onto them.
    mobility
        b_i >= 0, one for all particles or one each, shape (N,): velocity per unit of force, B = diag(b). A particle
        with b_i = 0 does not move. None: 1 for all.
    box
        The periods of the axes, d numbers > 0, None for an axis that does not repeat [length]: distances are those to
        the nearest image. Coordinates are not wrapped, and drifts and functions of the user see them so.

    Raises
    ------
    InvalidProblem
        For wrong shapes, numbers that are not finite, a start that is not feasible, a drift that fails at the start.
    """

    x0: Floats
    drift: Drift
    constraints: Sequence[Constraint] = ()
    mobility: Floats | None = None
    box: Floats | None = None
    # Of a problem in scaled coordinates, see ``dincl.mobility``.
    scaling: ClassVar[Scaling | None] = None

    def __init__(
        self,
        x0: ArrayLike,
        drift: Drift,
        constraints: Sequence[Constraint] = (),
        *,
        mobility: ArrayLike | None = None,
        box: Sequence[float | None] | None = None,
    ) -> None:
        start = array("x0", x0)
        if start.ndim != 2 or 0 in start.shape:
            raise InvalidProblem(f"x0 of shape {start.shape}: must have shape (N, d) with N, d >= 1")
        allowed = "a callable (t, x) -> velocity of the shape of x"
        sets = items("constraints", constraints, Constraint, "a list of dincl constraints")
        object.__setattr__(self, "x0", start)
        object.__setattr__(self, "drift", function("drift", drift, allowed))
        object.__setattr__(self, "mobility", None if mobility is None else _mobilities(mobility, len(start)))
        object.__setattr__(self, "box", None if box is None else _periods(box, start.shape[1]))
        object.__setattr__(
            self, "constraints", sets if self.box is None else tuple([one.in_box(self.box) for one in sets])
        )
        # Results of functions of the user are checked: an overflow needs no warning.
        with np.errstate(all="ignore"):
            self._check()

    def __repr__(self) -> str:
        n, d = self.x0.shape
        sets = ", ".join(repr(one) if isinstance(one, Smooth) else type(one).__name__ for one in self.constraints)
        return f"{type(self).__name__}(N = {n}, d = {d}, constraints = [{sets}])"

    def velocity(self, t: float, x: Floats) -> Floats:
        """Evaluate F(t, x), shape (N, d), finite; StepFailure otherwise."""
        # A copy, as the base of a view could be written to.
        seen = x.copy()
        seen.flags.writeable = False
        return DRIFT.evaluated(self.drift, t, seen, shape=x.shape)

    def rows_within(self, t: float, x: Floats, search_radius: float) -> StackedRows:
        """Select all rows that can be violated at time t once every particle moved at most ``search_radius`` from x."""
        return select(self.constraints, t, x, search_radius).at(t)

    def violation(self, t: float, x: Floats) -> float:
        """Compute max_k max(0, -g_k(x)) at time t over all constraints [units of g]; infinite if one is not defined."""
        try:
            return max(0.0, float(np.max(-self.rows_within(t, x, 0.0).values(x), initial=0.0)))
        except StepFailure:
            return math.inf

    def plot(self, t: ArrayLike = 0.0, ax: Axes | None = None) -> Axes:
        """Draw the start and all sets: walls, obstacles, containers, bonds, and contours of sets of your own.

        Parameters
        ----------
        t
            The time of the sets, or several, ascending, shape (K,): in the plane the sets of later times are dotted
            lines, which show how they move.
        ax
            Where to draw; None: a new figure.

        Needs matplotlib. Raises InvalidProblem for d > 2.
        """
        from dincl.plotting import plot_problem

        times = np.atleast_1d(array("t", t))
        if times.ndim != 1 or not times.size or (np.diff(times, prepend=0.0) < 0).any():
            raise InvalidProblem(f"t = {describe(t)}: must be a time >= 0, or several, ascending")
        return plot_problem(self, times, ax)

    def _check(self, *, feasible: bool = True, t: float = 0.0) -> None:
        """Raise InvalidProblem unless drift and constraints can be evaluated at the start, and it is ``feasible``."""
        count, d = self.x0.shape
        if isinstance(self.drift, CompiledDrift):
            self.drift.check(count, d)
        place, tolerance = "constraints", math.inf
        try:
            for index, constraint in enumerate(self.constraints):
                place = f"constraints[{index}]"
                constraint.check(count, d)
            if feasible:
                lengths = [one.longest_length(d) for one in self.constraints]
                tolerance = START_TOLERANCE * max(float(np.abs(self.x0).max()), *lengths, 0.0)
            for index, constraint in enumerate(self.constraints):
                place = f"constraints[{index}]"
                _check_rows(constraint, self, place, tolerance, t)
            place = "drift"
            self.velocity(t, self.x0)
        except StepFailure as failure:
            raise InvalidProblem(f"{place}: {failure.detail}") from failure


def _mobilities(value: ArrayLike, count: int) -> Floats:
    """Return mobilities (count,), of which at least one is not 0."""
    found = spread("mobility", lengths("mobility", value, positive=False, of="number"), count, "particles")
    if not found.any():
        raise InvalidProblem(f"mobility = {describe(value)}: must be > 0 for at least one particle")
    return found


def _periods(box: Sequence[float | None], d: int) -> Floats:
    """Return periods (d,), 0 for axes that do not repeat."""
    allowed = f"must be {d} numbers > 0, or None for an axis that does not repeat"
    if not hasattr(box, "__len__") or len(box) != d:
        raise InvalidProblem(f"box = {describe(box)}: {allowed}")
    found = [0.0 if one is None else number(f"box[{k}]", one, positive=True) for k, one in enumerate(box)]
    return array("box", found)


def constraints_around(x: Floats, constraints: Sequence[Constraint]) -> Problem:
    """Make a problem of constraints alone, to project onto: nothing moves, and x (N, d) need not be feasible.

    Raises InvalidProblem if a constraint does not fit x, or cannot be evaluated there.
    """
    from dincl.drifts import constant

    problem: Problem = object.__new__(Problem)
    sets = items("problem", constraints, Constraint, "a dincl.Problem, or a list of dincl constraints")
    vars(problem).update(x0=x, drift=constant(np.zeros(x.shape[1])), constraints=sets)
    with np.errstate(all="ignore"):
        problem._check(feasible=False)
    return problem


def _check_rows(constraint: Constraint, problem: Problem, place: str, tolerance: float, t: float) -> None:
    """Raise InvalidProblem unless x0 violates no row by more than the tolerance, and rows are of a known kind."""
    name, x = type(constraint).__name__, problem.x0
    selection = select((constraint,), t, x, 0.0)
    found: Any = selection.blocks[0]
    if not isinstance(found, RowsOfOneKind):
        allowed = "must be AffineRows, DistanceRows or rows of another kind of dincl.rows"
        raise InvalidProblem(f"constraints: {name}.select returned {describe(found)}: {allowed}")
    (rows,) = selection.at(t).blocks
    values = rows.values(x)
    if values.min(initial=0.0) < -tolerance:
        when = f" at t = {t:g}" if t else ""
        sets = "constraints" if problem.box is None else "problem with this box and any feasible x0"
        worst = rows.label(int(values.argmin()), x.shape[1])
        raise InvalidProblem(
            f"x0 violates {name} by {-values.min():.3g} at {worst}{when} ({place}): allowed is {tolerance:.1g}; "
            f"dincl.project({sets}, x0, projection{f', t={t:g}' if t else ''}) gives the nearest point that is feasible"
        )
    smooth = rows.rows if isinstance(rows, MappedRows) else rows
    if isinstance(smooth, SmoothRows):
        check_jacobian(rows, x, "jacobian" if smooth.names[0] == "g" else smooth.names[1])


def at_end(problem: Problem, x: Floats) -> Problem:
    """Return the problem with the end x (N, d) of a run as its start, which need not be feasible."""
    start = x.copy()
    start.flags.writeable = False
    return changed(problem, x0=start)


def check_start(problem: Problem, t: float) -> None:
    """Raise InvalidProblem unless drift and constraints can be evaluated at time t, and the start is feasible then."""
    with np.errstate(all="ignore"):
        problem._check(t=t)


def with_counted_drift(problem: Problem, is_spent: Callable[[int], bool] | None = None) -> tuple[Problem, CountedDrift]:
    """Return the problem with a counted drift, and that drift; it ends a run once ``is_spent(evaluations)``."""
    compiled_drift = compiled(problem.drift)
    drift = (
        CountedDrift(problem.drift, is_spent)
        if compiled_drift is None
        else CountedCompiledDrift(compiled_drift, is_spent)
    )
    return changed(problem, drift=drift), drift


def changed(problem: Problem, **parts: Any) -> Problem:
    """Return a problem, which was checked, with other parts."""
    same = object.__new__(type(problem))
    vars(same).update(vars(problem) | parts)
    return same
