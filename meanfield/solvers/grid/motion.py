"""What ``solve_pde`` returns: the density on a grid and the macroscopic component, at the kept times."""

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
from meanfield.solvers.result import DENSITIES, SolverResult, chosen

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.status import Status
    from meanfield.model.model import Model
    from meanfield.solvers.motion import SolverWork


@dataclass(frozen=True, eq=False, repr=False)
class GridMotion(SolverResult):
    """The mean-field PDE (5.42) on a grid that stays where it is.

    Parameters
    ----------
    t, y, v
        kept times (K,), and y, y' there (K, ny).
    edges
        edges of the cells, one array per axis.
    f
        averages of the density over the cells, (K, cells) or (K, cells, cells); >= 0 always.
    status, detail
        how the run ended; kept times after an early end are left out.
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
        """Integral of f at the kept times, (K,): 1 to rounding."""
        return np.asarray(self._weights().sum(axis=1))

    def mean(self) -> NDArray[np.float64]:
        """Integral of x f, (K, nx), from the midpoints of the cells."""
        return np.asarray(self._weights() @ CellGrid(self.edges).centres)

    def second_moment(self) -> NDArray[np.float64]:
        """Integral of x x^T f, (K, nx, nx), from the midpoints of the cells: its error is of second order."""
        x = CellGrid(self.edges).centres
        return np.asarray(np.einsum("kq,qi,qj->kij", self._weights(), x, x, optimize=True))

    def energy(self) -> NDArray[np.float64]:
        """Total energy (5.50) at the kept times, (K,)::

        E = |y'|^2/2 + W0(y) + int (m/2 |Phi[y']|^2 + W1 + 1/2 int V(x' - x) f(x') dx') f(x) dx
        """
        x = CellGrid(self.edges).centres
        found = np.empty(len(self.t))
        for k, weights in enumerate(self._weights()):
            there = weights > 0
            X, w = x[there], weights[there]
            U = self.model.phi(X, self.y[k]) @ self.v[k]
            kinetic = (self.v[k] @ self.v[k] + self.model.m * (w @ (U * U).sum(axis=1))) / 2
            found[k] = kinetic + self.model.energy0(self.y[k]) + w @ self.model.energy1(X)
            found[k] += pair_energy(self.model, X, w) / 2 if self.model.V is not None else 0.0
        return found

    def density(self, k: int) -> Panels:
        """The density at the kept time k, constant on cells, for ``w1``.

        Raises
        ------
        InvalidProblem
            in two dimensions, or if k is no index of a kept time, which may count from the end.
        """
        k = self._kept(k)
        if len(self.edges) > 1:
            raise InvalidProblem("density(k) on a grid of two axes: must be of one; f holds the averages")
        return Panels.steps(self.edges[0], self.f[k])

    def _measures(self) -> dict[str, NDArray[np.float64]]:
        mean = self.mean()
        return {"mass": self.mass()} | {f"mean{k + 1}": mean[:, k] for k in range(mean.shape[1])}

    def _drifts(self) -> dict[str, NDArray[np.float64]]:
        return {"mass - 1": self.mass() - 1}

    def _size(self) -> str:
        return f"{' x '.join(str(len(e) - 1) for e in self.edges)} cells, ny = {self.model.ny}"

    def _pictures(self) -> list[Callable[[Any], None]]:
        if not len(self.t):
            return []
        if len(self.edges) == 1:
            lines = {float(self.t[k]): (self.edges[0], self.f[k]) for k in chosen(len(self.t), DENSITIES)}
            return [partial(plotting.draw_densities, lines=lines)]
        said = f"{self.t[-1]:.3g}; half its height at t = {self.t[0]:.3g} dashed"
        return [partial(plotting.draw_density_map, edges=self.edges, f=self.f[-1], begin=self.f[0], times=said)]

    def _weights(self) -> NDArray[np.float64]:
        """Mass of each cell at the kept times, (K, cells in all)."""
        return self.f.reshape(len(self.f), -1) * CellGrid(self.edges).volume
