"""One time step of the mean-field PDE on a grid: density, y and v together by third-order SSP Runge-Kutta."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.status import Status
from meanfield.forces.field import field
from meanfield.kernels.finite_volume import euler_step
from meanfield.solvers.grid.speeds import speed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from meanfield.model.model import Model
    from meanfield.solvers.grid.cells import CellGrid

# Each stage is a mean of the start of the step (with these weights) and an Euler step from the stage before
# (Shu and Osher 1988); then the weights of the three slopes in the result.
KEEP = (0.0, 3 / 4, 1 / 3)
WEIGHTS = (1 / 6, 1 / 6, 2 / 3)
# Share of the mass that the grid may lose or hold where the model is singular, before a run is given up.
NEGLIGIBLE = 1e-8


class GridState(NamedTuple):
    """Cell averages f (n0, n1), with n1 = 1 on one axis, and y, v (ny,)."""

    f: NDArray[np.float64]
    y: NDArray[np.float64]
    v: NDArray[np.float64]


class Rate(NamedTuple):
    """Speeds across the faces (n0 + 1, n1), (n0, n1 + 1), and y' = v, v' = a."""

    speeds: tuple[NDArray[np.float64], NDArray[np.float64]]
    v: NDArray[np.float64]
    a: NDArray[np.float64]


class Trial(NamedTuple):
    """A step tried: ``share`` of its density that a cell gives away at most in a stage (beyond 1 the step is void),
    mass held back by the walls, and estimates of the errors of y and v.
    """

    state: GridState
    share: float
    leaving: float
    error_y: float
    error_v: float


@dataclass(frozen=True, eq=False)
class GridSystem:
    """A model on a grid; ``orientation`` is the sign of det dg/dX at the start."""

    model: Model
    grid: CellGrid
    orientation: float

    def rate(self, z: GridState) -> Rate:
        """(5.42) at a state: the integrals (5.41) are sums over cells, average times value at the midpoint.

        Raises
        ------
        StepFailure
            if something is not finite, or det dg/dX has changed its sign where there is mass.
        """
        masses = (z.f * self.grid.volume).ravel()
        found = field(self.model, self.grid.centres, masses, z.y, z.v)
        if found.orientation != self.orientation:
            self._look_at_signs(masses, z.y)
        a = found.acceleration()
        if not np.isfinite(a).all():
            raise StepFailure(Status.NON_FINITE, f"at y = {z.y}: the effective mass or force is not finite.")
        return Rate(self._speeds(z), z.v, a)

    def _look_at_signs(self, masses: NDArray[np.float64], y: NDArray[np.float64]) -> None:
        """Cells where det dg/dX is zero or has another sign than at the start may hold no mass."""
        gX, _ = self.model.jacobians(self.grid.centres, y)
        wrong = float(masses[np.sign(np.linalg.det(gX)) != self.orientation].sum())
        if wrong > NEGLIGIBLE:
            raise StepFailure(
                Status.SINGULAR, f"at y = {y}: det dg/dX is zero or changed its sign for {wrong:.1e} of the mass."
            )

    def _speeds(self, z: GridState) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Phi[v] across the faces of both axes; zero across a second axis that is not there."""
        n0, n1 = z.f.shape
        speeds = [np.zeros((n0 + 1, n1)), np.zeros((n0, n1 + 1))]
        for axis, faces in enumerate(self.grid.faces):
            speeds[axis].ravel()[:] = speed(self.model, axis, faces, z.y, z.v)
        if not all(np.isfinite(across).all() for across in speeds):
            raise StepFailure(Status.NON_FINITE, f"at y = {z.y}: a speed on the grid is not finite.")
        return speeds[0], speeds[1]

    def tried(self, z: GridState, first: Rate, dt: float) -> Trial:
        """A step of length dt from z, where ``first`` is the rate; given up at the first stage that is void."""
        ratio = np.zeros(2)
        ratio[: len(self.grid.edges)] = dt / self.grid.spacing
        state, rates, most, left = z, [first], 0.0, 0.0
        for keep, weight in zip(KEEP, WEIGHTS, strict=True):
            f, rate = np.empty_like(z.f), rates[-1]
            share, leaving = euler_step(state.f, *rate.speeds, ratio, z.f, keep, f)
            most, left = max(most, share), left + weight * leaving * self.grid.volume
            if not most <= 1:
                return Trial(z, most, left, 0.0, 0.0)
            y = keep * z.y + (1 - keep) * (state.y + dt * rate.v)
            state = GridState(f, y, keep * z.v + (1 - keep) * (state.v + dt * rate.a))
            if len(rates) < len(KEEP):
                rates.append(self.rate(state))
        return Trial(state, most, left, _error([r.v for r in rates], dt), _error([r.a for r in rates], dt))


def _error(slopes: list[NDArray[np.float64]], dt: float) -> float:
    """Largest difference to the second-order method with weights 1/2, 1/2, 0 on the same slopes."""
    k1, k2, k3 = slopes
    return float(np.abs(dt * (2 * k3 - k1 - k2) / 3).max())
