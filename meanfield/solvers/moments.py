"""Moment equations of models for which they close: a few unknowns for any number of particles (Remark 5.20)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe, flag, items, shaped
from dincl.errors import InvalidProblem
from meanfield.errors import NotClosed
from meanfield.model.reduction import Moments, obstacle, points
from meanfield.model.state import State
from meanfield.solvers.arguments import check_model
from meanfield.solvers.ode import solve_weighted
from meanfield.solvers.result import Motion, delivered

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model

    Floats = NDArray[np.float64]

# A covariance may be negative by rounding, relative to the second moment.
MOMENT_ROUNDING = 1e-12


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

    def _measures(self) -> dict[str, Floats]:
        spread = self.X.std(axis=1)
        columns = {f"mean{k + 1}": self.mean[:, k] for k in range(self.model.nx)}
        return columns | {f"deviation{k + 1}": spread[:, k] for k in range(self.model.nx)}

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
    check_model(model)
    raises = flag("throw", throw)
    if obstacle(model) is not None:
        raise NotClosed(f"the moment equations of the model do not close: {obstacle(model)}")
    X = points(_checked(model, moments0))
    start = State(X=X, y=shaped("y0", y0, (model.ny,)), v=shaped("v0", v0, (model.ny,)))
    motion = solve_weighted(model, start, None, t, tol, throw=False)
    return delivered(MomentMotion(**vars(motion)), raises)


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
