"""Checks of the arguments that solvers share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl import checks
from dincl.errors import InvalidProblem
from meanfield.density.density import Density
from meanfield.model.model import Model
from meanfield.model.state import FullState, State

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


# Range of tolerances: below, rounding exceeds the tolerance; above, results have no correct digit.
TIGHTEST, LOOSEST = 1e-13, 1e-1


def check_model(value: Any) -> None:
    """Raise InvalidProblem unless the argument is a Model."""
    checks.instance("model", value, Model, "a meanfield.Model")


def check_density(value: Any) -> None:
    """Raise InvalidProblem unless the argument is a Density."""
    checks.instance("density", value, Density, "a meanfield.Density")


def output_times(value: ArrayLike) -> NDArray[np.float64]:
    """Return the output times (K,); InvalidProblem unless they are >= 0 and increasing, and the last one > 0."""
    t = checks.times("t", value)
    if t[-1] == 0:
        raise InvalidProblem(f"t = {checks.describe(value)}: must be increasing times >= 0, the last one > 0")
    return t


def tolerance(value: Any) -> float:
    """Return a tolerance; InvalidProblem unless it is from 1e-13 to 0.1."""
    tol = checks.number("tol", value, positive=True)
    if not TIGHTEST <= tol <= LOOSEST:
        raise InvalidProblem(f"tol = {tol:g}: must be from {TIGHTEST:g} to {LOOSEST:g}")
    return tol


def particles_and_times(model: Model, start: State, t: ArrayLike, tol: float) -> tuple[FullState, NDArray[np.float64]]:
    """Return the complete state from which particles start, which may miss the constraint by 10 tol, and times (K,).

    Raises
    ------
    InvalidProblem
        if an argument is invalid, or the state does not fit the model.
    """
    check_model(model)
    checks.instance("start", start, State, "a meanfield.State")
    times = output_times(t)
    return start.complete(model, tol), times


def checked_start(
    model: Model, density: Density, y0: ArrayLike, v0: ArrayLike, t: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return y0, v0 (ny,) and the output times (K,) of a run from a density.

    Raises
    ------
    InvalidProblem
        if an argument is invalid, or the dimensions of density and model differ.
    """
    check_model(model)
    check_density(density)
    if density.nx != model.nx:
        raise InvalidProblem(f"density has nx = {density.nx}: must be {model.nx}, as in the model")
    y, v = checks.shaped("y0", y0, (model.ny,)), checks.shaped("v0", v0, (model.ny,))
    return y, v, output_times(t)
