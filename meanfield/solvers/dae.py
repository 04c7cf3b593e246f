"""Constrained equations of motion (5.6) with multipliers as unknowns, integrated by IDAS.

(5.6) has index 3: the multipliers appear in the second derivative of the constraint, and their differential equation
needs a third. Here the index is reduced to 1 by dummy derivatives: g = c, g' = 0 and g'' = 0 are all equations of the
system. In return, X_i and U_i = X_i' are algebraic unknowns, determined by g = c and g' = 0. Only y and v = y' are
integrated, so that integration errors cannot violate the constraint or its derivative. X_i'' is given by (5.6a).
"""

from __future__ import annotations

import io
import re
from contextlib import redirect_stderr
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import describe, flag
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.forces import acceleration
from meanfield.model.symbolic import library
from meanfield.solvers.ode import FAR, solve_ode
from meanfield.solvers.result import Motion, SolverWork, checked_run, delivered, multipliers, tolerance

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats
    from meanfield.model.model import Model
    from meanfield.model.state import State

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
COUNTERS = ("nsteps", "nfevals", "nniters")

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

    They have index 1. At every step g, g' and g'' hold to the accuracy of Newton's method; at
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
    level, orientation, times = checked_run(model, start, t)
    gaps = np.diff(times, prepend=0.0)
    if (gaps[gaps > 0] < MIN_SPACING * times[-1]).any():
        raise InvalidProblem(f"t = {describe(times)}: times must differ by at least {MIN_SPACING:g} of the last one")
    most = MAX_INTERACTING_COORDINATES // model.nx
    if model.V is not None and len(level) > most:
        raise InvalidProblem(f"N = {len(level)} particles with interaction: must be at most {most} for solve_dae")
    status, detail, counters = Status.SUCCESS, "", {}
    try:
        first = _initial_values(model, start, orientation)
    except StepFailure as error:
        status, detail = error.status, error.detail
        empty = np.empty((0, model.ny)), np.empty((0, *level.shape))
        values = dict(zip(VALUES, (empty[0], empty[0], empty[1], empty[1], empty[1]), strict=True))
    else:
        run = _integrated(model, level, first, times, tol)
        values, counters = run.values, run.counters
        if (run.far == 0).sum() < len(times):
            values, status, detail = _past_failure(model, start, run, times, tol)
    n, ny = level.size, model.ny
    work = SolverWork(3 * (n + ny) + len(level) * ny, *(int(counters.get(name, 0)) for name in COUNTERS))
    y, v, X, U, lambdas = values.values()
    w = np.full(len(level), 1 / len(level))
    return delivered(Motion(model, times[: len(y)], y, v, status, detail, work, X, U, lambdas, level, w), raises)


class _Run(NamedTuple):
    """Values of y, v, X, U and lambda at the output times that IDAS reached, its message and counters.

    ``far`` is positive from the first step on at which det dg/dX of a particle was far from its value at the start.
    """

    values: dict[str, Floats]
    far: Floats
    message: str
    counters: dict[str, Any]


def _initial_values(model: Model, start: State, orientation: float) -> dict[str, Floats]:
    """Return y, v; X, U, lambda, y'' and the partial sums of (5.6b) at the start; StepFailure if not finite."""
    X, y, v = np.asarray(start.X), np.asarray(start.y), np.asarray(start.v)
    w = np.full(len(X), 1 / len(X))
    a = acceleration(model, X, w, y, v, orientation)
    if not np.isfinite(a).all():
        raise StepFailure(Status.NON_FINITE, "The accelerations are not finite.")
    lambdas = multipliers(model, X, w, y, v, a)
    sums = np.einsum("jik,ji->jk", model.jacobians(X, y)[1], lambdas).cumsum(axis=0) / len(X)
    return {"y": y, "v": v, "X": X, "U": model.phi(X, y) @ v, "multipliers": lambdas, "a": a, "sums": sums}


def _integrated(model: Model, level: Floats, first: dict[str, Floats], times: Floats, tol: float) -> _Run:
    """Integrate to the last output time without restarts, in the time s = t/duration.

    When IDAS fails, CasADi raises and its results are lost. Results up to the failure remain in our buffers.
    """
    duration, ny = times[-1], model.ny
    parts = [part.ravel() for part in first.values()]
    sizes = [np.full(part.size, 1 + np.abs(part).max()) for part in parts]
    x, z = np.concatenate(parts[:2]), np.concatenate(parts[2:])
    options = {
        "reltol": tol / SAFETY,
        "abstolv": list(tol / SAFETY * np.concatenate(sizes)),
        "init_xdot": list(duration * np.concatenate([first["v"], first["a"]])),
        "calc_ic": False,
        "max_num_steps": MAX_IDAS_STEPS,
        "show_eval_warnings": False,
    }
    determinants = np.linalg.det(model.jacobians(first["X"], first["y"])[0])
    equations = _equations(model, level, determinants, duration)
    integrator = library().integrator("motion", "idas", equations, 0.0, list(times / duration), options)
    results = [np.full((len(times), size), np.nan) for size in (x.size, z.size, 1)]
    memory, call = integrator.buffer()
    for k, value in enumerate((x, z)):
        memory.set_arg(k, value.data)
    for k, result in enumerate(results):
        memory.set_res(k, result.reshape(-1).data)
    log, message = io.StringIO(), ""
    with redirect_stderr(log):
        try:
            call()
        except RuntimeError as error:
            message = f"{error} {log.getvalue()}"
    reached, n = int(np.isfinite(results[2]).sum()), level.size
    x, z, far = (result[:reached] for result in results)
    particles = [z[:, k * n : (k + 1) * n].reshape(reached, *level.shape) for k in range(3)]
    values = dict(zip(VALUES, [x[:, :ny], x[:, ny:], *particles], strict=True))
    return _Run(values, far[:, 0], message, integrator.stats(MEMORY))


