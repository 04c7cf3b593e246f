"""Constrained equations of motion (5.6) with multipliers as unknowns, integrated by IDAS."""

from __future__ import annotations

import io
import re
from contextlib import redirect_stderr
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import describe, flag
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.model.state import FullState, State, orientation_at
from meanfield.model.symbolic import library
from meanfield.solvers.arguments import particles_and_times, tolerance
from meanfield.solvers.index_one import accelerations, consistent_values, index_one_system
from meanfield.solvers.integrate import FAR
from meanfield.solvers.ode import solve_ode
from meanfield.solvers.result import Motion, SolverWork, delivered

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model

    Floats = NDArray[np.float64]

# IDAS bounds the error of a step; over a run the errors add up to some tens of that bound.
SAFETY = 30.0
# Steps between two output times.
MAX_IDAS_STEPS = 100_000
# Coordinates of particles with interaction: the Newton matrix is dense then, and building it takes O(n^3) operations.
MAX_INTERACTING_COORDINATES = 120
# Smallest distance of output times relative to the run. CasADi, for which the run has length 1, skips 1e-9.
MIN_SPACING = 1e-8
# IDAS fails because of det dg/dX, and ``solve_ode`` completes the run, if |det| of a particle is below this part of its
# value at the start or above the inverse: at tolerances of 1e-9 IDAS was seen to fail at 0.19 and 0.24 of it.
BLAMELESS = 0.5
# Number of CasADi's memory object that holds the counters of a call with our buffers; 0 is used by its other calls.
MEMORY = 1
VALUES = ("y", "v", "X", "U", "multipliers")

CAUSES = {
    "IDA_TOO_MUCH_WORK": Status.TOO_MANY_STEPS,
    "IDA_TOO_MUCH_ACC": Status.STEP_TOO_SMALL,
    "IDA_ERR_FAIL": Status.STEP_TOO_SMALL,
    "IDA_CONV_FAIL": Status.NOT_CONVERGED,
    "IDA_LSETUP_FAIL": Status.NOT_CONVERGED,
    "IDA_LSOLVE_FAIL": Status.NOT_CONVERGED,
    "IDA_REP_RES_ERR": Status.NON_FINITE,
    "IDA_FIRST_RES_FAIL": Status.NON_FINITE,
    "IDA_RES_FAIL": Status.NON_FINITE,
}


def solve_dae(model: Model, start: State, t: ArrayLike, tol: float, *, throw: bool = True) -> Motion:
    """Solve (5.6) with the multipliers as unknowns: variable order BDF of IDAS (SUNDIALS, through CasADi).

    The equations are, for all i, with the unknowns y, v, X_i, U_i, lambda_i, y''::

        y' = v,   v' = y'',   y'' = F0 - 1/N sum_j g_y^T lambda_j
        0 = g(X_i, y) - c_i
        0 = g_X U_i + g_y v
        0 = g_X (F1 + 1/N sum_k K(X_k, X_i) - g_X^T lambda_i)/m + g_y y'' + D^2 g[(U_i, v), (U_i, v)]

    They have index 1 (``solvers.index_one``). At every step g, g' and g'' hold to the accuracy of Newton's method; at
    output times, which are interpolated, to a fraction of tol. The constraint does not drift. lambda is under the same
    error control as y. The form of Gear, Gupta and Leimkuhler (index 2), compared at 1e-10, takes as many steps and is
    as accurate in y, but lambda is accurate to 1e-6 only, and the form fails if lambda is under error control. A step
    takes O(N) operations, with interaction O(N^3).

    Near a singularity the multipliers grow as 1/det dg/dX, and the error control of IDAS fails: it steps over the
    singularity, or makes steps without end. So the states after the first step at which |det dg/dX| of a particle is
    below 1/20 of its value at the start, or above 20 times it, are those of ``solve_ode``, which locates singularities.

    Parameters
    ----------
    t
        output times, >= 0 and increasing, at least 1e-8 of the run apart; the run starts at 0 and ends at the last one.
    tol
        tolerance of the error of all unknowns in the mean square, relative to 1 + the value + the largest value of its
        kind (y, v, X, U, lambda) at the start. Runs over two periods exceed it by a factor of up to twenty; 1e-13 is
        below rounding.
    throw
        raise SolveFailed on failure; otherwise return the output times reached, with their Status.

    Returns
    -------
    Motion
        its multipliers are the unknowns of the integrator.

    Raises
    ------
    InvalidProblem
        if t, tol or the start is invalid, or particles with interaction have more than 120 coordinates.
    SolveFailed
        if dg/dX loses its rank, a value is not finite, or the steps become too many or too small.

    Source: (5.6), (5.7); Mattsson and Soederlind, SIAM J. Sci. Comput. 14 (1993) 677.
    """
    tol, raises = tolerance(tol), flag("throw", throw)
    first, times = particles_and_times(model, start, t, tol)
    gaps = np.diff(times, prepend=0.0)
    if (gaps[gaps > 0] < MIN_SPACING * times[-1]).any():
        raise InvalidProblem(f"t = {describe(times)}: times must differ by at least {MIN_SPACING:g} of the last one")
    most = MAX_INTERACTING_COORDINATES // model.nx
    if model.V is not None and len(first.X) > most:
        raise InvalidProblem(f"N = {len(first.X)} particles with interaction: must be at most {most} for solve_dae")
    return delivered(_solve(model, first, times, tol), raises)


class _Run(NamedTuple):
    """Values of y, v, X, U and lambda at the output times reached; message and counters of IDAS.

    ``far`` is positive from the first step on at which det dg/dX of a particle was far from its value at the start.
    """

    y: Floats
    v: Floats
    X: Floats
    U: Floats
    multipliers: Floats
    far: Floats
    message: str
    counters: dict[str, Any]


