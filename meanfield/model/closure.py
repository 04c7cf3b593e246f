"""Models whose effective mass and force depend on the particles through their first two moments only."""

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
    """What moments rho = int x f dx (nx,) and sigma = int x x^T f dx (nx, nx) decide, as functions of arrays.

    ``shares`` of (rho, sigma, y, v): the elements of m int Phi^T Phi, column by column, then of
    int Phi^T (F1 + K - m Omega[v, v]); ``flow`` of (y, v): those of A (nx, nx) and b (nx,) in Phi(x, y)[v] = A x + b.
    """

    shares: Callable[..., list[NDArray[np.float64]]]
    flow: Callable[..., list[NDArray[np.float64]]]


def obstacle(model: Model) -> str | None:
    """What keeps the moments from closing, None if they do: Phi, F1 and Omega must be affine in X, K linear in r.

    The question is put to the expressions: one that is affine, but so written that its second derivative does not
    cancel, counts as not affine.
    """
    e = model.expressions
    for name, meaning in (("phi", "Phi"), ("F1", "F1"), ("omega", "Omega")):
        if not is_affine(getattr(e, name), e.X):
            return f"{meaning} is not affine in X"
    return None if is_affine(e.K, e.r) else "K is not linear in X_k - X_i"


@lru_cache(maxsize=256)
def closure(model: Model) -> MomentClosure | None:
    """The functions of the moments, None if they do not close.

    Since the integrands are polynomials q of second degree, int q f dx = q(0) + q'(0) rho + q''(0) : sigma / 2; the
    force of all others upon a particle is K(rho - X), K being linear.

    Source: Remark 5.20, whose (5.69) is left open: rho' = A rho + b, sigma' = A sigma + sigma A^T + b rho^T + rho b^T.
    """
    if obstacle(model) is not None:
        return None
    ca = library()
    e = model.expressions
    rho, sigma = ca.SX.sym("rho", model.nx), ca.SX.sym("sigma", model.nx * model.nx)
    pull = ca.substitute(e.K, e.r, rho - e.X)
    force = ca.mtimes(e.phi.T, e.F1 + pull - model.m * e.omega)
    integrands = ca.vertcat(ca.vec(model.m * ca.mtimes(e.phi.T, e.phi)), force)
    shares = program([rho, sigma, e.y, e.v], [_expected(integrands, e.X, rho, sigma)])
    flow = ca.mtimes(e.phi, e.v)
    slope = ca.jacobian(flow, e.X)
    constant = ca.substitute(flow, e.X, ca.SX.zeros(model.nx))
    return MomentClosure(
        vectorised(shares, ["rho", "sigma", "y", "v"], [False] * 4),
        vectorised(program([e.y, e.v], [ca.vec(slope), constant]), ["y", "v"], [False] * 2),
    )


def is_affine(expression: Any, symbols: Any) -> bool:
    """Whether the second derivative of an expression visibly vanishes."""
    ca = library()
    return bool(ca.jacobian(ca.jacobian(ca.vec(expression), symbols), symbols).nnz() == 0)


def _expected(polynomials: Any, X: Any, rho: Any, sigma: Any) -> Any:
    """Expectations of polynomials of second degree in X, as expressions in the moments."""
    ca = library()
    n = X.numel()
    slope = ca.jacobian(polynomials, X)
    bend = ca.jacobian(ca.vec(slope), X)
    at_zero = ca.substitute(ca.horzcat(polynomials, slope), X, ca.SX.zeros(n))
    # bend holds d^2 q_i/(dx_a dx_b) in row i + a rows, column b.
    curved = ca.reshape(ca.densify(bend), polynomials.numel(), n * n)
    return at_zero[:, 0] + ca.mtimes(at_zero[:, 1:], rho) + ca.mtimes(curved, sigma) / 2
