"""Reduced equations (5.11): Newton's law for y with effective mass and force, transport of the particles, by DOP853."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

import numpy as np

from dincl.checks import flag
from dincl.errors import InvalidProblem, StepFailure
from dincl.events.runge_kutta import order_8
from dincl.status import Status
from meanfield.forces import measure
from meanfield.kernels.dop853 import System, stages, step
from meanfield.solvers.result import Motion, SolverWork, checked_run, delivered, multipliers, tolerance, with_potential
from meanfield.solvers.singular import end_of_step, unresolved_dip

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats
    from meanfield.model.model import Model
    from meanfield.model.state import State
    from meanfield.solvers.singular import End

MAX_ODE_STEPS = 100_000
# The first steps of a run say little about its length: step lengths grow by up to a factor of ten from step to step.
WARM_UP_STEPS = 200
# No relative tolerance is below 100 machine epsilons.
MIN_RELATIVE = 100 * float(np.finfo(np.float64).eps)
# A step that is rejected, because it does not resolve a dip of |det dg/dX| or changes the energy, is repeated with this
# part of its length, or with half the way to the dip.
SHORTER, APPROACH = 0.25, 0.5
# A trial step that is not zero, however fast the start.
SHORTEST_TRIAL = 1e-300
# Shortest step towards a dip, relative to the run: a dip that it does not resolve is a zero of the determinant.
SHORTEST = 1e-10
# Largest change of the energy in a step, relative to the tolerance and the energies (at least 1, as the tolerance is
# relative to 1 + |value|). Steps of regular motions at tolerances from 1e-12 to 1e-2 change it by less than 1.
ENERGY_CHANGE = 10.0
# det dg/dX is far from its value at the start if |det| is below this part of it, or above the inverse. A step that
# vanishes there vanishes because of it.
FAR = 0.05


def solve_ode(model: Model, start: State, t: ArrayLike, tol: float, *, throw: bool = True) -> Motion:
    """Solve m_eff y'' = F_eff, X_i' = Phi(X_i, y) y' with DOP853 (order 8, adaptive steps).

    Where |det dg/dX| or its inverse falls and rises again, steps are shortened until they resolve it, so that a motion
    may come near a singularity. It ends SINGULAR at a zero or pole of det dg/dX, with or without a change of its sign:
    at one that steps of 1e-10 of the run do not resolve, or where steps vanish, or change the energy by more than ten
    times the tolerance, while |det dg/dX| is below 1/20 of its value at the start or above 20 times it.

    Parameters
    ----------
    t
        output times, >= 0 and increasing; the run starts at 0 and ends at the last one.
    tol
        local error of a step, relative to 1 + |value|: for y and v each, for the particles in the mean square.
    throw
        raise SolveFailed on failure; otherwise return the output times reached, with their Status.

    Returns
    -------
    Motion
        its multipliers are computed by (A.12).

    Raises
    ------
    InvalidProblem
        if t, tol or the start is invalid, or a force is not finite at the start.
    SolveFailed
        if dg/dX loses its rank, the step becomes too small or a value is not finite.

    Source: (5.11)-(5.17), Proposition 5.1.
    """
    return solve_weighted(model, start, None, t, tol, throw=throw)


def solve_weighted(
    model: Model,
    start: State,
    weights: Floats | None,
    t: ArrayLike,
    tol: float,
    *,
    throw: bool = True,
    most_steps: int | None = None,
) -> Motion:
    """Solve as ``solve_ode``, for particles with weights (N,) that sum to 1: the flow (5.40) of a measure of points.

    ``most_steps`` limits the steps of the integrator; None: as in ``solve_ode``.
    """
    tol, raises = tolerance(tol), flag("throw", throw)
    level, orientation, times = checked_run(model, start, t)
    w = np.full(len(level), 1 / len(level)) if weights is None else weights
    status, detail = Status.SUCCESS, ""
    with np.errstate(all="ignore"):
        run = _Run(model, start, orientation, w, times, tol, MAX_ODE_STEPS if most_steps is None else most_steps)
        try:
            while len(run.outputs) < len(times):
                run.step()
        except StepFailure as error:
            status, detail = error.status, error.detail
        return delivered(run.motion(level, status, detail), raises)


class _Run:
    """Steps of one run, and z = (y, v, X) at the output times reached.

    A trial step to a point where the rate is not finite is rejected, and so is a step that changes the energy or does
    not resolve a dip of |det dg/dX|. The run ends SINGULAR at a change of orientation, or at a dip that no step of
    1e-10 of the run resolves.
    """

    def __init__(
        self, model: Model, start: State, orientation: float, weights: Floats, times: Floats, tol: float, most: int
    ) -> None:
        self._model, self._times, self._tol, self._most = model, times, tol, most
        X = np.asarray(start.X)
        self._z = np.concatenate([start.y, start.v, X.ravel()])
        # Each component of y and v weighs as much as all particles together in the mean square of the error.
        n, share = self._z.size, np.ones(self._z.size)
        share[: 2 * model.ny] = X.size
        allowed = tol / np.sqrt(share * n / share.sum())
        pair = order_8()
        self._system = System(
            measure=measure(model, weights, orientation),
            pair=pair,
            allowed=allowed,
            relative=np.maximum(allowed, MIN_RELATIVE),
            X=np.empty(X.shape),
            U=np.empty(X.shape),
            rate=np.zeros((pair.stages + 1 + pair.more, n)),
            after=np.empty(n),
        )
        stages(self._system, self._z, 0.0, 0, 1)
        if not np.isfinite(self._system.rate[0]).all():
            raise InvalidProblem("start: all forces of the model must be finite there")
        self._end, self._energies = self._watch(self._z)
        self._first = self._end
        self._t, self._steps, self._evaluations = 0.0, 0, 2
        self._rejected = np.inf
        self._length = self._first_length(self._system.rate[0].copy())
        self.outputs = [self._z] if times[0] == 0 else []

    def step(self) -> None:
        """Make one step, or reject it; append the values at the output times in it."""
        system, end, now = self._system, float(self._times[-1]), self._t
        # After k steps, a run may still become most/k times as fast as its average so far: a run over 1e30 periods
        # stops after some hundreds of steps, one that needs slightly more than ``most`` steps after almost ``most``.
        if self._steps >= min(self._most, WARM_UP_STEPS) and now / end < (self._steps / self._most) ** 2:
            total = f"{self._steps / (now / end):.1e}" if now > 0 else "infinitely many"
            detail = f"{self._steps} steps until t = {now:.6g}; at this rate the run takes {total}"
            self._fail(Status.TOO_MANY_STEPS, f"{detail}, at most {self._most} are allowed.")
        h, length, evaluations, wrong = step(system, self._z, now, end, self._length)
        self._steps += 1
        self._evaluations += evaluations
        if h == 0.0:
            self._fail(Status.STEP_TOO_SMALL, f"The step vanished at t = {now:.9g}.")
        after = system.after.copy()
        reached = end if h >= end - now else now + h
        shorter = self._shorter(after, h, reached, bool(wrong))
        if shorter is not None:
            self._length = shorter
            return
        remaining = self._times[len(self.outputs) :]
        if remaining[0] < reached:
            dense = self._dense(after, h)
        for time in remaining[remaining <= reached]:
            self.outputs.append(after if time == reached else _at(self._z, dense, (time - now) / h))
        self._t, self._z, self._length = reached, after, length
        system.rate[0] = system.rate[system.pair.stages]

    def _shorter(self, z: Floats, h: float, reached: float, crossed: bool) -> float | None:
        """Return the length with which the step that was just made to z is repeated; None if it stands.

        Raises
        ------
        StepFailure
            SINGULAR if a step of the shortest length does not resolve a zero or pole of det dg/dX.
        """
        (end, found), energies_before = self._watch(z), self._energies
        place = unresolved_dip(self._model, self._end, end, h)
        if place is not None or crossed:
            distance = h * (0.5 if place is None else place)
            if h <= SHORTEST * self._times[-1]:
                how = "changes its sign" if crossed else "is zero or infinite, without a change of sign,"
                raise StepFailure(Status.SINGULAR, f"det dg/dX {how} at t = {self._t + distance:.9g}.")
            return max(APPROACH * distance, SHORTER * SHORTEST * float(self._times[-1]))
        change = abs(sum(found) - sum(energies_before))
        size = 1 + max(energies_before[0], found[0]) + abs(found[1])
        # A change that a shorter step does not lower is rounding, except near a zero, where all steps are wrong.
        if change > ENERGY_CHANGE * self._tol * size and (change <= self._rejected / 2 or self._is_far(end)):
            self._rejected = change
            if h <= SHORTEST * self._times[-1]:
                self._fail(Status.STEP_TOO_SMALL, f"The energy changes at t = {reached:.9g}, however short the step.")
            return SHORTER * h
        self._energies, self._rejected, self._end = found, np.inf, end
        return None

    def _watch(self, z: Floats) -> tuple[End | None, tuple[float, float]]:
        """Return the end of a step and the kinetic and potential energy at z, where the rate was evaluated last."""
        X, U, ny = self._system.X, self._system.U, self._model.ny
        y, v = z[:ny], z[ny : 2 * ny]
        end, W0, W1 = end_of_step(self._model, X, y, U, v)
        return end, with_potential(self._model, X, self._system.measure.weights, U, v, W0, W1)

    def _is_far(self, end: End | None) -> bool:
        """Return whether det dg/dX of a particle is far from its value at the start."""
        if self._first is None or end is None:
            return True
        ratio = np.abs(end.determinant / self._first.determinant)
        return not (ratio.min() > FAR and ratio.max() < 1 / FAR)

    def _fail(self, status: Status, detail: str) -> NoReturn:
        """Raise StepFailure: SINGULAR if det dg/dX is far from its value at the start, else as given."""
        if self._is_far(self._end):
            detail = f"det dg/dX goes to zero or infinity near t = {self._t:.9g}."
            raise StepFailure(Status.SINGULAR, detail)
        raise StepFailure(status, detail)

    def _first_length(self, rate: Floats) -> float:
        """Choose the length of the first step: Hairer, Norsett and Wanner, Solving ODEs I, II.4."""
        system, end = self._system, float(self._times[-1])
        scale = system.allowed + np.abs(self._z) * system.relative
        size, speed = (float(np.sqrt(np.mean((part / scale) ** 2))) for part in (self._z, rate))
        h = max(min(1e-6 if size < 1e-5 or speed < 1e-5 else 0.01 * size / speed, end), SHORTEST_TRIAL)
        stages(system, self._z + h * rate, 0.0, 0, 1)
        bend = float(np.sqrt(np.mean(((system.rate[0] - rate) / scale) ** 2))) / h
        system.rate[0] = rate
        most = max(1e-6, 1e-3 * h) if max(speed, bend) <= 1e-15 else (0.01 / max(speed, bend)) ** (1 / 8)
        return min(100 * h, most, end)

    def _dense(self, after: Floats, h: float) -> Floats:
        """Return the dense output (terms, n) of the step that was just made, see ``_at``."""
        pair, rate, change = self._system.pair, self._system.rate, after - self._z
        first, last = pair.stages + 1, pair.stages + 1 + pair.more
        stages(self._system, self._z, h, first, last)
        self._evaluations += pair.more
        start, end = h * rate[0], h * rate[pair.stages]
        return np.vstack([change, start - change, 2 * change - end - start, h * pair.dense @ rate])

    def motion(self, level: Floats, status: Status, detail: str) -> Motion:
        """Return the motion at the output times reached."""
        model, system, ny = self._model, self._system, self._model.ny
        w, shape = system.measure.weights, level.shape
        z = np.array(self.outputs).reshape(-1, self._z.size)
        y, v, X = z[:, :ny], z[:, ny : 2 * ny], z[:, 2 * ny :].reshape(-1, *shape)
        U, lambdas = np.empty(X.shape), np.empty(X.shape)
        for k, state in enumerate(z):
            stages(system, state, 0.0, 0, 1)
            U[k] = model.phi(X[k], y[k]) @ v[k]
            lambdas[k] = multipliers(model, X[k], w, y[k], v[k], system.rate[0, ny : 2 * ny])
        work = SolverWork(self._z.size, self._steps, self._evaluations)
        return Motion(model, self._times[: len(z)], y, v, status, detail, work, X, U, lambdas, level, w)


def _at(z: Floats, dense: Floats, place: float) -> Floats:
    """Evaluate the dense output at a place in the step, 0 to 1."""
    value = np.zeros_like(z)
    for j in range(len(dense) - 1, -1, -1):
        value = (value + dense[j]) * (place if j % 2 == 0 else 1 - place)
    return np.asarray(z + value)
