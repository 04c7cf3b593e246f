"""Mean and second moment of the particles, where they close the equations (Remark 5.20).

A few points with the moments of a density move like the density.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import describe, flag, instance, items, shaped
from dincl.errors import InvalidProblem
from meanfield.model.model import Model
from meanfield.model.state import State
from meanfield.model.symbolic import is_affine
from meanfield.solvers.ode import solve_ode
from meanfield.solvers.result import Motion, delivered

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats

# A covariance may be negative by rounding, relative to the second moment.
MOMENT_ROUNDING = 1e-12


class NotClosed(InvalidProblem):
    """Moment equations that do not close for the model; the message says why."""


class Moments(NamedTuple):
    """Mean rho = int x f dx (nx,) and second moment sigma = int x x^T f dx (nx, nx), not centred."""

    mean: Floats
    second: Floats


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


@dataclass(frozen=True, eq=False, repr=False)
class MomentMotion(Motion):
    """Motion of 2 nx points of equal weight that have the moments rho (K, nx) and sigma (K, nx, nx) of the density."""

    @property
    def mean(self) -> Floats:
        """rho (K, nx)."""
        return np.asarray(self.X.mean(axis=1))

    @property
    def second(self) -> Floats:
        """sigma (K, nx, nx), not centred."""
        return np.asarray(self.X.swapaxes(1, 2) @ self.X / self.X.shape[1])

    def _size(self) -> str:
        return f"nx = {self.model.nx}"


def solve_moments(
    model: Model, moments0: Moments, y0: ArrayLike, v0: ArrayLike, t: ArrayLike, tol: float, *, throw: bool = True
) -> MomentMotion:
    """Solve for y and the first two moments, with Phi(x, y)[v] = A(y, v) x + b(y, v)::

        m_eff(rho, sigma, y) y'' = F_eff(rho, sigma, y, y')
        rho'   = A rho + b                                     (the blank of (5.69))
        sigma' = A sigma + sigma A^T + b rho^T + rho b^T

    The last two equations follow from (5.42b), multiplied by x and x x^T and integrated by parts: d/dt int h f dx =
    int (grad h . Phi[y']) f dx. They hold for every shape of f, hence for 2 nx points with the moments of the density,
    which are moved by the integrator of ``solve_ode``: all integrands are polynomials of degree two in x.

    Parameters
    ----------
    moments0
        mean (nx,) and second moment (nx, nx) of the initial density.
    y0, v0, t, tol, throw
        as for ``solve_ode``.

    Raises
    ------
    NotClosed
        if Phi, Omega or F1 is not affine in x, or K is not linear in x' - x: higher moments would be needed.
    InvalidProblem
        if an argument is invalid.
    SolveFailed
        if the run ends early.

    Source: Remark 5.20, (5.67)-(5.69).
    """
    instance("model", model, Model, "a meanfield.Model")
    raises = flag("throw", throw)
    if obstacle(model) is not None:
        raise NotClosed(f"the moment equations of the model do not close: {obstacle(model)}")
    mean, second = _checked(model, moments0)
    # Two points along each principal axis: the mean plus and minus sqrt(nx) deviations.
    values, axes = np.linalg.eigh(second - np.outer(mean, mean))
    arms = (axes * np.sqrt(np.maximum(values, 0.0) * len(mean))).T
    X = np.vstack([mean + arms, mean - arms])
    start = State(X=X, y=shaped("y0", y0, (model.ny,)), v=shaped("v0", v0, (model.ny,)))
    return delivered(MomentMotion(**vars(solve_ode(model, start, t, tol, throw=False))), raises)


def _checked(model: Model, moments: Moments) -> Moments:
    """Return moments as arrays; InvalidProblem unless a measure has these moments."""
    given = items("moments0", moments, object, "Moments(mean, second)")
    if len(given) != len(Moments._fields):
        raise InvalidProblem(f"moments0 = {describe(moments)}: must be Moments(mean, second)")
    mean = shaped("moments0.mean", given[0], (model.nx,))
    second = shaped("moments0.second", given[1], (model.nx, model.nx))
    least = np.linalg.eigvalsh(second - np.outer(mean, mean)).min()
    slack = MOMENT_ROUNDING * np.abs(second).max()
    if np.abs(second - second.T).max() > slack or least < -slack:
        raise InvalidProblem(
            f"moments0.second = {second.tolist()}: must be symmetric, and second - mean mean^T, of least eigenvalue "
            f"{least:.3g}, must be >= 0"
        )
    return Moments(mean, (second + second.T) / 2)
