"""Ordinary differential equations to tolerance, by SciPy's DOP853, with a watch on the orientation of dg/dX."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.solvers.pace import check_pace

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_STEPS = 100_000
# SciPy takes no relative tolerance below 100 spacings of numbers.
LEAST_RELATIVE = 100 * float(np.finfo(np.float64).eps)
BISECTIONS = 60


class Integrand(Protocol):
    """An autonomous system z' = h(z) whose right-hand side also says on which side of singularity it is.

    ``start`` (n,) is z at time 0, ``orientation`` the value that ``derivative`` gives along regular motion, ``shares``
    (n,) the weight of each unknown in the mean square of the error.
    """

    start: NDArray[np.float64]
    orientation: float
    shares: NDArray[np.float64]

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """z' and the orientation at z; NaN where there is none."""
        ...


class Integrated(NamedTuple):
    """Values (k, n) and derivatives at the kept times that were reached, how it ended, and the work."""

    z: NDArray[np.float64]
    derivatives: NDArray[np.float64]
    status: Status
    detail: str
    steps: int
    evaluations: int


def integrate(integrand: Integrand, kept: NDArray[np.float64], tol: float, most: int | None = None) -> Integrated:
    """Integrate from 0 over the kept times, in at most ``most`` steps (None: ``MOST_STEPS``).

    A trial step into places where the derivative is not finite is rejected; a step over a change of orientation ends
    the run, with the time of the change.

    Raises
    ------
    InvalidProblem
        if the derivative at the start is not finite.
    """
    _check_start(integrand)
    march = _March(integrand, kept, tol, MOST_STEPS if most is None else most)
    status, detail = Status.SUCCESS, ""
    with np.errstate(all="ignore"):
        try:
            while len(march.collected) < len(kept):
                march.step()
        except StepFailure as error:
            status, detail = error.status, error.detail
        z = np.array(march.collected).reshape(-1, integrand.start.size)
        derivatives = np.array([integrand.derivative(row)[0] for row in z]).reshape(z.shape)
    return Integrated(z, derivatives, status, detail, march.steps, march.evaluations)


def _check_start(integrand: Integrand) -> None:
    try:
        with np.errstate(all="ignore"):
            finite = bool(np.isfinite(integrand.derivative(integrand.start)[0]).all())
    except StepFailure:
        finite = False
    if not finite:
        raise InvalidProblem("the start: must be where all forces of the model are finite")


class _March:
    """Steps of DOP853 and what they passed."""

    def __init__(self, integrand: Integrand, kept: NDArray[np.float64], tol: float, most: int) -> None:
        from scipy.integrate import DOP853

        self._integrand, self._kept, self._most = integrand, kept, most
        self._orientation = integrand.orientation
        self._trouble: StepFailure | None = None
        self.steps = self.evaluations = 0
        shares = integrand.shares
        allowed = tol / np.sqrt(shares * shares.size / shares.sum())
        relative = np.maximum(allowed, LEAST_RELATIVE)
        self._solver: Any = DOP853(self._evaluated, 0.0, integrand.start, kept[-1], rtol=relative, atol=allowed)
        self.collected = [integrand.start] if kept[0] == 0 else []

    def step(self) -> None:
        """Make one step and collect the kept times in it."""
        solver = self._solver
        check_pace(self.steps, self._most, solver.t, self._kept[-1])
        solver.step()
        self.steps += 1
        if solver.status == "failed":
            status = self._trouble.status if self._trouble else Status.STEP_TOO_SMALL
            raise StepFailure(status, f"The step vanished at t = {solver.t:.6g}.")
        crossed = self._orientation != self._integrand.orientation
        ahead = self._kept[len(self.collected) :]
        inside: Any = solver.dense_output() if crossed or ahead[0] < solver.t else None
        until = self._crossing(inside, solver.t_old, solver.t) if crossed else solver.t
        for time in ahead[ahead <= until]:
            self.collected.append(solver.y.copy() if time == solver.t else inside(time))
        if crossed:
            raise StepFailure(Status.SINGULAR, f"det dg/dX changes its sign at t = {until:.6g}.")

    def _evaluated(self, t: float, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """The right-hand side for SciPy; keeps the orientation of its last call, which is at the end of a step."""
        self.evaluations += 1
        try:
            derivative, self._orientation = self._integrand.derivative(z)
            self._trouble = None
        except StepFailure as trouble:
            derivative, self._orientation, self._trouble = np.full_like(z, np.nan), np.nan, trouble
        return derivative

    def _crossing(self, inside: Any, before: float, after: float) -> float:
        """The last time in a step at which the orientation is still that of the start, by bisection."""
        for _ in range(BISECTIONS):
            middle = (before + after) / 2
            regular = self._integrand.derivative(inside(middle))[1] == self._integrand.orientation
            before, after = (middle, after) if regular else (before, middle)
        return before
