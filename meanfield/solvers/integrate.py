"""Integration of ordinary differential equations by SciPy's DOP853, which stops where det dg/dX is zero or infinite."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, Protocol

import numpy as np

from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.solvers.singular import unresolved_dip
from meanfield.solvers.step_limit import check_step_limit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from meanfield.model.model import Model

MAX_ODE_STEPS = 100_000
# SciPy accepts no relative tolerance below 100 machine epsilons.
MIN_RELATIVE = 100 * float(np.finfo(np.float64).eps)
# A step that is rejected, because it does not resolve a dip of |det dg/dX| or changes the energy, is repeated with this
# part of its length, or with half the way to the dip.
SHORTER, APPROACH = 0.25, 0.5
# Shortest step towards a dip, relative to the run: a dip that it does not resolve is a zero of the determinant.
SHORTEST = 1e-10
# Largest change of the energy in a step, relative to the tolerance and the energies (at least 1, as the tolerance is
# relative to 1 + |value|). Steps of regular motions at tolerances from 1e-12 to 1e-2 change it by less than 1.
ENERGY_CHANGE = 10.0
# det dg/dX is far from its value at the start if |det| is below this part of it, or above the inverse. A step that
# vanishes there vanishes because of it.
FAR = 0.05


class OdeSystem(Protocol):
    """Autonomous system z' = h(z) whose right-hand side also returns the orientation, the mean sign of det dg/dX.

    ``start`` (n,) is z at time 0, ``orientation`` the orientation along regular motion, ``error_weights`` (n,) the
    weight of each unknown in the mean square of the error.
    """

    model: Model
    start: NDArray[np.float64]
    orientation: float
    error_weights: NDArray[np.float64]

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Compute z' and the orientation at z; NaN where they are undefined."""
        ...

    def path(
        self, z: NDArray[np.float64], rate: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return y and the particles whose det dg/dX is watched as one array, and its rate, from z and z'."""
        ...

    def energies(self, z: NDArray[np.float64], rate: NDArray[np.float64]) -> tuple[float, float]:
        """Compute the kinetic and the potential energy from z and z'; StepFailure if they are not finite."""
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

    A trial step to a point where the derivative is not finite is rejected, and so is a step that changes the energy or
    does not resolve a dip of |det dg/dX|. The run ends SINGULAR at a change of orientation, or at a dip that no step of
    1e-10 of the run resolves.

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

        self._system, self._times, self._most, self._tol = system, times, most, tol
        self._orientation = system.orientation
        self._failure: StepFailure | None = None
        self.steps = self.evaluations = 0
        weights = system.error_weights
        allowed = tol / np.sqrt(weights * weights.size / weights.sum())
        relative = np.maximum(allowed, MIN_RELATIVE)
        self._solver: Any = DOP853(self._derivative, 0.0, system.start, times[-1], rtol=relative, atol=allowed)
        self.outputs = [system.start] if times[0] == 0 else []
        self._energies = self._energies_now()
        self._rejected = np.inf

    def step(self) -> None:
        """Make one step, or reject it; append the values at the output times in it."""
        solver = self._solver
        try:
            check_step_limit(self.steps, self._most, solver.t, self._times[-1])
        except StepFailure as failure:
            self._fail(failure.status, failure.detail)
        t, z, rate = solver.t, solver.y, solver.f
        solver.step()
        self.steps += 1
        if solver.status == "failed":
            status = self._failure.status if self._failure else Status.STEP_TOO_SMALL
            self._fail(status, f"The step vanished at t = {solver.t:.9g}.")
        shorter = self._shorter(z, rate, solver.t - t)
        if shorter is not None:
            solver.t, solver.y, solver.f, solver.status, solver.h_abs = t, z, rate, "running", shorter
            return
        remaining = self._times[len(self.outputs) :]
        interpolant: Any = solver.dense_output() if remaining[0] < solver.t else None
        for time in remaining[remaining <= solver.t]:
            self.outputs.append(solver.y.copy() if time == solver.t else interpolant(time))

    def _shorter(self, z: NDArray[np.float64], rate: NDArray[np.float64], h: float) -> float | None:
        """Return the length with which the step that was just made from (z, rate) is repeated; None if it stands.

        Raises
        ------
        StepFailure
            SINGULAR if a step of the shortest length does not resolve a zero or pole of det dg/dX.
        """
        solver, system = self._solver, self._system
        before, after = system.path(z, rate), system.path(solver.y, solver.f)
        crossed = self._orientation != system.orientation
        place = unresolved_dip(system.model, before, after, h)
        if place is not None or crossed:
            distance = h * (0.5 if place is None else place)
            if h <= SHORTEST * self._times[-1]:
                how = "changes its sign" if crossed else "is zero or infinite, without a change of sign,"
                raise StepFailure(Status.SINGULAR, f"det dg/dX {how} at t = {solver.t - h + distance:.9g}.")
            return max(APPROACH * distance, SHORTER * SHORTEST * self._times[-1])
        energies = self._energies_now()
        change = abs(sum(energies) - sum(self._energies))
        size = 1 + max(self._energies[0], energies[0]) + abs(energies[1])
        # A change that a shorter step does not lower is rounding, except near a zero, where all steps are wrong.
        if change > ENERGY_CHANGE * self._tol * size and (change <= self._rejected / 2 or self._is_far()):
            self._rejected = change
            if h <= SHORTEST * self._times[-1]:
                self._fail(Status.STEP_TOO_SMALL, f"The energy changes at t = {solver.t:.9g}, however short the step.")
            return SHORTER * h
        self._energies, self._rejected = energies, np.inf
        return None

    def _energies_now(self) -> tuple[float, float]:
        """Return the kinetic and the potential energy, NaN if they are not finite."""
        try:
            return self._system.energies(self._solver.y, self._solver.f)
        except StepFailure:
            return np.nan, np.nan

    def _is_far(self) -> bool:
        """Return whether det dg/dX of a particle is far from its value at the start."""
        solver, system = self._solver, self._system
        try:
            first, now = (_determinants(system, z, system.derivative(z)[0]) for z in (system.start, solver.y))
        except StepFailure:
            return True
        ratio = np.abs(now / first)
        return not (ratio.min() > FAR and ratio.max() < 1 / FAR)

    def _fail(self, status: Status, detail: str) -> NoReturn:
        """Raise StepFailure: SINGULAR if det dg/dX is far from its value at the start, else as given."""
        if self._is_far():
            detail = f"det dg/dX goes to zero or infinity near t = {self._solver.t:.9g}."
            raise StepFailure(Status.SINGULAR, detail)
        raise StepFailure(status, detail)

    def _derivative(self, t: float, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate the right-hand side for SciPy and store the orientation; the last call is at the end of a step."""
        self.evaluations += 1
        try:
            derivative, self._orientation = self._system.derivative(z)
            self._failure = None
        except StepFailure as failure:
            derivative, self._orientation, self._failure = np.full_like(z, np.nan), np.nan, failure
        return derivative


def _determinants(system: OdeSystem, z: NDArray[np.float64], rate: NDArray[np.float64]) -> NDArray[np.float64]:
    values, rates = system.path(z, rate)
    ny, nx = system.model.ny, system.model.nx
    X, U = (part[ny:].reshape(-1, nx) for part in (values, rates))
    return system.model.determinant(X, values[:ny], U, rates[:ny])[0]
