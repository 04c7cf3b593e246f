"""The arguments of the solvers, checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl import checks
from dincl.errors import InvalidProblem
from meanfield.density.density import Density
from meanfield.model.model import Model
from meanfield.model.state import State

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


# Tolerances of the integrators: below, rounding decides; above, nothing is computed.
TIGHTEST, LOOSEST = 1e-13, 1e-1


def model_given(value: Any) -> None:
    """A Model, or InvalidProblem."""
    checks.instance("model", value, Model, "a meanfield.Model")


def state_given(value: Any) -> None:
    """A State, or InvalidProblem."""
    checks.instance("start", value, State, "a meanfield.State")


def density_given(value: Any) -> None:
    """A Density, or InvalidProblem."""
    checks.instance("density", value, Density, "a meanfield.Density")


def times(value: ArrayLike) -> NDArray[np.float64]:
    """Times to keep, >= 0 and increasing, of shape (K,); a run starts at 0 and ends at the last one, which is > 0."""
    t = checks.shaped("t", value, (None,))
    if t[0] < 0 or (np.diff(t) <= 0).any() or t[-1] == 0:
        raise InvalidProblem(f"t = {checks.describe(t)}: must be increasing times >= 0, the last one > 0")
    return t


def tolerance(value: Any) -> float:
    """A tolerance that double precision can keep."""
    tol = checks.number("tol", value, positive=True)
    if not TIGHTEST <= tol <= LOOSEST:
        raise InvalidProblem(f"tol = {tol:g}: must be from {TIGHTEST:g} to {LOOSEST:g}")
    return tol


def checked_start(
    model: Model, density: Density, y0: ArrayLike, v0: ArrayLike, t: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """y0, v0 (ny,) and the times to keep (K,), for a density over the space of the model's particles.

    Raises
    ------
    InvalidProblem
        if one of them cannot be right.
    """
    model_given(model)
    density_given(density)
    if density.nx != model.nx:
        raise InvalidProblem(f"density has nx = {density.nx}: must be {model.nx}, that of the model")
    y, v = checks.shaped("y0", y0, (model.ny,)), checks.shaped("v0", v0, (model.ny,))
    return y, v, times(t)
