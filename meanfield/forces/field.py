"""The effective mass and force of a measure of particles: one pass over them."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from meanfield.forces.interaction import FEW, forces
from meanfield.forces.loop import summed
from meanfield.forces.weights import each
from meanfield.model.closure import closure
from meanfield.model.symbolic import library, program
from meanfield.model.translate import vectorised

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.model import Model
    from meanfield.model.symbolic import Expressions

_NONE = np.zeros((0, 0))
# A mass of y, where that of y alone is 1, up to which its condition need not be looked at.
HEAVY = 1e12


class Field(NamedTuple):
    """What a measure of particles does to y, and y to the particles.

    mass = I + m int Phi^T Phi (5.13), force = F0 + int Phi^T (F1 + K - m Omega[v, v]) (5.14), U_i = Phi_i v (5.9);
    ``orientation`` is the mean of the signs of det dg/dX: +1 or -1 as long as (5.5) holds along one motion.
    """

    mass: NDArray[np.float64]
    force: NDArray[np.float64]
    U: NDArray[np.float64]
    orientation: float

    def acceleration(self) -> NDArray[np.float64]:
        """y'' from (5.11a): mass^{-1} force, NaN where there is none."""
        return accelerated(self.mass, self.force)


def accelerated(mass: NDArray[np.float64], force: NDArray[np.float64]) -> NDArray[np.float64]:
    """mass^{-1} force for a mass (n, n) and a force (n,); NaN where one is not finite, or rounding decides.

    An effective mass is the identity and a part that is positive semidefinite. Where that part is some 1e14 times
    larger in one direction and vanishes in another, its rounding hides the identity.
    """
    if np.isfinite(mass).all() and np.isfinite(force).all():
        try:
            if np.abs(mass).max() < HEAVY or np.linalg.cond(mass) < 100 * HEAVY:
                return np.asarray(np.linalg.solve(mass, force))
        except np.linalg.LinAlgError:
            pass
    return np.full_like(force, np.nan)


def field(
    model: Model,
    X: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    y: NDArray[np.float64],
    v: NDArray[np.float64],
) -> Field:
    """Effective mass and force, in one compiled pass over the particles (and those of ``forces`` with interaction).

    Where moments close, the pass adds up the moments only. A few particles are left to NumPy, which compiles nothing.

    Parameters
    ----------
    X, weights
        positions (Q, nx) and their weights (Q,) that sum to 1; None: 1/Q each.

    Returns
    -------
    Field
        whose numbers may be infinite or NaN where the model is singular: callers look.

    Source: (5.13)-(5.17), (5.41).
    """
    if len(X) < FEW:
        return field_by_numpy(model, X, weights, y, v)
    closed = closure(model)
    pull = _NONE if model.V is None or closed else forces(model, X, weights)
    U = np.empty_like(X)
    kernel = _kernel(model, weighted=weights is not None)
    with np.errstate(all="ignore"):
        sums = kernel(X, pull, _NONE if weights is None else weights, y, v, U)
        if closed:
            rho, sigma = sums[: model.nx], sums[model.nx : -1]
            sums = np.array([*closed.shares(rho, sigma, y, v), sums[-1]])
        return _assembled(model, sums, U, y)


def field_by_numpy(
    model: Model,
    X: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    y: NDArray[np.float64],
    v: NDArray[np.float64],
) -> Field:
    """The twin of ``field`` in NumPy, which adds up each particle's share as (5.13), (5.14) say; equal to rounding."""
    values = [X, y, v] if model.V is None else [X, forces(model, X, weights), y, v]
    w = each(weights, len(X))
    with np.errstate(all="ignore"):
        elements = [np.broadcast_to(element, len(X)) for element in _shares(model)(*values)]
        sums = np.array([*(w @ element for element in elements[model.nx : -1]), elements[-1].mean()])
        return _assembled(model, sums, np.column_stack(elements[: model.nx]), y)


def _pass(model: Model) -> tuple[list[Any], list[Any]]:
    """The symbols a particle's share is of, and its velocity and shares: m Phi^T Phi, Phi^T (...), sign of det."""
    ca = library()
    e: Expressions = model.expressions
    P = ca.SX.sym("P", model.nx)
    pulled = model.V is not None
    force = e.F1 - model.m * e.omega + (P if pulled else 0)
    shares = [model.m * ca.mtimes(e.phi.T, e.phi), ca.mtimes(e.phi.T, force), ca.sign(e.determinant)]
    flow = ca.mtimes(e.phi, e.v)
    return [e.X, P, e.y, e.v] if pulled else [e.X, e.y, e.v], [flow, *shares]


@lru_cache(maxsize=256)
def _shares(model: Model) -> Callable[..., list[NDArray[np.float64]]]:
    symbols, outputs = _pass(model)
    names = ["X", "P", "y", "v"] if model.V is not None else ["X", "y", "v"]
    return vectorised(program(symbols, outputs), names, [name in ("X", "P") for name in names])


@lru_cache(maxsize=256)
def _kernel(model: Model, *, weighted: bool) -> Callable[..., NDArray[np.float64]]:
    if closure(model) is None:
        symbols, outputs = _pass(model)
        return summed(program(symbols, outputs), model.nx, pulled=model.V is not None, weighted=weighted, signed=True)
    ca = library()
    e = model.expressions
    outputs = [ca.mtimes(e.phi, e.v), e.X, ca.vec(ca.mtimes(e.X, e.X.T)), ca.sign(e.determinant)]
    return summed(program([e.X, e.y, e.v], outputs), model.nx, pulled=False, weighted=weighted, signed=True)


def _assembled(model: Model, sums: NDArray[np.float64], U: NDArray[np.float64], y: NDArray[np.float64]) -> Field:
    ny = model.ny
    mass = np.eye(ny) + sums[: ny * ny].reshape(ny, ny)
    return Field(mass, model.F0(y) + sums[ny * ny : -1], U, float(sums[-1]))
