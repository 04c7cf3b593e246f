"""Forces and energy of all pairs: by the mean if V is quadratic, by interpolation on a line, by direct sum otherwise.

K is antisymmetric, hence K(0) = 0, and sums may include the pairs of a particle with itself.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.status import Status
from meanfield.forces.chebyshev import Interpolant, interpolant
from meanfield.forces.loop import compile_loop
from meanfield.model.closure import is_affine
from meanfield.model.symbolic import library, program
from meanfield.weights import full_weights

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.model import Model

# Interpolation is tried from this many particles on; below, the direct sum is as fast.
MIN_INTERPOLATED = 200
# Loops are compiled from this many particles on; below, compiling takes longer than it saves.
MIN_COMPILED = 64
_NONE = np.zeros((0, 0))


def forces(model: Model, X: NDArray[np.float64], weights: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """Compute sum_k w_k K(X_k, X_i), K(X_k, X_i) = grad V(X_k - X_i), for each particle i, exact to rounding.

    Parameters
    ----------
    X, weights
        positions (Q, nx) and their weights (Q,) that sum to 1; None: 1/Q each.

    Returns
    -------
    array (Q, nx)

    Raises
    ------
    StepFailure
        if a force is not finite.

    Source: (5.4), (5.6a).
    """
    w = full_weights(weights, len(X))
    if is_quadratic(model):
        return model.K(w @ X - X)
    smooth = _interpolant(model, X)
    found = _direct(model, "K", X, w) if smooth is None else smooth.sum_pairs(_on_line(model.K), X[:, 0], w)[:, None]
    if not np.isfinite(found).all():
        raise StepFailure(Status.NON_FINITE, "The force of a pair of particles is not finite.")
    return found


def pair_energy(model: Model, X: NDArray[np.float64], weights: NDArray[np.float64] | None) -> float:
    """Compute sum_ik w_i w_k V(X_k - X_i): twice the energy of the pairs in (5.37)."""
    w = full_weights(weights, len(X))
    if is_quadratic(model):
        # The mean of a quadratic form over pairs is twice its mean over the deviations from the mean.
        return 2 * float(w @ model.pair_energy(X - w @ X))
    smooth = _interpolant(model, X)
    if smooth is None:
        return float(w @ _direct(model, "V", X, w)[:, 0])
    return float(w @ smooth.sum_pairs(_on_line(model.pair_energy), X[:, 0], w))


@lru_cache(maxsize=256)
def is_quadratic(model: Model) -> bool:
    """Return whether V is a quadratic form: the force on a particle is then that of all particles at their mean."""
    return is_affine(model.expressions.K, model.expressions.r)


def _interpolant(model: Model, X: NDArray[np.float64]) -> Interpolant | None:
    """Return an interpolation that resolves V and K to rounding; None if the particles are few or not on a line."""
    if model.nx > 1 or len(X) < MIN_INTERPOLATED:
        return None
    return interpolant((_on_line(model.K), _on_line(model.pair_energy)), X[:, 0])


def _on_line(kernel: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Callable[..., NDArray[np.float64]]:
    return lambda s: kernel(np.asarray(s)[:, None]).ravel()


def _direct(model: Model, name: str, X: NDArray[np.float64], w: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum w_k K(X_k - X_i) or w_k V(X_k - X_i) over k for each i: compiled for many particles, by NumPy for few."""
    if len(X) < MIN_COMPILED:
        pairs = (X - X[:, None]).reshape(-1, X.shape[1])
        found = model.K(pairs) if name == "K" else model.pair_energy(pairs)
        return np.asarray(w @ found.reshape(len(X), len(X), -1))
    kernel = _one(model, name)
    with np.errstate(all="ignore"):
        return np.array([kernel(X, _NONE, w, x, x, _NONE) for x in X])


@lru_cache(maxsize=256)
def _one(model: Model, name: str) -> Callable[..., NDArray[np.float64]]:
    """Compile the sum of K or V of X_k - x over all particles k, for one point x."""
    ca = library()
    e = model.expressions
    x, unused = ca.SX.sym("x", model.nx), ca.SX.sym("unused", model.nx)
    value = ca.substitute(getattr(e, name), e.r, e.X - x)
    operations = program([e.X, x, unused], [value])
    return compile_loop(operations, 0, interacting=False, weighted=True, plain_last=False)
