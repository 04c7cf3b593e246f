"""Reductions of a model: which unknowns follow from y in closed form, and from which moments."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import instance, shaped
from dincl.errors import InvalidProblem
from meanfield.model.model import Model
from meanfield.model.symbolic import depends, is_affine, library, program

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.kernels.program import Program

    Floats = NDArray[np.float64]

# Weights that come from a sum of many terms may miss 1 by this much.
SUM_TOLERANCE = 1e-10


class Positions(Enum):
    """Relation between the particles and y; ``value`` states it in a sentence."""

    SHIFT = "Phi = G is constant: X_i(t) = X_i(0) + G (y(t) - y(0))."
    AFFINE = "g is affine in X: X_i(t) = B(y)^{-1} (c_i - b(y)) with g = B(y) X + b(y)."
    FLOW = "g is not affine in X: the particles must be integrated, X_i' = Phi(X_i, y) y'."


@dataclass(frozen=True, eq=False)
class Reduction:
    """Reduction of a model to the unknowns that must be integrated.

    ``positions`` states how the particles follow from y. ``obstacle`` states why effective mass and force are not
    functions of the first two moments, None if they are. With positions in closed form, ``solve_ode`` integrates 2 ny
    unknowns; if the moment equations close too, the cost of a step does not depend on the number of particles.

    Source: after (5.31); Remark 5.20.
    """

    model: Model
    positions: Positions
    obstacle: str | None


def reduce(model: Model) -> Reduction:
    """Find the reduction that holds for a model; see its ``positions`` and ``obstacle``.

    Reductions are found from the expressions of the model. A reduction that is found holds; one that depends on terms
    that do not cancel symbolically may be missed.

    Raises
    ------
    InvalidProblem
        if the argument is no Model.
    """
    instance("model", model, Model, "a meanfield.Model")
    ca, e = library(), model.expressions
    if model.jacobian_varies:
        positions = Positions.FLOW
    elif not depends(e.phi, ca.vertcat(e.X, e.y)):
        positions = Positions.SHIFT
    else:
        positions = Positions.AFFINE
    return Reduction(model, positions, obstacle(model))


@lru_cache(maxsize=256)
def obstacle(model: Model) -> str | None:
    """Return why the moment equations do not close, or None if they close.

    They close if Phi, F1 and Omega are affine in X and K is linear in r: the integrands of (5.13) and (5.14) are then
    polynomials of second degree. This is decided from the expressions: an affine expression whose second derivative
    does not cancel symbolically counts as not affine.
    """
    e = model.expressions
    for name, meaning in (("phi", "Phi"), ("F1", "F1"), ("omega", "Omega")):
        if not is_affine(getattr(e, name), e.X):
            return f"{meaning} is not affine in X"
    return None if is_affine(e.K, e.r) else "K is not linear in X_k - X_i"


@lru_cache(maxsize=256)
def positions_in_closed_form(model: Model) -> Program:
    """Build X = B(y)^{-1} (c - b(y)) as a program of the constants c and y; meaningful if g = B(y) X + b(y)."""
    ca, e = library(), model.expressions
    c = ca.SX.sym("c", model.nx)
    at_zero = ca.substitute(ca.horzcat(e.gX, e.level), e.X, ca.SX.zeros(model.nx))
    B, b = at_zero[:, : model.nx], at_zero[:, model.nx]
    return program(c, ca.SX(0, 1), e.y, [ca.mtimes(ca.inv_minor(B), c - b)])


class Moments(NamedTuple):
    """Mean rho = int x f dx (nx,) and second moment sigma = int x x^T f dx (nx, nx), not centred."""

    mean: NDArray[np.float64]
    second: NDArray[np.float64]


def sample_moments(X: ArrayLike, weights: ArrayLike | None) -> Moments:
    """Compute the moments of particles (N, nx) with weights (N,) that sum to 1; None: 1/N each.

    Raises
    ------
    InvalidProblem
        if X has another shape or is not finite, or weights are negative or do not sum to 1.
    """
    x = shaped("X", X, (None, None))
    w = np.full(len(x), 1 / len(x)) if weights is None else checked_weights("weights", weights, len(x))
    return Moments(w @ x, (x * w[:, None]).T @ x)


def points(moments: Moments) -> Floats:
    """Construct 2 nx points of equal weight with given moments: mean plus and minus sqrt(nx) principal deviations."""
    mean, second = moments
    values, axes = np.linalg.eigh(second - np.outer(mean, mean))
    arms = (axes * np.sqrt(np.maximum(values, 0.0) * len(mean))).T
    return np.vstack([mean + arms, mean - arms])


def represented(model: Model, level: Floats, weights: Floats | None) -> tuple[Floats, Floats | None]:
    """Return few constants c_i with the moments of the given ones, if y depends on the moments alone.

    X is affine in the constants, so that these give the moments of all particles.
    """
    if obstacle(model) is not None:
        return level, weights
    return points(sample_moments(level, weights)), None


def checked_weights(name: str, value: ArrayLike, count: int) -> Floats:
    """Return a user's weights as an array of shape (count,); InvalidProblem unless >= 0 with the sum 1 to 1e-10."""
    weights = shaped(name, value, (count,))
    if (weights < 0).any() or abs(weights.sum() - 1.0) > SUM_TOLERANCE:
        found = f"least {weights.min():.3g}, sum {weights.sum():.12g}"
        raise InvalidProblem(f"{name} ({found}): must be >= 0 and sum to 1")
    return weights
