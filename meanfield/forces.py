"""Measures of particles for compiled code, and forces and energy of all pairs.

K is antisymmetric, hence K(0) = 0, and sums may include the pairs of a particle with itself.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev

from dincl.errors import StepFailure
from dincl.status import Status
from meanfield.kernels.field import (
    BY_MEAN,
    BY_PAIRS,
    DEGREES,
    NONE,
    Measure,
    Pairs,
    rates_of,
    sums_over_pairs,
)
from meanfield.model.symbolic import is_affine, library, program

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats
    from meanfield.kernels.program import Program
    from meanfield.model.model import Model


def measure(model: Model, weights: Floats, orientation: float, blocks: int = 1) -> Measure:
    """Set up a measure of particles for compiled code, with a workspace of its own."""
    nx, ny, interaction = model.nx, model.ny, interaction_of(model)
    return Measure(
        program=_integrands(model).with_workspace(blocks),
        interaction=interaction,
        pairs=_pairs(model, "K"),
        orientation=orientation,
        weights=weights if weights.flags.writeable else weights.copy(),
        forces=np.empty((len(weights), nx if interaction == BY_PAIRS else 0)),
        inputs=np.empty(2 * ny + (nx if interaction == BY_MEAN else 0)),
        sums=np.empty(ny * ny + ny),
        mass=np.empty((ny, ny + 1)),
    )


@lru_cache(maxsize=256)
def interaction_of(model: Model) -> int:
    """Return how the particles interact; if V is a quadratic form, as if all of them were at their mean."""
    if model.V is None:
        return NONE
    return BY_MEAN if is_affine(model.expressions.K, model.expressions.r) else BY_PAIRS


@lru_cache(maxsize=256)
def _integrands(model: Model) -> Program:
    ca, e, interaction = library(), model.expressions, interaction_of(model)
    K, mean = (ca.SX.sym(name, model.nx if interaction == kind else 0) for name, kind in (("K", 2), ("mean", 1)))
    pull = {NONE: 0, BY_MEAN: ca.substitute(e.K, e.r, mean - e.X) if interaction == BY_MEAN else 0, BY_PAIRS: K}
    force = e.F1 - model.m * e.omega + pull[interaction]
    integrands = [model.m * ca.mtimes(e.phi.T, e.phi), ca.mtimes(e.phi.T, force)]
    outputs = [ca.mtimes(e.phi, e.v), *integrands, e.determinant, e.F0]
    return program(e.X, K, ca.vertcat(e.y, e.v, mean), outputs)


def _pairs(model: Model, name: str) -> Pairs:
    return Pairs(_pair_program(model, name).with_workspace(), _nodes(), np.empty((3, DEGREES[-1] + 1)))


@lru_cache(maxsize=256)
def _pair_program(model: Model, name: str) -> Program:
    ca, e = library(), model.expressions
    return program(e.r, ca.SX(0, 1), ca.SX(0, 1), [getattr(e, name)])


@cache
def _nodes() -> Floats:
    """Return T_j at the Chebyshev points of all degrees that may be used."""
    found = np.zeros((len(DEGREES), DEGREES[-1] + 1, DEGREES[-1] + 1))
    for level, degree in enumerate(DEGREES):
        found[level, : degree + 1, : degree + 1] = chebyshev.chebvander(chebyshev.chebpts1(degree + 1), degree)
    return found


def acceleration(model: Model, X: Floats, weights: Floats, y: Floats, v: Floats, orientation: float) -> Floats:
    """Compute y'' by (5.11a) of particles X (Q, nx) and (y, v); NaN if the effective mass is ill-conditioned."""
    m, found = measure(model, weights, orientation), np.empty(model.ny)
    rates_of(m, np.array(X, order="C"), np.concatenate([y, v]), np.empty(X.shape), found)
    return found


def forces(model: Model, X: Floats, weights: Floats) -> Floats:
    """Compute sum_k w_k K(X_k, X_i), K(X_k, X_i) = grad V(X_k - X_i), for each particle i, exact to rounding: (Q, nx).

    Raises
    ------
    StepFailure
        if a force is not finite.

    Source: (5.4), (5.6a).
    """
    if interaction_of(model) == BY_MEAN:
        return model.K(weights @ X - X)
    found = _sums(model, "K", X, weights)
    if not np.isfinite(found).all():
        raise StepFailure(Status.NON_FINITE, "The force of a pair of particles is not finite.")
    return found


def pair_energy(model: Model, X: Floats, weights: Floats) -> float:
    """Compute sum_ik w_i w_k V(X_k - X_i): twice the energy of the pairs in (5.37)."""
    if interaction_of(model) == BY_MEAN:
        # The mean of a quadratic form over pairs is twice its mean over the deviations from the mean.
        return 2 * float(weights @ model.pair_energy(X - weights @ X))
    return float(weights @ _sums(model, "V", X, weights)[:, 0])


def _sums(model: Model, name: str, X: Floats, w: Floats) -> Floats:
    found = np.empty((len(X), model.nx if name == "K" else 1))
    sums_over_pairs(_pairs(model, name), np.array(X, order="C"), np.array(w), found)
    return found
