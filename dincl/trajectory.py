"""Results: of a scheme, ``RunOutcome``; of ``solve``, ``Trajectory``, with residuals that can be recomputed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import array, describe
from dincl.errors import InvalidProblem, ProjectionFailed, StepFailure
from dincl.forces import Forces, Reaction, contact_forces

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats
    from dincl.plotting import Axes, Film
    from dincl.problem import Problem
    from dincl.schemes.base import Scheme
    from dincl.status import Status
    from dincl.work import Work


class Event(NamedTuple):
    """A change of the contacts.

    Attributes
    ----------
    t
        Time of the change [time].
    kind
        "contact": a gap closes; "release": a multiplier reaches zero and the gap opens.
    constraint
        Index into the constraints of the problem.
    row
        The row of that constraint in words, e.g. "particle 3 and 1".
    """

    t: float
    kind: str
    constraint: int
    row: str


class Between(ABC):
    """The solution between the output times of a run, and its reactions."""

    @abstractmethod
    def states(self, times: Floats) -> Floats:
        """Compute x at increasing times (K,) within the run, shape (K, N, d)."""

    def at(self, t: float) -> Floats:
        """Compute x at one time, shape (N, d)."""
        found: Floats = self.states(np.array([t]))[0]
        return found

    @abstractmethod
    def reactions(self, times: Floats) -> list[Reaction | None]:
        """Compute x' - F at increasing times (K,) within the run; None where it is not defined."""


