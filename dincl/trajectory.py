"""What ``solve`` returns: the kept states, how the run ended, the work it took, and proofs that can be recomputed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import array
from dincl.cone import distance_to_cone
from dincl.errors import InvalidProblem, StepFailure
from dincl.norms import longest
from dincl.stepping import Grid, Step, iterate

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.problem import Problem
    from dincl.schemes.base import Scheme, State, Stepper
    from dincl.status import Status
    from dincl.work import Work


class Mark(NamedTuple):
    """Where a run can be taken up again: the state at step k."""

    k: int
    state: State


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """The solution at the kept times.

    Attributes
    ----------
    t
        Kept times, shape (K,); after a failure those that were reached, and last the time of the last state.
    x
        States, shape (K, N, d); between two steps on the straight line (1.48).
    status, detail
        How the run ended, and the particulars in words ("" on success).
    stats
        The counted work.
    """

    t: NDArray[np.float64]
    x: NDArray[np.float64]
    status: Status
    detail: str
    stats: Work
    problem: Problem
    scheme: Scheme
    grid: Grid
    marks: tuple[Mark, ...]

    @property
    def final(self) -> NDArray[np.float64]:
        """The last state, shape (N, d)."""
        last: NDArray[np.float64] = self.x[-1]
        return last

    def violation(self) -> NDArray[np.float64]:
        """max_k max(0, -g_k(x)) at each kept time, shape (K,), recomputed from the problem [units of g]."""
        return np.array([self.problem.violation(t, x) for t, x in zip(self.t, self.x, strict=True)])

    def normal_cone_residual(self) -> NDArray[np.float64]:
        """How far the velocity is from F - N(S, x) at each kept time, shape (K,) [length / time].

        dist((x_{k+1} - x_k)/h - F(t_k, x_k), -N^g(x_{k+1})) for the step that ends at or after the kept time, with the
        rows of N^g (Definition 1.24) that the step could have closed: g <= h max |F_i|. Zero up to tol/h for catch-up;
        infinite where it is not defined (at t = 0, for second-order schemes, at coincident centres).
        """
        stepper = self.scheme.stepper(self.problem)
        marked = zip(self.t, self.marks, strict=True)
        return np.array([self._residual(stepper, mark) if t > 0 else np.inf for t, mark in marked])

    def __call__(self, t: ArrayLike) -> NDArray[np.float64]:
        """x(t) for one time, shape (N, d), or several, shape (..., N, d), by (1.48).

        The steps around t are made again from the last kept time before it, so nothing but the kept times is stored.
        Raises InvalidProblem for times outside of the run.
        """
        times = array("t", t)
        outside = (times < 0) | (times > self.t[-1])
        if outside.any():
            raise InvalidProblem(f"t = {times[outside].flat[0]}: must lie in [0, {self.t[-1]}], the time of this run")
        values = np.empty((times.size, *self.problem.x0.shape))
        stepper = self.scheme.stepper(self.problem)
        mark = Mark(0, stepper.start())
        for index in np.argsort(times, axis=None, kind="stable"):
            values[index], mark = self._at(stepper, float(times.flat[index]), mark)
        return values.reshape(*times.shape, *self.problem.x0.shape)

    def __repr__(self) -> str:
        n, d = self.problem.x0.shape
        kept = f"{len(self.t)} kept times to t = {self.t[-1]:g}"
        return f"Trajectory({self.status.name}, {type(self.scheme).__name__}, {kept}, N = {n}, d = {d})"

    def _at(self, stepper: Stepper, t: float, mark: Mark) -> tuple[NDArray[np.float64], Mark]:
        k = self.grid.before(t)
        mark = max((m for m in (mark, *self.marks) if m.k <= k), key=lambda m: m.k)
        if t <= 0 or not self.grid.steps:
            return mark.state.x, mark
        step = self._step(stepper, k, mark)
        return step.at(t, self.grid), Mark(k, step.before)

    def _step(self, stepper: Stepper, k: int, mark: Mark) -> Step:
        return next(step for step in iterate(stepper, self.grid, *mark) if step.k == k)

    def _residual(self, stepper: Stepper, mark: Mark) -> float:
        try:
            step = self._step(stepper, mark.k, mark)
            return self._residual_of(step) if step.after.v is None else np.inf
        except StepFailure:
            return np.inf

    def _residual_of(self, step: Step) -> float:
        h, t = self.grid.h, self.grid.time(step.k)
        drift = self.problem.velocity(t, step.before.x)
        reaction = (step.after.x - step.before.x) / h - drift
        rows = self.problem.rows_within(t + h, step.after.x, h * longest(drift) / 2)
        return distance_to_cone(reaction.ravel(), rows.jacobian(step.after.x))


class StepFailed(RuntimeError):
    """A run that ended early; ``trajectory`` holds all that was computed until then, with its Status."""

    def __init__(self, trajectory: Trajectory) -> None:
        super().__init__(f"{trajectory.status.value} {trajectory.detail}".rstrip())
        self.trajectory = trajectory
