"""Forces and energy of all pairs: by the mean where V is quadratic, by interpolation on a line, by direct sum.

K is antisymmetric, so that K(0) = 0 and sums may run over all pairs, a particle with itself too.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.status import Status
from meanfield.forces.chebyshev import Interpolant, line
from meanfield.forces.loop import summed
from meanfield.forces.weights import each
from meanfield.model.closure import is_affine
from meanfield.model.symbolic import library, program

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.model import Model

# From this many particles on interpolation is tried; below, the direct sum is as fast.
MANY = 200
# Below this many particles a loop is not worth compiling.
FEW = 64
_NONE = np.zeros((0, 0))


def forces(model: Model, X: NDArray[np.float64], weights: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """sum_k w_k K(X_k, X_i) for each particle i, K(X_k, X_i) = grad V(X_k - X_i), exact to rounding on each way.

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
    w = each(weights, len(X))
    if is_quadratic(model):
        return model.K(w @ X - X)
    smooth = _line(model, X)
    found = _direct(model, "K", X, w) if smooth is None else smooth.summed(_on_line(model.K), X[:, 0], w)[:, None]
    if not np.isfinite(found).all():
        raise StepFailure(Status.NON_FINITE, "The force of a pair of particles is not finite.")
    return found


def pair_energy(model: Model, X: NDArray[np.float64], weights: NDArray[np.float64] | None) -> float:
    """sum_ik w_i w_k V(X_k - X_i): twice the energy of the pairs in (5.37)."""
    w = each(weights, len(X))
    if is_quadratic(model):
        # The mean over pairs of a quadratic form is twice that of the deviations from the mean.
        return 2 * float(w @ model.pair_energy(X - w @ X))
    smooth = _line(model, X)
    if smooth is None:
        return float(w @ _direct(model, "V", X, w)[:, 0])
    return float(w @ smooth.summed(_on_line(model.pair_energy), X[:, 0], w))


@lru_cache(maxsize=256)
def is_quadratic(model: Model) -> bool:
    """Whether V is a quadratic form, so that the others act upon a particle as if all were at their mean."""
    return is_affine(model.expressions.K, model.expressions.r)


def _line(model: Model, X: NDArray[np.float64]) -> Interpolant | None:
    """The line on which V and K are smooth to rounding, if that is where the particles are."""
    if model.nx > 1 or len(X) < MANY:
        return None
    return line((_on_line(model.K), _on_line(model.pair_energy)), X[:, 0])


def _on_line(kernel: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Callable[..., NDArray[np.float64]]:
    return lambda s: kernel(np.asarray(s)[:, None]).ravel()


def _direct(model: Model, name: str, X: NDArray[np.float64], w: NDArray[np.float64]) -> NDArray[np.float64]:
    """sum_k w_k of K or V of X_k - X_i for each i: compiled for many particles, by NumPy for few."""
    if len(X) < FEW:
        pairs = (X - X[:, None]).reshape(-1, X.shape[1])
        found = model.K(pairs) if name == "K" else model.pair_energy(pairs)
        return np.asarray(w @ found.reshape(len(X), len(X), -1))
    kernel = _one(model, name)
    with np.errstate(all="ignore"):
        return np.array([kernel(X, _NONE, w, x, x, _NONE) for x in X])


@lru_cache(maxsize=256)
def _one(model: Model, name: str) -> Callable[..., NDArray[np.float64]]:
    """A compiled sum over all particles of K or V of their distance from one."""
    ca = library()
    e = model.expressions
    one, unused = ca.SX.sym("one", model.nx), ca.SX.sym("unused", model.nx)
    value = ca.substitute(getattr(e, name), e.r, e.X - one)
    return summed(program([e.X, one, unused], [value]), 0, pulled=False, weighted=True, signed=False)
