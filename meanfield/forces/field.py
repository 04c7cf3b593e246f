"""Effective mass and force of a measure of particles, in one pass over the particles."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from meanfield.forces.interaction import MIN_COMPILED, forces
from meanfield.forces.loop import compile_loop
from meanfield.model.closure import closure
from meanfield.model.symbolic import library, program
from meanfield.model.translate import vectorised
from meanfield.weights import full_weights

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.model import Model
    from meanfield.model.symbolic import Expressions

_NONE = np.zeros((0, 0))
# Largest entry of an effective mass (the mass of y alone is 1) up to which its condition number is not checked.
UNCHECKED_MASS = 1e12


class Field(NamedTuple):
    """Effective mass and force of a measure of particles, and the velocities of the particles.

    mass = I + m int Phi^T Phi (5.13), force = F0 + int Phi^T (F1 + K - m Omega[v, v]) (5.14), U_i = Phi_i v (5.9).
    ``orientation`` is the mean sign of det dg/dX: +1 or -1 while (5.5) holds along a motion.
    """

    mass: NDArray[np.float64]
    force: NDArray[np.float64]
    U: NDArray[np.float64]
    orientation: float

    def acceleration(self) -> NDArray[np.float64]:
        """Compute y'' = mass^{-1} force (5.11a); NaN if it is not determined."""
        return solve_mass(self.mass, self.force)


def solve_mass(mass: NDArray[np.float64], force: NDArray[np.float64]) -> NDArray[np.float64]:
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


def field(
    model: Model,
    X: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    y: NDArray[np.float64],
    v: NDArray[np.float64],
) -> Field:
    """Compute effective mass and force in one compiled pass over the particles, after ``forces`` with interaction.

    If the moment equations close, the pass sums the moments only. For fewer than 64 particles NumPy computes the same
    without compilation.

    Parameters
    ----------
    X, weights
        positions (Q, nx) and their weights (Q,) that sum to 1; None: 1/Q each.

    Returns
    -------
    Field
        its numbers may be infinite or NaN if the model is singular; callers must check.

    Source: (5.13)-(5.17), (5.41).
    """
    if len(X) < MIN_COMPILED:
        return field_by_numpy(model, X, weights, y, v)
    closed = closure(model)
    interaction = _NONE if model.V is None or closed else forces(model, X, weights)
    U = np.empty_like(X)
    kernel = _kernel(model, weighted=weights is not None)
    with np.errstate(all="ignore"):
        sums = kernel(X, interaction, _NONE if weights is None else weights, y, v, U)
        if closed:
            rho, sigma = sums[: model.nx], sums[model.nx : -1]
            sums = np.array([*closed.integrals(rho, sigma, y, v), sums[-1]])
        return _assemble(model, sums, U, y)


def field_by_numpy(
    model: Model,
    X: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    y: NDArray[np.float64],
    v: NDArray[np.float64],
) -> Field:
    """Compute the same as ``field`` to rounding, by NumPy, summing the integrands of (5.13), (5.14)."""
    values = [X, y, v] if model.V is None else [X, forces(model, X, weights), y, v]
    w = full_weights(weights, len(X))
    with np.errstate(all="ignore"):
        elements = [np.broadcast_to(element, len(X)) for element in _integrands(model)(*values)]
        sums = np.array([*(w @ element for element in elements[model.nx : -1]), elements[-1].mean()])
        return _assemble(model, sums, np.column_stack(elements[: model.nx]), y)


def _symbols_and_outputs(model: Model) -> tuple[list[Any], list[Any]]:
    """Return symbols of one particle, and its velocity, m Phi^T Phi, Phi^T (F1 + K - m Omega) and sign of det dg/dX."""
    ca = library()
    e: Expressions = model.expressions
    P = ca.SX.sym("P", model.nx)
    interacting = model.V is not None
    force = e.F1 - model.m * e.omega + (P if interacting else 0)
    integrands = [model.m * ca.mtimes(e.phi.T, e.phi), ca.mtimes(e.phi.T, force), ca.sign(e.determinant)]
    flow = ca.mtimes(e.phi, e.v)
    return [e.X, P, e.y, e.v] if interacting else [e.X, e.y, e.v], [flow, *integrands]


@lru_cache(maxsize=256)
def _integrands(model: Model) -> Callable[..., list[NDArray[np.float64]]]:
    symbols, outputs = _symbols_and_outputs(model)
    names = ["X", "P", "y", "v"] if model.V is not None else ["X", "y", "v"]
    return vectorised(program(symbols, outputs), names, [name in ("X", "P") for name in names])


@lru_cache(maxsize=256)
def _kernel(model: Model, *, weighted: bool) -> Callable[..., NDArray[np.float64]]:
    interacting = model.V is not None
    if closure(model) is None:
        operations = program(*_symbols_and_outputs(model))
        return compile_loop(operations, model.nx, interacting=interacting, weighted=weighted, plain_last=True)
    ca = library()
    e = model.expressions
    outputs = [ca.mtimes(e.phi, e.v), e.X, ca.vec(ca.mtimes(e.X, e.X.T)), ca.sign(e.determinant)]
    operations = program([e.X, e.y, e.v], outputs)
    return compile_loop(operations, model.nx, interacting=False, weighted=weighted, plain_last=True)


def _assemble(model: Model, sums: NDArray[np.float64], U: NDArray[np.float64], y: NDArray[np.float64]) -> Field:
    ny = model.ny
    mass = np.eye(ny) + sums[: ny * ny].reshape(ny, ny)
    return Field(mass, model.F0(y) + sums[ny * ny : -1], U, float(sums[-1]))