def _past_failure(
    model: Model, start: State, run: _Run, times: Floats, tol: float
) -> tuple[dict[str, Floats], Status, str]:
    """Complete a run by ``solve_ode`` from where det dg/dX was far from its start; else return why IDAS failed."""
    regular = int((run.far == 0).cumprod().sum())
    rest = solve_ode(model, start, times, tol, throw=False)
    if regular == len(run.far) and rest.status:
        code = next((code for code in CAUSES if code in run.message), "IDAS")
        reported = re.search(r"At t = ([0-9.e+-]+)", run.message)
        end = times[-1] * float(reported[1].rstrip(".")) if reported else 0.0
        if end == 0 or _changes_little(model, solve_ode(model, start, [end], tol, throw=False), start):
            return run.values, CAUSES.get(code, Status.NOT_CONVERGED), f"{code} near t = {end:.6g}."
    values = {name: np.concatenate([run.values[name][:regular], getattr(rest, name)[regular:]]) for name in VALUES}
    return values, rest.status, rest.detail


def _changes_little(model: Model, motion: Motion, start: State) -> bool:
    """Return whether det dg/dX at the end of a motion is close to its value at the start."""
    ends = ((start.X, start.y), (motion.X[-1], motion.y[-1]))
    first, last = (np.linalg.det(model.jacobians(X, y)[0]) for X, y in ends)
    ratio = np.abs(last / first)
    return bool(ratio.min() > BLAMELESS and ratio.max() < 1 / BLAMELESS)


def _equations(model: Model, level: Floats, determinants: Floats, duration: float) -> dict[str, Any]:
    """Build (5.6) with g = level, g' = 0 and g'' = 0 for CasADi's integrator, in the time t/duration.

    Differential unknowns are (y, v), algebraic ones X, U, lambda of all particles, y'' and s_1 ... s_N.
    The sum of (5.6b) is a chain s_j = s_{j-1} + g_y(X_j, y)^T lambda_j / N, which keeps all rows of the Newton matrix
    short. With a plain sum, one row depends on all particles, and the matrix takes N differentiations instead
    of a few. The quadrature counts the particles for which (5.5) may be violated near by: the ratio of det g_X to its
    value at the start, ``determinants`` (N,), is below ``FAR`` or above its inverse.
    """
    ca = library()
    N, nx, ny = len(level), model.nx, model.ny
    X, U, multipliers = (ca.SX.sym(name, nx, N) for name in ("X", "U", "multipliers"))
    y, v, w = (ca.SX.sym(name, ny) for name in ("y", "v", "w"))
    sums = ca.SX.sym("s", ny, N)
    spread = [ca.repmat(symbol, 1, N) for symbol in (y, v, w)]
    g, dg, ddg, reaction, determinant = _particle(model).map(N)(X, U, multipliers, _interactions(model, X), *spread)
    ratio = determinant / ca.DM(determinants[None])
    before = ca.horzcat(ca.SX.zeros(ny, 1), sums[:, : N - 1])
    F0 = ca.Function("F0", [model.expressions.y], [model.expressions.F0])(y)
    residuals = [g - ca.DM(level.T), dg, ddg, w - F0 + sums[:, N - 1], sums - before - reaction / N]
    return {
        "x": ca.vertcat(y, v),
        "z": _stack([X, U, multipliers, w, sums]),
        "ode": duration * ca.vertcat(v, w),
        "alg": _stack(residuals),
        "quad": ca.sum2(ca.logic_or(ratio <= FAR, ratio >= 1 / FAR)),
    }


def _stack(blocks: list[Any]) -> Any:
    ca = library()
    return ca.vertcat(*(ca.vec(ca.densify(block)) for block in blocks))


def _particle(model: Model) -> Any:
    """Build a function of one particle: g, g', g'' with X'' from (5.6a), g_y^T lambda of (5.6b), and det g_X."""
    ca = library()
    e = model.expressions
    multiplier, interaction, w = (ca.SX.sym(name, n) for name, n in (("l", model.nx), ("k", model.nx), ("w", model.ny)))
    acceleration = (e.F1 + interaction - ca.mtimes(e.gX.T, multiplier)) / model.m
    dg = ca.mtimes(e.gX, e.U) + ca.mtimes(e.gy, e.v)
    ddg = ca.mtimes(e.gX, acceleration) + ca.mtimes(e.gy, w) + e.curvature
    inputs = [e.X, e.U, multiplier, interaction, e.y, e.v, w]
    outputs = [e.level, dg, ddg, ca.mtimes(e.gy.T, multiplier), e.determinant]
    return ca.Function("particle", inputs, ca.cse([ca.densify(o) for o in outputs]))


def _interactions(model: Model, X: Any) -> Any:
    """Express 1/N sum_k K(X_k, X_i) for each i, by direct sum."""
    ca = library()
    N = X.shape[1]
    if model.V is None:
        return ca.SX.zeros(model.nx, N)
    K = ca.Function("K", [model.expressions.r], [model.expressions.K]).map(N)
    return ca.horzcat(*(ca.sum2(K(X - ca.repmat(X[:, i], 1, N))) for i in range(N))) / N
