"""RATTLE for (5.6), leapfrog with multipliers for the constraint and its derivative, and symmetric compositions."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import describe, flag, integer, number
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.forces import forces
from meanfield.model.state import FullState, State, orientation_at
from meanfield.solvers.arguments import particles_and_times
from meanfield.solvers.index_one import MAX_NEWTON_ITERATIONS, NEWTON_TOLERANCE, accelerations, solve_blocks, solve_mass
from meanfield.solvers.ode import solve_ode
from meanfield.solvers.result import Motion, SolverWork, delivered
from meanfield.solvers.singular import End, end_of_step, unresolved_dip

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model

    Floats = NDArray[np.float64]

# Lengths of the substeps for each order, up to the middle substep; the others follow by symmetry.
# Order 4: Suzuki, Phys. Lett. A 146 (1990) 319. Orders 6 and 8: Kahan and Li, Math. Comp. 66 (1997) 1089, s9odr6a and
# s17odr8a; printed in Hairer, Lubich and Wanner, Geometric Numerical Integration, 2nd ed., V.3.2.
SUZUKI = 1 / (4 - 4 ** (1 / 3))
HALVES: dict[int, tuple[float, ...]] = {
    2: (1.0,),
    4: (SUZUKI, SUZUKI, 1 - 4 * SUZUKI),
    6: (
        0.39216144400731413927925056,
        0.33259913678935943859974864,
        -0.70624617255763935980996482,
        0.08221359629355080023149045,
        0.79854399093482996339895035,
    ),
    8: (
        0.13020248308889008087881763,
        0.56116298177510838456196441,
        -0.38947496264484728640807860,
        0.15884190655515560089621075,
        -0.39590389413323757733623154,
        0.18453964097831570709183254,
        0.25837438768632204729397911,
        0.29501172360931029887096624,
        -0.60550853383003451169892108,
    ),
}
SUBSTEPS = {order: half + half[-2::-1] for order, half in HALVES.items()}
MAX_RATTLE_STEPS = 10_000_000
# An interval that is a multiple of dt up to this relative rounding gets no additional step.
INTERVAL_ROUNDING = 1e-9
# Tolerance of the constraint at the start; the first step reduces its violation to rounding.
START_TOLERANCE = 1e-9


def solve_rattle(model: Model, start: State, t: ArrayLike, dt: float, order: int = 2, *, throw: bool = True) -> Motion:
    """Solve (5.6) by RATTLE, which is symplectic and time-reversible, or by a symmetric composition of such steps.

    One step of length h, with lambda such that g(X_i, y) = c_i and mu such that g_X U_i + g_y v = 0 at its end::

        U_i += h/(2m) (F1 + K_i - g_X^T lambda_i),   v += h/2 (F0 - 1/N sum_j g_y^T lambda_j)      at the old positions
        X_i += h U_i,                                y += h v
        U_i += h/(2m) (F1 + K_i - g_X^T mu_i),       v += h/2 (F0 - 1/N sum_j g_y^T mu_j)          at the new positions

    lambda_i acts on X_i and, with all other multipliers, on y. The Newton matrix is one block per particle plus a
    matrix of rank ny; an iteration takes O(N) operations and a system of size ny. Newton's method converges to
    rounding: the constraint and its derivative hold after each step.

    Parameters
    ----------
    t
        output times, >= 0 and increasing; the run starts at 0 and ends at the last one.
    dt
        longest step; each interval between output times is divided into equal steps.
    order
        2, or 4, 6, 8 with 5, 9, 17 substeps per step, some of them backwards in time.
    throw
        raise SolveFailed on failure; otherwise return the output times reached, with their Status.

    Returns
    -------
    Motion
        its multipliers are those of (5.6), computed from the states at the output times.

    Raises
    ------
    InvalidProblem
        if t, dt, order or the start is invalid.
    SolveFailed
        if dg/dX loses its rank, Newton's method does not converge, or a value is not finite.

    Source: (5.6); Andersen, J. Comput. Phys. 52 (1983) 24; Hairer, Lubich and Wanner, VII.1.4.
    """
    raises, dt = flag("throw", throw), number("dt", dt, positive=True)
    first, times = particles_and_times(model, start, t, START_TOLERANCE)
    if integer("order", order, least=2, most=8) not in SUBSTEPS:
        raise InvalidProblem(f"order = {describe(order)}: must be one of {', '.join(map(str, SUBSTEPS))}")
    if times[-1] > MAX_RATTLE_STEPS * dt:
        least = times[-1] / MAX_RATTLE_STEPS
        raise InvalidProblem(f"dt = {dt:g}: must be at least {least:g}, for {MAX_RATTLE_STEPS} steps at most")
    status, detail = Status.SUCCESS, ""
    with np.errstate(all="ignore"):
        run = _Run(model, first, SUBSTEPS[order])
        try:
            run.integrate(times, dt)
        except StepFailure as error:
            status, detail = error.status, f"{error.detail.rstrip('.')}, after t = {run.time:.6g}."
    return delivered(run.motion(times, status, detail), raises)


class _Point(NamedTuple):
    """State with the derivatives of g, ratio = g_X^{-1} g_y, and the accelerations a of X and w of y.

    The accelerations are those of the forces; at the end of a step they include the multipliers mu. As initial guess of
    the next step they save an iteration. The result is the same, because lambda_i acts in the same directions as mu_i.
    """

    X: Floats
    y: Floats
    U: Floats
    v: Floats
    gX: Floats
    gy: Floats
    ratio: Floats
    a: Floats
    w: Floats


class _Run:
    """Steps of one run, and its states at the output times reached."""

    def __init__(self, model: Model, start: FullState, lengths: tuple[float, ...]) -> None:
        self._model, self._start, self._level, self._lengths = model, start, start.level, lengths
        self._sign = orientation_at(model, start)
        self._outputs: list[tuple[Floats, ...]] = []
        self._steps = self._newton = 0
        self.time = 0.0

    def integrate(self, times: Floats, dt: float) -> None:
        """Step to the last output time."""
        self._point = self._at(*self._start[:4])
        self._end = self._end_of(self._point)
        for before, time in pairwise([0.0, *times]):
            steps = math.ceil((time - before) / dt * (1 - INTERVAL_ROUNDING))
            for k in range(steps):
                self.time = before + (time - before) * k / steps
                h, last = (time - before) / steps, self._point
                for length in self._lengths:
                    self._point = self._step(self._point, length * h)
                self._check_dips(last, h)
                self._steps += 1
            X, y, U, v = self._point[:4]
            self._outputs.append((y, v, X, U, accelerations(self._model, X, U, y, v).multipliers))

    def motion(self, times: Floats, status: Status, detail: str) -> Motion:
        """Return the states at the output times reached."""
        count, shape, ny = len(self._outputs), self._level.shape, self._model.ny
        columns = zip(*self._outputs, strict=True) if count else [()] * 5
        y, v, X, U, multipliers = (
            np.array(part).reshape(count, *((ny,) if k < 2 else shape)) for k, part in enumerate(columns)
        )
        evaluations = self._steps * len(self._lengths)
        work = SolverWork(2 * (ny + self._level.size), self._steps, evaluations, self._newton)
        return Motion(self._model, times[:count], y, v, status, detail, work, X, U, multipliers, self._level, None)

    def _step(self, old: _Point, h: float) -> _Point:
        """Make one step of RATTLE; the corrections by lambda are part of the velocities after its first half."""
        U, v = old.U + h / 2 * old.a, old.v + h / 2 * old.w
        for _ in range(MAX_NEWTON_ITERATIONS):
            X, y = old.X + h * U, old.y + h * v
            size = 1 + max(np.abs(X).max(), np.abs(y).max())
            if not np.isfinite(size):
                raise StepFailure(Status.NON_FINITE, "The positions are not finite.")
            gX, gy = self._model.jacobians(X, y)
            dX, dy = self._correction(gX, gy, self._model.level(X, y) - self._level, old.ratio)
            U, v = U + dX / h, v + dy / h
            self._newton += 1
            if max(np.abs(dX).max(), np.abs(dy).max()) <= NEWTON_TOLERANCE * size:
                break
        else:
            raise StepFailure(Status.NOT_CONVERGED, f"The constraint was not met in a step of length {h:.3g}.")
        new = self._at(old.X + h * U, old.y + h * v, v, U)
        U, v = U + h / 2 * new.a, v + h / 2 * new.w
        residual = (new.gX @ U[:, :, None])[:, :, 0] + new.gy @ v
        dU, dv = self._correction(new.gX, new.gy, residual, new.ratio)
        return new._replace(U=U + dU, v=v + dv, a=new.a + 2 / h * dU, w=new.w + 2 / h * dv)

    def _check_dips(self, last: _Point, h: float) -> None:
        """Raise StepFailure if det dg/dX touches zero in a step: where it may, ``solve_ode`` repeats the step."""
        before, self._end = self._end, self._end_of(self._point)
        if unresolved_dip(self._model, before, self._end, h) is not None:
            passed = solve_ode(self._model, State(X=last.X, y=last.y, v=last.v), [h], START_TOLERANCE, throw=False)
            if passed.status is Status.SINGULAR:
                raise StepFailure(Status.SINGULAR, "det dg/dX is zero or infinite.")

    def _end_of(self, point: _Point) -> End | None:
        return end_of_step(self._model, point.X, point.y, point.U, point.v)

    def _correction(self, gX: Floats, gy: Floats, residual: Floats, ratio: Floats) -> tuple[Floats, Floats]:
        """Solve g_X dX_i + g_y dy = -residual_i for corrections (dX, dy) that multipliers can cause.

        Multipliers l_i cause m dX_i = -G_X^T l_i, dy = -1/N sum_j G_y^T l_j with the Jacobians G where they act, hence
        dy = m/N sum_j ratio_j^T dX_j with ratio = G_X^{-1} G_y. Eliminating dX_i leaves ny unknowns.
        """
        both = solve_blocks(gX, np.concatenate((residual[:, :, None], gy), axis=2))
        fixed, slope = both[:, :, 0], both[:, :, 1:]
        scale = self._model.m / len(gX)
        matrix = np.eye(self._model.ny) + scale * np.einsum("jik,jil->kl", ratio, slope)
        dy = solve_mass(matrix, -scale * np.einsum("jik,ji->k", ratio, fixed))
        if not np.isfinite(dy).all():
            raise StepFailure(Status.NON_FINITE, "A correction of y is not finite.")
        return -fixed - slope @ dy, dy

    def _at(self, X: Floats, y: Floats, v: Floats, U: Floats) -> _Point:
        model = self._model
        gX, gy = model.jacobians(X, y)
        if (np.sign(np.linalg.det(gX)) != self._sign).any():
            raise StepFailure(Status.SINGULAR, "det dg/dX changes its sign.")
        force = model.F1(X) if model.V is None else model.F1(X) + forces(model, X, None)
        return _Point(X, y, U, v, gX, gy, solve_blocks(gX, gy), force / model.m, model.F0(y))
