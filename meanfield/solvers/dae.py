"""The constrained equations of motion (5.6), integrated as they are by IDAS."""

from __future__ import annotations

import io
import re
from contextlib import redirect_stderr
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import describe, flag
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.errors import SolveFailed
from meanfield.model.state import FullState, State, oriented
from meanfield.model.symbolic import library
from meanfield.solvers.arguments import model_given, state_given, times, tolerance
from meanfield.solvers.index import accelerations, consistent, system
from meanfield.solvers.motion import Motion, SolverWork

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model

# IDAS bounds the error of a step; over a run the errors add up to some tens of that.
SAFETY = 30.0
# Steps between two kept times.
MOST_STEPS = 100_000
# Coordinates of particles with interaction: Newton's matrix is full then, and building it takes their number cubed.
MOST_INTERACTING = 120
# CasADi does not go on to an output closer than 1e-9 to the one before; the run has length 1 there.
CLOSEST = 1e-8
# Looks back from a failure, in parts of its time: IDAS tells that to six digits.
BEFORE = np.array([1e-2, 1e-3, 1e-4, 1e-5])
# A run that failed where det dg/dX had become this much smaller, or larger, than at the start, failed because of it.
FADED = 0.2
# CasADi keeps the counters of a call with memory of ours here; 0 is its own.
MEMORY = 1

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

    They have index 1 (``solvers.index``): g, g' and g'' hold at every step to the accuracy of Newton's method, and
    at kept times, which are interpolated, to a part of tol: nothing drifts off. lambda is under the same error control
    as y. Compared with the form of Gear, Gupta and Leimkuhler (index 2) at 1e-10: in as many steps that one finds y as
    well, but lambda to 1e-6 only, and with lambda under error control it fails at once. A step takes O(N) operations,
    with interaction O(N^3).

    Parameters
    ----------
    t
        times to keep, >= 0 and increasing, not closer than 1e-8 of the run; it starts at 0 and ends at the last one.
    tol
        error of all unknowns that a run over two periods keeps up to a factor of twenty: in the mean square, relative
        to 1 + the value + the largest of its kind (y, v, X, U, lambda) at the start; 1e-13 is lost to rounding.
    throw
        raise SolveFailed on failure; else return the motion until then, with its Status.

    Returns
    -------
    Motion
        whose multipliers are the unknowns of the integrator.

    Raises
    ------
    InvalidProblem
        if t, tol or the start cannot be right, or particles with interaction are too many.
    SolveFailed
        if dg/dX loses its rank, a value is not finite, or the steps become too many or too small.

    Source: (5.6), (5.7); Mattsson and Soederlind, SIAM J. Sci. Comput. 14 (1993) 677.
    """
    model_given(model)
    state_given(start)
    kept, tol, raises = times(t), tolerance(tol), flag("throw", throw)
    gaps = np.diff(kept, prepend=0.0)
    if (gaps[gaps > 0] < CLOSEST * kept[-1]).any():
        raise InvalidProblem(f"t = {describe(kept)}: must be times at least {CLOSEST:g} of the last one apart")
    first = start.checked(model, tol)
    most = MOST_INTERACTING // model.nx
    if model.V is not None and len(first.X) > most:
        raise InvalidProblem(f"N = {len(first.X)} particles with interaction: must be at most {most} here")
    motion = _solved(model, first, kept, tol)
    if raises and not motion.status:
        raise SolveFailed(motion.status, motion.detail, motion)
    return motion


class _Run(NamedTuple):
    """Rows of y, v, X, U, lambda and the number of flipped particles, as far as it came; what IDAS said and counted."""

    y: NDArray[np.float64]
    v: NDArray[np.float64]
    X: NDArray[np.float64]
    U: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    flipped: NDArray[np.float64]
    message: str
    counters: dict[str, Any]


class _Problem:
    """The equations of one start as CasADi's integrator takes them, in the time s = t/duration."""

    def __init__(self, model: Model, start: FullState, duration: float, tol: float) -> None:
        X, U = consistent(model, start.X, start.y, start.v, start.level)
        found = accelerations(model, X, U, start.y, start.v)
        gX, gy = model.jacobians(X, start.y)
        sums = np.einsum("jik,ji->jk", gy, found.multipliers).cumsum(axis=0) / len(X)
        self.determinants = np.linalg.det(gX)
        parts = [start.y, start.v, *(part.ravel() for part in (X, U, found.multipliers, found.y, sums))]
        sizes = [np.full(part.size, 1 + np.abs(part).max()) for part in parts]
        self.x, self.z = np.concatenate(parts[:2]), np.concatenate(parts[2:])
        self._shape, self._duration = X.shape, duration
        made = system(model, start.level, np.full(len(X), oriented(model, start)))
        self._equations = {"x": made.differential, "z": made.algebraic, "ode": duration * made.rates}
        self._equations |= {"alg": made.residuals, "quad": made.flipped}
        self._options = {
            "reltol": tol / SAFETY,
            "abstolv": list(tol / SAFETY * np.concatenate(sizes)),
            "init_xdot": list(duration * np.concatenate([start.v, found.y])),
            "calc_ic": False,
            "max_num_steps": MOST_STEPS,
            "show_eval_warnings": False,
        }

    def run(self, kept: NDArray[np.float64]) -> _Run:
        """Integrate to the last of the times without a restart in between.

        CasADi raises when IDAS gives up, and its results are lost; those written to memory of ours before are not.
        """
        outputs = list(kept / self._duration)
        integrator = library().integrator("motion", "idas", self._equations, 0.0, outputs, self._options)
        results = [np.full((len(kept), size), np.nan) for size in (self.x.size, self.z.size, 1)]
        memory, call = integrator.buffer()
        for k, value in enumerate((self.x, self.z)):
            memory.set_arg(k, value.data)
        for k, result in enumerate(results):
            memory.set_res(k, result.reshape(-1).data)
        said, message = io.StringIO(), ""
        with redirect_stderr(said):
            try:
                call()
            except RuntimeError as error:
                message = f"{error} {said.getvalue()}"
        return self._split(results, message, integrator.stats(MEMORY))

    def _split(self, results: list[NDArray[np.float64]], message: str, counters: dict[str, Any]) -> _Run:
        reached = int(np.isfinite(results[2]).sum())
        x, z, flipped = (result[:reached] for result in results)
        ny, size = x.shape[1] // 2, int(np.prod(self._shape))
        X, U, multipliers = (z[:, k * size : (k + 1) * size].reshape(reached, *self._shape) for k in range(3))
        return _Run(x[:, :ny], x[:, ny:], X, U, multipliers, flipped[:, 0], message, counters)


