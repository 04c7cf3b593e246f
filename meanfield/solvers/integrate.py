"""Integration of ordinary differential equations by SciPy's DOP853, which stops when det dg/dX changes its sign."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.solvers.step_limit import check_step_limit

if TYPE_CHECKING:
    from numpy.typing import NDArray

MAX_ODE_STEPS = 100_000
# SciPy accepts no relative tolerance below 100 machine epsilons.
MIN_RELATIVE = 100 * float(np.finfo(np.float64).eps)
BISECTIONS = 60


class OdeSystem(Protocol):
    """Autonomous system z' = h(z) whose right-hand side also returns the orientation, the mean sign of det dg/dX.

    ``start`` (n,) is z at time 0, ``orientation`` the orientation along regular motion, ``error_weights`` (n,) the
    weight of each unknown in the mean square of the error.
    """

    start: NDArray[np.float64]
    orientation: float
    error_weights: NDArray[np.float64]

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Compute z' and the orientation at z; NaN where they are undefined."""
        ...


class OdeSolution(NamedTuple):
    """Values z (k, n) and derivatives at the output times reached, the status of the run, and its work."""

    z: NDArray[np.float64]
    derivatives: NDArray[np.float64]
    status: Status
    detail: str
    steps: int
    evaluations: int


def integrate(system: OdeSystem, times: NDArray[np.float64], tol: float, most: int | None = None) -> OdeSolution:
    """Integrate from 0 to the last of the output times, in at most ``most`` steps (None: ``MAX_ODE_STEPS``).

    A trial step to a point where the derivative is not finite is rejected. A step across a change of orientation ends
    the run at the time of the change.

    Raises
    ------
    InvalidProblem
        if the derivative at the start is not finite.
    """
    _check_start(system)
    integrator = _Integrator(system, times, tol, MAX_ODE_STEPS if most is None else most)
    status, detail = Status.SUCCESS, ""
    with np.errstate(all="ignore"):
        try:
            while len(integrator.outputs) < len(times):
                integrator.step()
        except StepFailure as error:
            status, detail = error.status, error.detail
        z = np.array(integrator.outputs).reshape(-1, system.start.size)
        derivatives = np.array([system.derivative(row)[0] for row in z]).reshape(z.shape)
    return OdeSolution(z, derivatives, status, detail, integrator.steps, integrator.evaluations)


def _check_start(system: OdeSystem) -> None:
    try:
        with np.errstate(all="ignore"):
            finite = bool(np.isfinite(system.derivative(system.start)[0]).all())
    except StepFailure:
        finite = False
    if not finite:
        raise InvalidProblem("start: all forces of the model must be finite there")


class _Integrator:
    """Steps of DOP853, and the values at the output times reached."""

    def __init__(self, system: OdeSystem, times: NDArray[np.float64], tol: float, most: int) -> None:
        from scipy.integrate import DOP853

        self._system, self._times, self._most = system, times, most
        self._orientation = system.orientation
        self._failure: StepFailure | None = None
        self.steps = self.evaluations = 0
        weights = system.error_weights
        allowed = tol / np.sqrt(weights * weights.size / weights.sum())
        relative = np.maximum(allowed, MIN_RELATIVE)
        self._solver: Any = DOP853(self._derivative, 0.0, system.start, times[-1], rtol=relative, atol=allowed)
        self.outputs = [system.start] if times[0] == 0 else []

    def step(self) -> None:
        """Make one step and append the values at the output times in it."""
        solver = self._solver
        check_step_limit(self.steps, self._most, solver.t, self._times[-1])
        solver.step()
        self.steps += 1
        if solver.status == "failed":
            status = self._failure.status if self._failure else Status.STEP_TOO_SMALL
            raise StepFailure(status, f"The step vanished at t = {solver.t:.6g}.")
        crossed = self._orientation != self._system.orientation
        remaining = self._times[len(self.outputs) :]
        interpolant: Any = solver.dense_output() if crossed or remaining[0] < solver.t else None
        until = self._crossing(interpolant, solver.t_old, solver.t) if crossed else solver.t
        for time in remaining[remaining <= until]:
            self.outputs.append(solver.y.copy() if time == solver.t else interpolant(time))
        if crossed:
            raise StepFailure(Status.SINGULAR, f"det dg/dX changes its sign at t = {until:.6g}.")

    def _derivative(self, t: float, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate the right-hand side for SciPy and store the orientation; the last call is at the end of a step."""
        self.evaluations += 1
        try:
            derivative, self._orientation = self._system.derivative(z)
            self._failure = None
        except StepFailure as failure:
            derivative, self._orientation, self._failure = np.full_like(z, np.nan), np.nan, failure
        return derivative

    def _crossing(self, interpolant: Any, before: float, after: float) -> float:
        """Find by bisection the last time in a step at which the orientation is that of the start."""
        for _ in range(BISECTIONS):
            middle = (before + after) / 2
            regular = self._system.derivative(interpolant(middle))[1] == self._system.orientation
            before, after = (middle, after) if regular else (before, middle)
        return before
