"""Integration of y, v and the particles by DOP853, which stops where det dg/dX is zero or infinite."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, NoReturn

import numpy as np

from dincl.errors import InvalidProblem, StepFailure
from dincl.events.runge_kutta import order_8
from dincl.status import Status
from meanfield.forces import full_weights, measure
from meanfield.kernels.dop853 import System, stages, step
from meanfield.kernels.program import evaluated
from meanfield.model.reduction import positions_in_closed_form, represented
from meanfield.model.state import orientation_at
from meanfield.solvers.result import SolverWork, with_potential
from meanfield.solvers.singular import End, end_of_step, unresolved_dip

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from meanfield.model.model import Model
    from meanfield.model.state import FullState

    Floats = NDArray[np.float64]

MAX_ODE_STEPS = 100_000
# The first steps of a run say little about its length: step lengths grow by up to a factor of ten from step to step.
WARM_UP_STEPS = 200
# No relative tolerance is below 100 machine epsilons.
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


class Solution(NamedTuple):
    """State at the output times reached: y, v, y'' (k, ny), X, U (k, N, nx); status and work of the run."""

    y: Floats
    v: Floats
    a: Floats
    X: Floats
    U: Floats
    status: Status
    detail: str
    work: SolverWork


def integrate(
    model: Model,
    start: FullState,
    weights: Floats | None,
    times: Floats,
    tol: float,
    *,
    closed: bool = False,
    most: int | None = None,
) -> Solution:
    """Integrate from 0 to the last of the output times, in at most ``most`` steps (None: ``MAX_ODE_STEPS``).

    A trial step to a point where the rate is not finite is rejected, and so is a step that changes the energy or does
    not resolve a dip of |det dg/dX|. The run ends SINGULAR at a change of orientation, or at a dip that no step of
    1e-10 of the run resolves. ``closed``: the particles follow from y in closed form and are no unknowns.

    Raises
    ------
    InvalidProblem
        if the rate at the start is not finite.
    """
    run = _Run(model, start, weights, times, tol, closed, MAX_ODE_STEPS if most is None else most)
    status, detail = Status.SUCCESS, ""
    with np.errstate(all="ignore"):
        try:
            while len(run.outputs) < len(times):
                run.step()
        except StepFailure as error:
            status, detail = error.status, error.detail
        return run.solution(status, detail)


def check_step_limit(steps: int, most: int, now: float, end: float) -> None:
    """Stop a run from time 0 to ``end`` that has reached ``now`` and will not reach ``end`` within ``most`` steps.

    After k steps, a run may still become ``most``/k times as fast as its average so far. A run over 1e30 periods thus
    stops after some hundreds of steps; a run that needs slightly more than ``most`` steps stops after almost ``most``.

    Raises
    ------
    StepFailure
        TOO_MANY_STEPS, with the number of steps made and the number that the run would take.
    """
    if steps >= min(most, WARM_UP_STEPS) and now / end < (steps / most) ** 2:
        total = f"{steps / (now / end):.1e}" if now > 0 else "infinitely many"
        detail = f"{steps} steps until t = {now:.6g}; at this rate the run takes {total}, at most {most} are allowed."
        raise StepFailure(Status.TOO_MANY_STEPS, detail)


class _Run:
    """Steps of one run, and z = (y, v[, X]) at the output times reached."""

    def __init__(
        self,
        model: Model,
        start: FullState,
        weights: Floats | None,
        times: Floats,
        tol: float,
        closed: bool,
        most: int,
    ) -> None:
        self._model, self._start, self._times, self._tol, self._most = model, start, times, tol, most
        self._closed = closed
        self._watched = None if model.jacobian_varies else 1
        level, self._weights = represented(model, start.level, weights) if closed else (start.level, weights)
        self._z = np.concatenate([start.y, start.v, *([] if closed else [start.X.ravel()])])
        # Each component of y and v weighs as much as all particles together in the mean square of the error.
        n, share = self._z.size, np.ones(self._z.size)
        if not closed:
            share[: 2 * model.ny] = start.X.size
        allowed = tol / np.sqrt(share * n / share.sum())
        pair = order_8()
        self._system = System(
            measure=measure(model, full_weights(self._weights, len(level)), orientation_at(model, start)),
            closed=closed,
            positions=positions_in_closed_form(model).with_workspace(),
            level=np.array(level, order="C"),
            pair=pair,
            allowed=allowed,
            relative=np.maximum(allowed, MIN_RELATIVE),
            X=np.empty(level.shape),
            U=np.empty(level.shape),
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
        system, end = self._system, float(self._times[-1])
        try:
            check_step_limit(self._steps, self._most, self._t, end)
        except StepFailure as failure:
            self._fail(failure.status, failure.detail)
        h, length, evaluations, wrong = step(system, self._z, self._t, end, self._length)
        self._steps += 1
        self._evaluations += evaluations
        if h == 0.0:
            self._fail(Status.STEP_TOO_SMALL, f"The step vanished at t = {self._t:.9g}.")
        after = system.after.copy()
        reached = end if h >= end - self._t else self._t + h
        shorter = self._shorter(after, h, reached, bool(wrong))
        if shorter is not None:
            self._length = shorter
            return
        remaining = self._times[len(self.outputs) :]
        if remaining[0] < reached:
            dense = self._dense(after, h)
        for time in remaining[remaining <= reached]:
            self.outputs.append(after if time == reached else _at(self._z, dense, (time - self._t) / h))
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
        """Return the end of a step and the kinetic and potential energy at z, where the rate was evaluated last.

        The end is None, and the energies are NaN, where they are not finite. One particle is enough for the end if
        dg/dX depends on y alone.
        """
        model, few, ny = self._model, slice(self._watched), self._model.ny
        X, U, y, v = self._system.X, self._system.U, z[:ny], z[ny : 2 * ny]
        try:
            determinant, turning, W1, W0 = model.watched(X, y, U, v)
            found = with_potential(model, X, self._weights, U, v, W0, W1)
        except StepFailure:
            return end_of_step(model, X[few], y, U[few], v), (np.nan, np.nan)
        values, rates = np.concatenate([y, X[few].ravel()]), np.concatenate([v, U[few].ravel()])
        return End(values, rates, determinant[few], turning[few]), found

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
        h = min(1e-6 if size < 1e-5 or speed < 1e-5 else 0.01 * size / speed, end)
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

    def solution(self, status: Status, detail: str) -> Solution:
        """Return the values at the output times reached."""
        model, count = self._model, len(self.outputs)
        ny, n = model.ny, self._z.size
        z, rate = np.array(self.outputs).reshape(count, n), np.empty((count, n))
        X = np.empty((count, *self._start.X.shape))
        for k in range(count):
            stages(self._system, z[k], 0.0, 0, 1)
            rate[k] = self._system.rate[0]
            if self._closed:
                program = positions_in_closed_form(model)
                X[k] = evaluated(program, self._start.level, program.none, z[k, :ny])
            else:
                X[k] = self._system.X
        y, v = z[:, :ny], z[:, ny : 2 * ny]
        U = np.array([model.phi(X[k], y[k]) @ v[k] for k in range(count)]).reshape(X.shape)
        work = SolverWork(n, self._steps, self._evaluations)
        return Solution(y, v, rate[:, ny : 2 * ny], X, U, status, detail, work)


def _at(z: Floats, dense: Floats, place: float) -> Floats:
    """Evaluate the dense output at a place in the step, 0 to 1."""
    value = np.zeros_like(z)
    for j in range(len(dense) - 1, -1, -1):
        value = (value + dense[j]) * (place if j % 2 == 0 else 1 - place)
    return np.asarray(z + value)
