"""Time step of the mean-field PDE on a grid: third-order SSP Runge-Kutta for density, y and v together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.status import Status
from meanfield.forces.field import field
from meanfield.model.symbolic import library, program
from meanfield.model.translate import vectorised
from meanfield.solvers.grid.finite_volume import euler_step

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.model import Model
    from meanfield.solvers.grid.cells import CellGrid

# Each stage is a mean of the start of the step, with these weights, and an Euler step from the previous stage (Shu and
# Osher 1988). SLOPE_WEIGHTS are the resulting weights of the three slopes.
START_WEIGHTS = (0.0, 3 / 4, 1 / 3)
SLOPE_WEIGHTS = (1 / 6, 1 / 6, 2 / 3)
# Mass that the walls may hold back, or that may lie where the model is singular, before a run ends.
NEGLIGIBLE_MASS = 1e-8


class GridState(NamedTuple):
    """State on a grid: cell averages f (n0, n1), n1 = 1 for a grid of one axis, and y, v (ny,)."""

    f: NDArray[np.float64]
    y: NDArray[np.float64]
    v: NDArray[np.float64]


class Rate(NamedTuple):
    """Rate of change: speeds across the faces (n0 + 1, n1), (n0, n1 + 1), and y' = v, v' = a."""

    speeds: tuple[NDArray[np.float64], NDArray[np.float64]]
    v: NDArray[np.float64]
    a: NDArray[np.float64]


class Trial(NamedTuple):
    """Trial step: its result, the largest ``outflow`` fraction of a cell in a stage (above 1 the step is invalid), the
    mass that the walls ``blocked``, and estimated errors of y and v.
    """

    state: GridState
    outflow: float
    blocked: float
    error_y: float
    error_v: float


@dataclass(frozen=True, eq=False)
class GridSystem:
    """Model on a grid; ``orientation`` is the sign of det dg/dX at the start."""

    model: Model
    grid: CellGrid
    orientation: float

    def rate(self, z: GridState) -> Rate:
        """Evaluate (5.42) at a state; the integrals (5.41) are sums over cells of average times value at the midpoint.

        Raises
        ------
        StepFailure
            if a value is not finite, or det dg/dX has changed its sign where there is mass.
        """
        masses = (z.f * self.grid.volume).ravel()
        found = field(self.model, self.grid.centres, masses, z.y, z.v)
        if found.orientation != self.orientation:
            self._check_orientation(masses, z.y)
        a = found.acceleration()
        if not np.isfinite(a).all():
            raise StepFailure(Status.NON_FINITE, f"at y = {z.y}: the effective mass or force is not finite.")
        return Rate(self._speeds(z), z.v, a)

    def _check_orientation(self, masses: NDArray[np.float64], y: NDArray[np.float64]) -> None:
        """Check that cells where det dg/dX is zero or has changed its sign have no mass."""
        gX, _ = self.model.jacobians(self.grid.centres, y)
        mass = float(masses[np.sign(np.linalg.det(gX)) != self.orientation].sum())
        if mass > NEGLIGIBLE_MASS:
            raise StepFailure(
                Status.SINGULAR, f"at y = {y}: det dg/dX is zero or changed its sign for {mass:.1e} of the mass."
            )

    def _speeds(self, z: GridState) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Compute Phi[v] across the faces of both axes; zero for the second axis of a grid of one axis."""
        n0, n1 = z.f.shape
        speeds = [np.zeros((n0 + 1, n1)), np.zeros((n0, n1 + 1))]
        for axis, faces in enumerate(self.grid.faces):
            speeds[axis].ravel()[:] = speed(self.model, axis, faces, z.y, z.v)
        if not all(np.isfinite(across).all() for across in speeds):
            raise StepFailure(Status.NON_FINITE, f"at y = {z.y}: a speed on the grid is not finite.")
        return speeds[0], speeds[1]

    def attempt(self, z: GridState, first: Rate, dt: float) -> Trial:
        """Try a step of length dt from z, whose rate is ``first``; return z at the first invalid stage."""
        ratio = np.zeros(2)
        ratio[: len(self.grid.edges)] = dt / self.grid.spacing
        state, rates, largest, blocked = z, [first], 0.0, 0.0
        for start_weight, slope_weight in zip(START_WEIGHTS, SLOPE_WEIGHTS, strict=True):
            f, rate = np.empty_like(z.f), rates[-1]
            outflow, held_back = euler_step(state.f, *rate.speeds, ratio, z.f, start_weight, f)
            largest, blocked = max(largest, outflow), blocked + slope_weight * held_back * self.grid.volume
            if not largest <= 1:
                return Trial(z, largest, blocked, 0.0, 0.0)
            y = start_weight * z.y + (1 - start_weight) * (state.y + dt * rate.v)
            v = start_weight * z.v + (1 - start_weight) * (state.v + dt * rate.a)
            state = GridState(f, y, v)
            if len(rates) < len(START_WEIGHTS):
                rates.append(self.rate(state))
        return Trial(state, largest, blocked, _error([r.v for r in rates], dt), _error([r.a for r in rates], dt))


def _error(slopes: list[NDArray[np.float64]], dt: float) -> float:
    """Compute the largest difference from the second-order method with weights 1/2, 1/2, 0 on the same slopes."""
    k1, k2, k3 = slopes
    return float(np.abs(dt * (2 * k3 - k1 - k2) / 3).max())


def speed(
    model: Model, axis: int, X: NDArray[np.float64], y: NDArray[np.float64], v: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute (Phi(X, y) v)_axis at points X (Q, nx), shape (Q,); infinite or NaN where the model is singular.

    Source: (5.9).
    """
    with np.errstate(all="ignore"):
        (found,) = _component(model, axis)(X, y, v)
    return np.broadcast_to(found, len(X))


@lru_cache(maxsize=256)
def _component(model: Model, axis: int) -> Callable[..., list[NDArray[np.float64]]]:
    e = model.expressions
    flow = library().mtimes(e.phi, e.v)[axis]
    return vectorised(program([e.X, e.y, e.v], [flow]), ["X", "y", "v"], [True, False, False])
