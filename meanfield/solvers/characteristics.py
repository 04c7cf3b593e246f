"""The mean-field limit by its characteristics: a density carried by the flow, with quadrature to tolerance."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import flag
from dincl.status import Status
from meanfield import plotting
from meanfield.density.density import MOST_NODES as MOST_PER_AXIS
from meanfield.errors import SolveFailed
from meanfield.model.state import State
from meanfield.solvers.arguments import checked_start, tolerance
from meanfield.solvers.motion import Motion
from meanfield.solvers.ode import solve_weighted
from meanfield.solvers.result import DENSITIES, chosen
from meanfield.transport.wasserstein import Weighted

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from meanfield.density.density import Density
    from meanfield.model.model import Model

# Gauss points per axis and smooth piece of the density: at first, and in all at most.
FEWEST_NODES, MOST_NODES = 8, 200_000
# With interaction all pairs of nodes count.
MOST_INTERACTING = 10_000
# Two runs that differ by rounding only prove no more than this, relative to the size of y and v.
ROUNDING = 1e-14


@dataclass(frozen=True, eq=False, repr=False)
class Flow(Motion):
    """The characteristics (5.40): a Motion whose particles are quadrature nodes of the initial density.

    Parameters
    ----------
    quadrature_error
        largest change of y and v at the kept times when the nodes were doubled for the last time.
    level_density
        (Q,) density of g(X, y), which the flow does not change: f0(x) / |det dg/dX(x, y0)| at each node.
    """

    quadrature_error: float
    level_density: NDArray[np.float64]

    def density(self, k: int) -> NDArray[np.float64]:
        """f(X^t(x), t) at the nodes at the kept time k, (Q,).

        g(X^t(x), y(t)) = g(x, y0) differentiates to  DX^t = dg/dX(X^t, y(t))^{-1} dg/dX(x, y0),  and mass is carried:
        f(X^t(x), t) = f0(x) / |det DX^t(x)|.

        Raises
        ------
        InvalidProblem
            if k is no index of a kept time, which may count from the end.
        """
        k = self._kept(k)
        gX, _ = self.model.jacobians(self.X[k], self.y[k])
        return np.asarray(self.level_density * np.abs(np.linalg.det(gX)))

    def _size(self) -> str:
        return f"{len(self.level_density)} nodes, nx = {self.model.nx}, ny = {self.model.ny}"

    def _pictures(self) -> list[Callable[[Any], None]]:
        if not self._has_plane():
            return []
        if self.model.nx == 2:
            title = f"Density at the nodes, t = {self.t[-1]:.3g}"
            return [partial(plotting.draw_nodes, x=self.X[-1], f=self.density(-1), title=title)]
        lines = {}
        for k in chosen(len(self.t), DENSITIES):
            order = np.argsort(self.X[k, :, 0])
            lines[float(self.t[k])] = self.X[k, order, 0], self.density(k)[order]
        return [partial(plotting.draw_densities, lines=lines)]

    def measure(self, k: int) -> Weighted:
        """The nodes at the kept time k and their weights, for ``w1``."""
        k = self._kept(k)
        return Weighted(self.X[k], np.asarray(self.weights))


def solve_characteristics(
    model: Model, density: Density, y0: ArrayLike, v0: ArrayLike, t: ArrayLike, tol: float, *, throw: bool = True
) -> Flow:
    """Solve the mean-field characteristic flow (5.40)::

        m_eff(mu^t, y) y'' = F_eff(mu^t, y, y'),   X^t(x)' = Phi(X^t(x), y)[y'],   mu^t = X^t # density

    Gauss-Legendre nodes of the density are carried along with fixed weights, by the integrator of ``solve_ode``. They
    are doubled per axis until y and v at the kept times change by at most tol.

    Parameters
    ----------
    density
        initial probability density.
    y0, v0
        (ny,) macroscopic component and its velocity.
    t
        (K,) times to keep, >= 0 and increasing; the run starts at 0.
    tol
        tolerance of the integrator, and of the quadrature relative to 1 + the largest of abs y, abs v.

    Raises
    ------
    InvalidProblem
        if an argument cannot be right.
    SolveFailed
        as ``solve_ode``; NOT_CONVERGED if more than 200 000 nodes (10 000 with interaction), or 2048 per axis and
        smooth piece, would be needed.

    Source: (5.40), (5.41).
    """
    y, v, times = checked_start(model, density, y0, v0, t)
    tol, raises = tolerance(tol), flag("throw", throw)
    flow = _carried(model, density, y, v, times, tol, FEWEST_NODES, None)
    n, converged = FEWEST_NODES, False
    most = MOST_NODES if model.V is None else MOST_INTERACTING
    while not converged and 2 * n <= MOST_PER_AXIS and len(flow.level_density) * 2**model.nx <= most:
        n, before = 2 * n, len(flow.t)
        flow = _carried(model, density, y, v, times, tol, n, flow)
        converged = len(flow.t) == before and flow.quadrature_error <= tol * (1 + _size(flow))
    if not converged and flow.status:
        detail = f"{len(flow.level_density)} nodes give the integrals over the density to {flow.quadrature_error:.1e}."
        flow = replace(flow, status=Status.NOT_CONVERGED, detail=detail)
    if raises and not flow.status:
        raise SolveFailed(flow.status, flow.detail, flow)
    return flow


def _carried(
    model: Model,
    density: Density,
    y: NDArray[np.float64],
    v: NDArray[np.float64],
    t: NDArray[np.float64],
    tol: float,
    n: int,
    coarser: Flow | None,
) -> Flow:
    """The flow of n nodes per axis and piece, compared with one of fewer."""
    nodes, weights = density.nodes(n)
    motion = solve_weighted(model, State(X=nodes, y=y, v=v), weights, t, tol, throw=False)
    gX, _ = model.jacobians(nodes, y)
    carried = {part.name: getattr(motion, part.name) for part in fields(Motion)}
    level_density = density.density(nodes) / np.abs(np.linalg.det(gX))
    flow = Flow(**carried, quadrature_error=0.0, level_density=level_density)
    return flow if coarser is None else replace(flow, quadrature_error=_change(coarser, flow))


def _change(coarser: Flow, flow: Flow) -> float:
    """Largest difference of y and v at the kept times that both reached, and at least their rounding."""
    k = min(len(coarser.t), len(flow.t))
    gaps = [np.abs(a[:k] - b[:k]).max(initial=0.0) for a, b in ((coarser.y, flow.y), (coarser.v, flow.v))]
    return float(max(*gaps, ROUNDING * _size(flow)))


def _size(flow: Flow) -> float:
    return float(max(np.abs(flow.y).max(initial=0.0), np.abs(flow.v).max(initial=0.0)))