def _solved(model: Model, start: FullState, kept: NDArray[np.float64], tol: float) -> Motion:
    """The motion until the last kept time, or the last one that was reached on the right side of (5.5)."""
    try:
        problem = _Problem(model, start, kept[-1], tol)
    except StepFailure as error:
        few, many = np.empty((0, model.ny)), np.empty((0, *start.X.shape))
        nothing = _Run(few, few, many, many, many, kept[:0], "", {})
        return _motion(model, start, kept[:0], nothing, 0, error.status, error.detail)
    run = problem.run(kept)
    good = int((run.flipped == 0).cumprod().sum())
    status, detail = Status.SUCCESS, ""
    if good < len(run.flipped):
        status, detail = Status.SINGULAR, f"det dg/dX changes its sign before t = {kept[good]:.6g}."
    elif good < len(kept):
        status, detail = _cause(model, problem, run.message, kept[-1])
    return _motion(model, start, kept[:good], run, problem.x.size + problem.z.size, status, detail)


def _motion(
    model: Model, start: FullState, t: NDArray[np.float64], run: _Run, unknowns: int, status: Status, detail: str
) -> Motion:
    return Motion(
        model=model,
        t=t,
        y=run.y[: len(t)],
        v=run.v[: len(t)],
        X=run.X[: len(t)],
        U=run.U[: len(t)],
        multipliers=run.multipliers[: len(t)],
        level=start.level,
        weights=None,
        status=status,
        detail=detail,
        work=SolverWork(unknowns, *(int(run.counters.get(name, 0)) for name in ("nsteps", "nfevals", "nniters"))),
    )


def _cause(model: Model, problem: _Problem, message: str, duration: float) -> tuple[Status, str]:
    """What IDAS said; unless a second run, to just before, shows a better reason."""
    code = next((code for code in CAUSES if code in message), "IDAS")
    status = CAUSES.get(code, Status.NOT_CONVERGED)
    told = re.search(r"At t = ([0-9.e+-]+)", message)
    end = duration * float(told[1].rstrip(".")) if told else 0.0
    before = problem.run(end * (1 - BEFORE)) if end > 0 else None
    if before is not None and len(before.flipped):
        if (before.flipped != 0).any() or _faded(model, problem, before):
            return Status.SINGULAR, f"det dg/dX goes to zero or infinity near t = {end:.6g}."
        if status is Status.TOO_MANY_STEPS and before.counters["nsteps"] < MOST_STEPS / 2:
            return Status.STEP_TOO_SMALL, f"The step vanished near t = {end:.6g}."
    return status, f"{code} near t = {end:.6g}."


def _faded(model: Model, problem: _Problem, run: _Run) -> bool:
    """Whether det dg/dX is far from what it was at the start, where a run ended."""
    try:
        gX, _ = model.jacobians(run.X[-1], run.y[-1])
    except StepFailure:
        return True
    ratio = np.linalg.det(gX) / problem.determinants
    return bool(ratio.min() < FADED or ratio.max() > 1 / FADED)