class _Problem:
    """Equations of a run for CasADi's integrator, in the time s = t/duration."""

    def __init__(self, model: Model, start: FullState, duration: float, tol: float) -> None:
        X, U = consistent_values(model, start.X, start.y, start.v, start.level)
        found = accelerations(model, X, U, start.y, start.v)
        gX, gy = model.jacobians(X, start.y)
        sums = np.einsum("jik,ji->jk", gy, found.multipliers).cumsum(axis=0) / len(X)
        parts = [start.y, start.v, *(part.ravel() for part in (X, U, found.multipliers, found.y, sums))]
        sizes = [np.full(part.size, 1 + np.abs(part).max()) for part in parts]
        self.x, self.z = np.concatenate(parts[:2]), np.concatenate(parts[2:])
        self._shape, self._duration = X.shape, duration
        orientation_at(model, start)
        self._equations = index_one_system(model, start.level, np.linalg.det(gX), FAR, duration)
        self._options = {
            "reltol": tol / SAFETY,
            "abstolv": list(tol / SAFETY * np.concatenate(sizes)),
            "init_xdot": list(duration * np.concatenate([start.v, found.y])),
            "calc_ic": False,
            "max_num_steps": MAX_IDAS_STEPS,
            "show_eval_warnings": False,
        }

    def run(self, times: Floats) -> _Run:
        """Integrate to the last output time without restarts.

        When IDAS fails, CasADi raises and its results are lost. Results up to the failure remain in our buffers.
        """
        outputs = list(times / self._duration)
        integrator = library().integrator("motion", "idas", self._equations, 0.0, outputs, self._options)
        results = [np.full((len(times), size), np.nan) for size in (self.x.size, self.z.size, 1)]
        memory, call = integrator.buffer()
        for k, value in enumerate((self.x, self.z)):
            memory.set_arg(k, value.data)
        for k, result in enumerate(results):
            memory.set_res(k, result.reshape(-1).data)
        log, message = io.StringIO(), ""
        with redirect_stderr(log):
            try:
                call()
            except RuntimeError as error:
                message = f"{error} {log.getvalue()}"
        return self._split(results, message, integrator.stats(MEMORY))

    def _split(self, results: list[Floats], message: str, counters: dict[str, Any]) -> _Run:
        reached = int(np.isfinite(results[2]).sum())
        x, z, far = (result[:reached] for result in results)
        ny, size = x.shape[1] // 2, int(np.prod(self._shape))
        X, U, multipliers = (z[:, k * size : (k + 1) * size].reshape(reached, *self._shape) for k in range(3))
        return _Run(x[:, :ny], x[:, ny:], X, U, multipliers, far[:, 0], message, counters)


def _solve(model: Model, start: FullState, times: Floats, tol: float) -> Motion:
    """Compute the motion until the last output time, or the last one reached without a violation of (5.5)."""
    try:
        problem = _Problem(model, start, times[-1], tol)
    except StepFailure as error:
        no_y, no_X = np.empty((0, model.ny)), np.empty((0, *start.X.shape))
        empty = _Run(no_y, no_y, no_X, no_X, no_X, times[:0], "", {})
        return _motion(model, start, times[:0], empty, 0, error.status, error.detail)
    run, unknowns = problem.run(times), problem.x.size + problem.z.size
    regular = int((run.far == 0).cumprod().sum())
    if regular == len(times):
        return _motion(model, start, times, run, unknowns, Status.SUCCESS, "")
    by_ode = partial(solve_ode, model, State(*start), tol=tol, throw=False)
    rest = by_ode(times)
    if regular == len(run.far) and rest.status:
        status, detail, end = _cause(run.message, times[-1])
        if end == 0 or _changes_little(model, start, by_ode([end])):
            return _motion(model, start, times[:regular], run, unknowns, status, detail)
    parts: dict[str, Any] = {
        name: np.concatenate([getattr(run, name)[:regular], getattr(rest, name)[regular:]]) for name in VALUES
    }
    found = run._replace(**parts)
    return _motion(model, start, times[: len(found.y)], found, unknowns, rest.status, rest.detail)


def _changes_little(model: Model, start: FullState, motion: Motion) -> bool:
    """Return whether det dg/dX at the end of a motion is close to its value at the start."""
    first, last = (
        np.linalg.det(model.jacobians(X, y)[0]) for X, y in ((start.X, start.y), (motion.X[-1], motion.y[-1]))
    )
    ratio = np.abs(last / first)
    return bool(ratio.min() > BLAMELESS and ratio.max() < 1 / BLAMELESS)


def _motion(model: Model, start: FullState, t: Floats, run: _Run, unknowns: int, status: Status, detail: str) -> Motion:
    work = SolverWork(unknowns, *(int(run.counters.get(name, 0)) for name in ("nsteps", "nfevals", "nniters")))
    y, v, X, U, multipliers = (getattr(run, name)[: len(t)] for name in VALUES)
    return Motion(model, t, y, v, status, detail, work, X, U, multipliers, start.level, None)


def _cause(message: str, duration: float) -> tuple[Status, str, float]:
    """Return the status of a failure of IDAS, what it reported, and its time, 0 if that is unknown."""
    code = next((code for code in CAUSES if code in message), "IDAS")
    reported = re.search(r"At t = ([0-9.e+-]+)", message)
    end = duration * float(reported[1].rstrip(".")) if reported else 0.0
    return CAUSES.get(code, Status.NOT_CONVERGED), f"{code} near t = {end:.6g}.", end