@dataclass(frozen=True, eq=False)
class RunOutcome:
    """Result of a scheme.

    Attributes
    ----------
    t
        Output times, shape (K,); after a failure, or a stop by ``until``, those that were reached, and last the time of
        the last state.
    x
        States, shape (K, N, d).
    status, detail
        How the run ended, and the particulars in words ("" on success).
    stats
        The counted work.
    between
        The states between the output times, and the residuals.
    events
        Contacts and releases in the order of time; empty for time steps, which do not look for them.
    error
        Estimated error max_i |X_i - exact| at the output times, shape (K,); None from schemes that make no estimate.
    failure
        The error that ended the run early, the cause of that which solve raises.
    scheme
        The scheme that was taken, of a scheme that chooses one.
    velocity
        At the last time, of second-order schemes, shape (N, d).
    """

    t: Floats
    x: Floats
    status: Status
    detail: str
    stats: Work
    between: Between
    events: tuple[Event, ...] = ()
    error: Floats | None = None
    failure: StepFailure | None = None
    scheme: Scheme | None = None
    velocity: Floats | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Trajectory(RunOutcome):
    """The solution at the output times: the outcome of a run, of its ``problem``, from the time ``t0`` on."""

    problem: Problem
    scheme: Scheme
    t0: float = 0.0

    @property
    def final(self) -> Floats:
        """The last state, shape (N, d)."""
        last: Floats = self.x[-1]
        return last

    def violation(self) -> Floats:
        """Recompute max_k max(0, -g_k(x)) at each output time from the problem, shape (K,) [units of g]."""
        return np.array([self.problem.violation(t, x) for t, x in zip(self.t, self.x, strict=True)])

    def normal_cone_residual(self) -> Floats:
        """Compute how far the velocity is from F - N(S, x) at each output time, shape (K,) [length / time].

        For time steps dist((x_{k+1} - x_k)/h - F(t_k, x_k), -N^g(x_{k+1})) for the step that ends at or after the
        output time, with the rows of N^g (Definition 1.24) that the step could have closed: g <= h max |F_i|; zero up
        to tol/h for catch-up. For ``EventDriven`` the same with x' itself. Infinite where it is not defined (before any
        step, at the start, for second-order schemes, at coincident centres). With mobilities all of this is in the
        scaled coordinates of ``dincl.mobility``.
        """
        return np.array([self._residual(one) for one in self.between.reactions(self.t)])

    def _residual(self, reaction: Reaction | None) -> float:
        from dincl.geometry import distance_to_cone

        if reaction is None or reaction.second_order:
            return np.inf
        try:
            return distance_to_cone(reaction.value, reaction.gradients())
        except StepFailure:
            return np.inf

    def forces(self, t: ArrayLike) -> Forces | tuple[Forces, ...]:
        """Compute the contact forces at one time, or at several increasing ones, (K,): see ``Forces``.

        x' = F + sum_k multiplier_k grad g_k, multiplier >= 0, in units of F; with mobilities x' = B (F + sum ...). For
        ``EventDriven`` x' is the velocity before t (after it at the start). Time steps have forces of the step that
        ends at or after t: those nearest to (x_{k+1} - x_k)/h - F(t_k, x_k) with the gradients at x_{k+1}. For
        ``SecondOrderPBD`` they are those of x'' = F + sum_k multiplier_k grad g_k; an impact that changes a velocity by
        v is a force v/h. Multipliers of dependent contacts, as in a packing, are not unique, though their sum is: the
        ones with the least sum of squares are returned.

        Raises
        ------
        InvalidProblem
            For times outside of the run, not increasing, or at which no step gives forces, as the start of time steps.
        ProjectionFailed
            Where the gradients are not defined, or the forces are not found.
        """
        times = self._inside(t)
        if times.ndim > 1 or (np.diff(np.atleast_1d(times)) <= 0).any():
            raise InvalidProblem(f"t = {describe(t)}: must be a time, or several, increasing")
        reactions, found = self.between.reactions(np.atleast_1d(times)), []
        for time, reaction in zip(np.atleast_1d(times), reactions, strict=True):
            if reaction is None:
                raise InvalidProblem(f"t = {time}: no step of this run gives forces there")
            try:
                found.append(contact_forces(self.problem, reaction))
            except StepFailure as failure:
                raise ProjectionFailed(failure.status, failure.detail) from failure
        return tuple(found) if times.ndim else found[0]

    def __call__(self, t: ArrayLike) -> Floats:
        """Return x(t) for one time, (N, d), or several, (..., N, d): (1.48), or the dense output of the scheme.

        Raises InvalidProblem for times outside of the run.
        """
        times = self._inside(t)
        order = np.argsort(times, axis=None, kind="stable")
        values = np.empty((times.size, *self.problem.x0.shape))
        values[order] = self.between.states(times.ravel()[order])
        return values.reshape(*times.shape, *self.problem.x0.shape)

    def _inside(self, t: ArrayLike) -> Floats:
        """Return times; InvalidProblem for those outside of the run."""
        times = array("t", t)
        outside = (times < self.t0) | (times > self.t[-1])
        if outside.any():
            time = f"[{self.t0:g}, {self.t[-1]}], the time of this run"
            raise InvalidProblem(f"t = {times[outside].flat[0]}: must lie in {time}")
        return times

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the last state to scale, the start in outline, the paths through the states, walls and obstacles.

        Drawn on ``ax``, or on a new figure; for d = 1 places over time. Moving sets are drawn at the last time. Paths
        are straight between output times: pass more times for finer ones. Needs matplotlib. Raises InvalidProblem for
        d > 2.
        """
        from dincl.plotting import plot

        return plot(self._film(), ax)

    def _repr_html_(self) -> str:
        """Show status and picture in notebooks; words alone without matplotlib or for d > 2."""
        from dincl.plotting import to_html

        return to_html(self._film())

    def _film(self) -> Film:
        from dincl.plotting import Film

        name = getattr(self.problem, "title", type(self.scheme).__name__)
        ending = "" if self.status else f", {self.status.name}"
        words = f"{self!r}. {self.status.value} {self.detail}".strip()
        return Film(self.problem, self.t, self.x, f"{name}, t = {self.t[-1]:.3g}{ending}", words, self.t0)

    def __repr__(self) -> str:
        n, d = self.problem.x0.shape
        output = f"{len(self.t)} output times to t = {self.t[-1]:g}"
        return f"Trajectory({self.status.name}, {type(self.scheme).__name__}, {output}, N = {n}, d = {d})"


class StepFailed(RuntimeError):
    """A run that ended early; ``trajectory`` has everything that was computed until then, with its Status."""

    def __init__(self, trajectory: Trajectory) -> None:
        super().__init__(f"{trajectory.status.value} {trajectory.detail}".rstrip())
        self.trajectory = trajectory
