"""Closure of the moment equations: models whose effective mass and force depend on two moments only."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

from meanfield.model.symbolic import library, program
from meanfield.model.translate import vectorised

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from meanfield.model.model import Model


class MomentClosure(NamedTuple):
    """Right-hand side of the moment equations as functions of arrays.

    The moments are rho = int x f dx (nx,) and sigma = int x x^T f dx (nx, nx).

    ``integrals`` maps (rho, sigma, y, v) to the elements of m int Phi^T Phi, column by column, followed by the elements
    of int Phi^T (F1 + K - m Omega[v, v]). ``flow`` maps (y, v) to the elements of A (nx, nx), column by column, and
    b (nx,) in Phi(x, y)[v] = A x + b.
    """

    integrals: Callable[..., list[NDArray[np.float64]]]
    flow: Callable[..., list[NDArray[np.float64]]]


def obstacle(model: Model) -> str | None:
    """Return why the moment equations do not close, or None if they close.

    They close if Phi, F1 and Omega are affine in X and K is linear in r. This is decided from the expressions: an
    affine expression whose second derivative does not cancel symbolically counts as not affine.
    """
    e = model.expressions
    for name, meaning in (("phi", "Phi"), ("F1", "F1"), ("omega", "Omega")):
        if not is_affine(getattr(e, name), e.X):
            return f"{meaning} is not affine in X"
    return None if is_affine(e.K, e.r) else "K is not linear in X_k - X_i"


@lru_cache(maxsize=256)
def closure(model: Model) -> MomentClosure | None:
    """Build the right-hand side of the moment equations; None if they do not close.

    The integrands are polynomials q of second degree, so int q f dx = q(0) + q'(0) rho + q''(0) : sigma / 2. Since K is
    linear, the interaction force on a particle at X is K(rho - X).

    Source: Remark 5.20, whose (5.69) is left open: rho' = A rho + b, sigma' = A sigma + sigma A^T + b rho^T + rho b^T.
    """
    if obstacle(model) is not None:
        return None
    ca = library()
    e = model.expressions
    rho, sigma = ca.SX.sym("rho", model.nx), ca.SX.sym("sigma", model.nx * model.nx)
    interaction = ca.substitute(e.K, e.r, rho - e.X)
    force = ca.mtimes(e.phi.T, e.F1 + interaction - model.m * e.omega)
    integrands = ca.vertcat(ca.vec(model.m * ca.mtimes(e.phi.T, e.phi)), force)
    integrals = program([rho, sigma, e.y, e.v], [_expectation(integrands, e.X, rho, sigma)])
    flow = ca.mtimes(e.phi, e.v)
    slope = ca.jacobian(flow, e.X)
    constant = ca.substitute(flow, e.X, ca.SX.zeros(model.nx))
    return MomentClosure(
        vectorised(integrals, ["rho", "sigma", "y", "v"], [False] * 4),
        vectorised(program([e.y, e.v], [ca.vec(slope), constant]), ["y", "v"], [False] * 2),
    )


def is_affine(expression: Any, symbols: Any) -> bool:
    """Return whether the second derivative of an expression vanishes symbolically."""
    ca = library()
    return bool(ca.jacobian(ca.jacobian(ca.vec(expression), symbols), symbols).nnz() == 0)


def _expectation(polynomials: Any, X: Any, rho: Any, sigma: Any) -> Any:
    """Express the expectations of polynomials of second degree in X by the moments."""
    ca = library()
    n = X.numel()
    slope = ca.jacobian(polynomials, X)
    hessian = ca.jacobian(ca.vec(slope), X)
    at_zero = ca.substitute(ca.horzcat(polynomials, slope), X, ca.SX.zeros(n))
    # d^2 q_i/(dx_a dx_b) is in column b of hessian, in row i + a times the number of polynomials.
    second = ca.reshape(ca.densify(hessian), polynomials.numel(), n * n)
    return at_zero[:, 0] + ca.mtimes(at_zero[:, 1:], rho) + ca.mtimes(second, sigma) / 2
