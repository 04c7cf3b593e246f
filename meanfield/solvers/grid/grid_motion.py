"""Result of ``solve_pde``: the density on a grid and the macroscopic component at the output times."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import InvalidProblem
from meanfield import plotting
from meanfield.density.panels import Panels
from meanfield.forces.interaction import pair_energy
from meanfield.solvers.grid.cells import CellGrid
from meanfield.solvers.result import PLOTTED_DENSITIES, SolverResult, spread_indices

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.status import Status
    from meanfield.model.model import Model
    from meanfield.solvers.motion import SolverWork


@dataclass(frozen=True, eq=False, repr=False)
class GridMotion(SolverResult):
    """Solution of the mean-field PDE (5.42) on a fixed grid.

    Parameters
    ----------
    t, y, v
        output times (K,), and y, y' at these times (K, ny).
    edges
        edges of the cells, one array per axis.
    f
        averages of the density over the cells, (K, cells) or (K, cells, cells), >= 0.
    status, detail
        how the run ended. After a failure, t has the output times reached.
    work
        unknowns = cells + 2 ny, steps, evaluations of the right-hand side.
    """

    model: Model
    t: NDArray[np.float64]
    y: NDArray[np.float64]
    v: NDArray[np.float64]
    edges: tuple[NDArray[np.float64], ...]
    f: NDArray[np.float64]
    status: Status
    detail: str
    work: SolverWork

    def mass(self) -> NDArray[np.float64]:
        """Compute the integral of f at the output times, (K,): 1 to rounding."""
        return np.asarray(self._weights().sum(axis=1))

    def mean(self) -> NDArray[np.float64]:
        """Compute the integral of x f, (K, nx), by the midpoints of the cells."""
        return np.asarray(self._weights() @ CellGrid(self.edges).centres)

    def second_moment(self) -> NDArray[np.float64]:
        """Compute the integral of x x^T f, (K, nx, nx), by the midpoints of the cells: of second order."""
        x = CellGrid(self.edges).centres
        return np.asarray(np.einsum("kq,qi,qj->kij", self._weights(), x, x, optimize=True))

    def energy(self) -> NDArray[np.float64]:
        """Compute the total energy (5.50) at the output times, (K,)::

        E = |y'|^2/2 + W0(y) + int (m/2 |Phi[y']|^2 + W1 + 1/2 int V(x' - x) f(x') dx') f(x) dx
        """
        x = CellGrid(self.edges).centres
        found = np.empty(len(self.t))
        for k, weights in enumerate(self._weights()):
            occupied = weights > 0
            X, w = x[occupied], weights[occupied]
            U = self.model.phi(X, self.y[k]) @ self.v[k]
            kinetic = (self.v[k] @ self.v[k] + self.model.m * (w @ (U * U).sum(axis=1))) / 2
            found[k] = kinetic + self.model.energy0(self.y[k]) + w @ self.model.energy1(X)
            found[k] += pair_energy(self.model, X, w) / 2 if self.model.V is not None else 0.0
        return found

    def density(self, k: int) -> Panels:
        """Return the density at the output time k, constant on cells, for ``w1``.

        Raises
        ------
        InvalidProblem
            in two dimensions, or if k is no index of an output time; negative indices count from the end.
        """
        k = self._output_index(k)
        if len(self.edges) > 1:
            raise InvalidProblem("density(k) on a grid of two axes: must be of one; f holds the averages")
        return Panels.piecewise_constant(self.edges[0], self.f[k])

    def _measures(self) -> dict[str, NDArray[np.float64]]:
        mean = self.mean()
        return {"mass": self.mass()} | {f"mean{k + 1}": mean[:, k] for k in range(mean.shape[1])}

    def _drifts(self) -> dict[str, NDArray[np.float64]]:
        return {"mass - 1": self.mass() - 1}

    def _size(self) -> str:
        return f"{' x '.join(str(len(e) - 1) for e in self.edges)} cells, ny = {self.model.ny}"

    def _plots(self) -> list[Callable[[Any], None]]:
        if not len(self.t):
            return []
        if len(self.edges) == 1:
            drawn = spread_indices(len(self.t), PLOTTED_DENSITIES)
            lines = {float(self.t[k]): (self.edges[0], self.f[k]) for k in drawn}
            return [partial(plotting.draw_densities, lines=lines)]
        times = f"{self.t[-1]:.3g}; half the maximum at t = {self.t[0]:.3g} dashed"
        return [partial(plotting.draw_density_map, edges=self.edges, f=self.f[-1], begin=self.f[0], times=times)]

    def _weights(self) -> NDArray[np.float64]:
        """Return the mass of each cell at the output times, (K, number of cells)."""
        return self.f.reshape(len(self.f), -1) * CellGrid(self.edges).volume
