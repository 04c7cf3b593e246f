"""RATTLE for (5.6): leapfrog with multipliers that keep the constraint and its velocity form, and its compositions."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import describe, flag, integer, number
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.errors import SolveFailed
from meanfield.forces.field import accelerated
from meanfield.forces.interaction import forces
from meanfield.model.state import FullState, State, oriented
from meanfield.solvers.arguments import model_given, state_given, times
from meanfield.solvers.index import FINE, MOST_CORRECTIONS, accelerations, solved
from meanfield.solvers.motion import Motion, SolverWork

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model

# Lengths of the substeps, up to the middle one; the others mirror them.
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
MOST_STEPS = 10_000_000
# A kept interval that is a multiple of dt but for rounding is not given one step more.
ROUNDING = 1e-9
# How far a start may be off the constraint: the first step leads it back.
ASTRAY = 1e-9


def solve_rattle(model: Model, start: State, t: ArrayLike, dt: float, order: int = 2, *, throw: bool = True) -> Motion:
    """Solve (5.6) by RATTLE, which is symplectic and time-reversible, or by a symmetric composition of such steps.

    One step of length h, with lambda such that g(X_i, y) = c_i and mu such that g_X U_i + g_y v = 0 at its end::

        U_i += h/(2m) (F1 + K_i - g_X^T lambda_i),   v += h/2 (F0 - 1/N sum_j g_y^T lambda_j)      at the old positions
        X_i += h U_i,                                y += h v
        U_i += h/(2m) (F1 + K_i - g_X^T mu_i),       v += h/2 (F0 - 1/N sum_j g_y^T mu_j)          at the new positions

    lambda_i acts on X_i and, with all others, on y: Newton's matrix is one block per particle and a part of rank ny, so
    an iteration takes O(N) and a system of size ny. It goes on until rounding: both constraints hold after each step.

    Parameters
    ----------
    t
        times to keep, >= 0 and increasing; the run starts at 0 and ends at the last one.
    dt
        longest step; each kept interval is divided into equal ones.
    order
        2, or 4, 6, 8 with 5, 9, 17 substeps per step, some of which go back in time.
    throw
        raise SolveFailed on failure; else return the motion until then, with its Status.

    Returns
    -------
    Motion
        whose multipliers are those of (5.6) at the kept times, from the state there.

    Raises
    ------
    InvalidProblem
        if t, dt, order or the start cannot be right.
    SolveFailed
        if dg/dX loses its rank, the constraint is not met by the end of a step, or a value is not finite.

    Source: (5.6); Andersen, J. Comput. Phys. 52 (1983) 24; Hairer, Lubich and Wanner, VII.1.4.
    """
    model_given(model)
    state_given(start)
    raises = flag("throw", throw)
    kept, dt = times(t), number("dt", dt, positive=True)
    if integer("order", order, least=2, most=8) not in SUBSTEPS:
        raise InvalidProblem(f"order = {describe(order)}: must be one of {', '.join(map(str, SUBSTEPS))}")
    if kept[-1] > MOST_STEPS * dt:
        raise InvalidProblem(f"dt = {dt:g}: must be at least {kept[-1] / MOST_STEPS:g}, for {MOST_STEPS} steps at most")
    first = start.checked(model, ASTRAY)
    run = _Run(model, first, SUBSTEPS[order])
    status, detail = Status.SUCCESS, ""
    try:
        with np.errstate(all="ignore"):
            run.over(kept, dt)
    except StepFailure as error:
        status, detail = error.status, f"{error.detail.rstrip('.')}, after t = {run.time:.6g}."
    motion = run.motion(kept, status, detail)
    if raises and not motion.status:
        raise SolveFailed(motion.status, motion.detail, motion)
    return motion


class _Point(NamedTuple):
    """Positions and velocities, derivatives of g, back = g_X^{-1} g_y, and accelerations a of X and w of y.

    The accelerations are those by the forces, or at the end of a step with the multipliers mu: as the first guess of
    the next step they do no harm, since its lambda_i act along the same directions, and save an iteration.
    """

    X: NDArray[np.float64]
    y: NDArray[np.float64]
    U: NDArray[np.float64]
    v: NDArray[np.float64]
    gX: NDArray[np.float64]
    gy: NDArray[np.float64]
    back: NDArray[np.float64]
    a: NDArray[np.float64]
    w: NDArray[np.float64]


class _Run:
    """The steps of one run, and the states kept."""

    def __init__(self, model: Model, start: FullState, lengths: tuple[float, ...]) -> None:
        self._model, self._level, self._lengths = model, start.level, lengths
        self._start = start
        self._sign = oriented(model, start)
        self._kept: list[tuple[_Point, NDArray[np.float64]]] = []
        self._steps = self._newton = 0
        self.time = 0.0

    def over(self, kept: NDArray[np.float64], dt: float) -> None:
        """Step over the kept times."""
        start = self._start
        point = self._at(start.X, start.y, start.U, start.v)
        for before, time in pairwise([0.0, *kept]):
            steps = math.ceil((time - before) / dt * (1 - ROUNDING))
            for k in range(steps):
                self.time = before + (time - before) * k / steps
                for length in self._lengths:
                    point = self._stepped(point, length * (time - before) / steps)
                self._steps += 1
            self._kept.append((point, accelerations(self._model, point.X, point.U, point.y, point.v).multipliers))

    def motion(self, kept: NDArray[np.float64], status: Status, detail: str) -> Motion:
        """The states kept so far."""
        shape, ny = self._start.X.shape, self._model.ny
        points = [point for point, _ in self._kept]
        evaluations = self._steps * len(self._lengths)
        return Motion(
            model=self._model,
            t=kept[: len(points)],
            y=np.array([p.y for p in points]).reshape(-1, ny),
            v=np.array([p.v for p in points]).reshape(-1, ny),
            X=np.array([p.X for p in points]).reshape(-1, *shape),
            U=np.array([p.U for p in points]).reshape(-1, *shape),
            multipliers=np.array([multipliers for _, multipliers in self._kept]).reshape(-1, *shape),
            level=self._level,
            weights=None,
            status=status,
            detail=detail,
            work=SolverWork(2 * (ny + shape[0] * shape[1]), self._steps, evaluations, self._newton),
        )

    def _stepped(self, old: _Point, h: float) -> _Point:
        """One step of RATTLE; the velocities after its first half carry the correction for lambda."""
        U, v = old.U + h / 2 * old.a, old.v + h / 2 * old.w
        for _ in range(MOST_CORRECTIONS):
            X, y = old.X + h * U, old.y + h * v
            _check_finite(X, y)
            gX, gy = self._model.jacobians(X, y)
            dX, dy = self._corrected(gX, gy, self._model.level(X, y) - self._level, old.back)
            U, v = U + dX / h, v + dy / h
            self._newton += 1
            if max(np.abs(dX).max(), np.abs(dy).max()) <= FINE * (1 + max(np.abs(X).max(), np.abs(y).max())):
                break
        else:
            raise StepFailure(Status.NOT_CONVERGED, f"The constraint was not met in a step of length {h:.3g}.")
        new = self._at(old.X + h * U, old.y + h * v, U, v)
        U, v = U + h / 2 * new.a, v + h / 2 * new.w
        residual = (new.gX @ U[:, :, None])[:, :, 0] + new.gy @ v
        dU, dv = self._corrected(new.gX, new.gy, residual, new.back)
        return new._replace(U=U + dU, v=v + dv, a=new.a + 2 / h * dU, w=new.w + 2 / h * dv)

    def _corrected(
        self,
        gX: NDArray[np.float64],
        gy: NDArray[np.float64],
        residual: NDArray[np.float64],
        back: NDArray[np.float64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(dX, dy) that solve g_X dX_i + g_y dy = -residual_i and are what multipliers do.

        Multipliers l_i do m dX_i = -G_X^T l_i, dy = -1/N sum_j G_y^T l_j with the Jacobians G where they act, hence
        dy = m/N sum_j back_j^T dX_j with back = G_X^{-1} G_y. With dX_i from the first equation, ny unknowns are left.
        """
        both = solved(gX, np.concatenate((residual[:, :, None], gy), axis=2))
        fixed, slope = both[:, :, 0], both[:, :, 1:]
        scale = self._model.m / len(gX)
        matrix = np.eye(self._model.ny) + scale * np.einsum("jik,jil->kl", back, slope)
        dy = accelerated(matrix, -scale * np.einsum("jik,ji->k", back, fixed))
        if not np.isfinite(dy).all():
            raise StepFailure(Status.NON_FINITE, "A correction of y is not finite.")
        return -fixed - slope @ dy, dy

    def _at(
        self, X: NDArray[np.float64], y: NDArray[np.float64], U: NDArray[np.float64], v: NDArray[np.float64]
    ) -> _Point:
        model = self._model
        gX, gy = model.jacobians(X, y)
        if (np.sign(np.linalg.det(gX)) != self._sign).any():
            raise StepFailure(Status.SINGULAR, "det dg/dX changes its sign.")
        force = model.F1(X) if model.V is None else model.F1(X) + forces(model, X, None)
        return _Point(X, y, U, v, gX, gy, solved(gX, gy), force / model.m, model.F0(y))


def _check_finite(X: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    if not (np.isfinite(X).all() and np.isfinite(y).all()):
        raise StepFailure(Status.NON_FINITE, "The positions left the finite numbers.")
