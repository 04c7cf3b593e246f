"""Constrained equations (5.6) as a system of index 1, which keeps the constraint and its first two derivatives.

(5.6) has index 3: the multipliers appear in the second derivative of the constraint, and their differential equation
needs a third. Here the index is reduced by dummy derivatives: g = c, g' = 0 and g'' = 0 are all equations of the
system. In return, X_i and U_i = X_i' are algebraic unknowns, determined by g = c and g' = 0. Only y and v = y' are
integrated, so that integration errors cannot violate the constraint or its derivative. X_i'' is given by (5.6a).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.status import Status
from meanfield.forces import forces
from meanfield.model.symbolic import library

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from meanfield.model.model import Model

    Floats = NDArray[np.float64]

# Newton's method converges quadratically: after a correction of this relative size the next one is below rounding.
NEWTON_TOLERANCE = 1e-9
MAX_NEWTON_ITERATIONS = 20
# Largest entry of an effective mass (the mass of y alone is 1) up to which its condition number is not checked.
UNCHECKED_MASS = 1e12


class Accelerations(NamedTuple):
    """Accelerations X_i'' (N, nx) and y'' (ny,), and multipliers lambda_i (N, nx), of one state."""

    X: Floats
    y: Floats
    multipliers: Floats


def accelerations(model: Model, X: Floats, U: Floats, y: Floats, v: Floats) -> Accelerations:
    """Solve (5.6a), (5.6b) and g'' = 0 for the accelerations and multipliers, which enter linearly::

        m X_i'' = F1 + 1/N sum_k K(X_k, X_i) - g_X^T lambda_i
        y''     = F0 - 1/N sum_j g_y^T lambda_j
        0       = g_X X_i'' + g_y y'' + D^2 g[(U_i, v), (U_i, v)]

    Each lambda_i is eliminated as a function of y'', which leaves a system of size ny: O(N) operations.

    Raises
    ------
    StepFailure
        if dg/dX is singular or a force is not finite.
    """
    gX, gy = model.jacobians(X, y)
    force = model.F1(X) if model.V is None else model.F1(X) + forces(model, X, None)
    right = np.concatenate((model.curvature(X, y, U, v)[:, :, None], gy), axis=2)
    with np.errstate(all="ignore"):
        # lambda = fixed + slope y'' from (5.6a) and g'' = 0
        part = model.m * solve_blocks(gX, right)
        part[:, :, 0] += force
        part = solve_blocks(gX.transpose(0, 2, 1), part)
        fixed, slope = part[:, :, 0], part[:, :, 1:]
        matrix = np.eye(model.ny) + np.einsum("jik,jil->kl", gy, slope) / len(X)
        w = solve_mass(matrix, model.F0(y) - np.einsum("jik,ji->k", gy, fixed) / len(X))
        multipliers = fixed + slope @ w
        found = (force - np.einsum("jik,ji->jk", gX, multipliers)) / model.m
    if not (np.isfinite(found).all() and np.isfinite(w).all()):
        raise StepFailure(Status.NON_FINITE, "The accelerations are not finite.")
    return Accelerations(found, w, multipliers)


def consistent_values(model: Model, X: Floats, y: Floats, v: Floats, level: Floats) -> tuple[Floats, Floats]:
    """Solve g(X_i, y) = level_i for X near the given X, to rounding, and g_X U_i + g_y v = 0 for U: shapes (N, nx).

    Raises
    ------
    StepFailure
        if Newton's method does not converge.
    """
    for _ in range(MAX_NEWTON_ITERATIONS):
        gX, _ = model.jacobians(X, y)
        step = solve_blocks(gX, (level - model.level(X, y))[:, :, None])[:, :, 0]
        X = X + step
        if np.abs(step).max() <= NEWTON_TOLERANCE * (1 + np.abs(X).max()):
            gX, gy = model.jacobians(X, y)
            return X, -solve_blocks(gX, (gy @ v)[:, :, None])[:, :, 0]
    raise StepFailure(Status.NOT_CONVERGED, "No positions that satisfy the constraint were found near the start.")


def solve_mass(mass: Floats, force: Floats) -> Floats:
    """Compute mass^{-1} force for a mass (n, n) and a force (n,); NaN if not finite or too ill-conditioned.

    An effective mass is the identity plus a positive semidefinite matrix. If that matrix is about 1e14 in one direction
    and zero in another, the identity is lost to rounding.
    """
    if np.isfinite(mass).all() and np.isfinite(force).all():
        try:
            if np.abs(mass).max() < UNCHECKED_MASS or np.linalg.cond(mass) < 100 * UNCHECKED_MASS:
                return np.asarray(np.linalg.solve(mass, force))
        except np.linalg.LinAlgError:
            pass
    return np.full_like(force, np.nan)


def solve_blocks(matrices: Floats, right: Floats) -> Floats:
    """Solve one small system per particle, (N, n, n) with (N, n, k); StepFailure if one is singular."""
    try:
        with np.errstate(all="ignore"):
            found = right / matrices if matrices.shape[1] == 1 else np.linalg.solve(matrices, right)
    except np.linalg.LinAlgError:
        found = np.full_like(right, np.nan)
    if not np.isfinite(found).all():
        raise StepFailure(Status.SINGULAR, "dg/dX of a particle is singular.")
    return np.asarray(found)


def index_one_system(
    model: Model, level: Floats, determinants: Floats, least: float, duration: float
) -> dict[str, Any]:
    """Build (5.6) with g = level, g' = 0 and g'' = 0 for CasADi's integrator, in the time t/duration.

    Differential unknowns are (y, v), algebraic ones X, U, lambda of all particles, y'' and s_1 ... s_N.
    The sum of (5.6b) is a chain s_j = s_{j-1} + g_y(X_j, y)^T lambda_j / N, which keeps all rows of the Newton matrix
    short. With a plain sum, one row depends on all particles, and the matrix takes N differentiations instead
    of a few. The quadrature counts the particles for which (5.5) may be violated near by: the ratio of det g_X to its
    value at the start, ``determinants`` (N,), is below ``least`` or above its inverse.
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
        "quad": ca.sum2(ca.logic_or(ratio <= least, ratio >= 1 / least)),
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
