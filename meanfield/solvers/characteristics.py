"""Mean-field limit by characteristics: a density transported by the flow, with quadrature to tolerance.

On a line, ``push_forward`` gives the density at any macroscopic state: g(X, y) and mass are conserved.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import flag, shaped
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.density import MAX_NODES_PER_AXIS, Density
from meanfield.model.state import State
from meanfield.solvers.ode import solve_weighted
from meanfield.solvers.result import Motion, check_law, checked_limit, delivered, tolerance

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats
    from meanfield.model.model import Model

# Gauss points per axis and smooth piece of the density in the first run, and largest total number of nodes.
FIRST_NODES, MAX_NODES = 8, 200_000
# With interaction, a step may take a number of operations quadratic in the number of nodes.
MAX_INTERACTING_NODES = 10_000
# Smallest quadrature error that two runs can show, relative to the size of y and v.
FLOW_ROUNDING = 1e-14
# Newton's method converges quadratically: after a correction of this relative size the next one is below rounding.
NEWTON_TOLERANCE, MAX_NEWTON_ITERATIONS = 1e-9, 20


@dataclass(frozen=True, eq=False, repr=False)
class Flow(Motion):
    """Characteristics (5.40): a Motion whose particles are quadrature nodes of the initial density.

    Parameters
    ----------
    quadrature_error
        largest change of y and v at the output times when the nodes were last doubled.
    """

    quadrature_error: float

    def _size(self) -> str:
        return f"{self.X.shape[1]} nodes, nx = {self.model.nx}"


def solve_characteristics(
    model: Model, density: Density, y0: ArrayLike, v0: ArrayLike, t: ArrayLike, tol: float, *, throw: bool = True
) -> Flow:
    """Solve the mean-field characteristic flow (5.40)::

        m_eff(mu^t, y) y'' = F_eff(mu^t, y, y'),   X^t(x)' = Phi(X^t(x), y)[y'],   mu^t = X^t # density

    Gauss-Legendre nodes of the density move with the flow and keep their weights; the integrator is that of
    ``solve_ode``. The number of nodes per axis is doubled until y and v at the output times change by at most tol.

    Parameters
    ----------
    density
        initial probability density.
    y0, v0
        (ny,) macroscopic component and its velocity.
    t
        (K,) output times, >= 0 and increasing; the run starts at 0.
    tol
        tolerance of the integrator; tolerance of the quadrature relative to 1 + max(|y|, |v|).
    throw
        raise SolveFailed on failure; otherwise return the output times reached, with their Status.

    Raises
    ------
    InvalidProblem
        if an argument is invalid.
    SolveFailed
        as ``solve_ode``; NOT_CONVERGED if quadrature needs more than 200 000 nodes (10 000 with interaction), or more
        than 2048 per axis and smooth piece.

    Source: (5.40), (5.41).
    """
    y, v, times = checked_limit(model, density, y0, v0, t)
    tol, raises = tolerance(tol), flag("throw", throw)
    n, flow, converged = FIRST_NODES, None, False
    most = MAX_NODES if model.V is None else MAX_INTERACTING_NODES
    while flow is None or not (converged or n > MAX_NODES_PER_AXIS or len(flow.level) * 2**model.nx > most):
        nodes, weights = density.nodes(n)
        motion = solve_weighted(model, State(X=nodes, y=y, v=v), weights, times, tol, throw=False)
        now, size, error = len(motion.t), max(np.abs(z).max(initial=0.0) for z in (motion.y, motion.v)), 0.0
        if flow is not None:
            k = min(len(flow.t), now)
            gaps = [np.abs(a[:k] - b[:k]).max(initial=0.0) for a, b in ((flow.y, motion.y), (flow.v, motion.v))]
            error = float(max(*gaps, FLOW_ROUNDING * size))
            converged = len(flow.t) == now and error <= tol * (1 + size)
        n, flow = 2 * n, Flow(**vars(motion), quadrature_error=error)
    if not converged and flow.status:
        detail = f"{len(flow.level)} nodes give the integrals over the density to {flow.quadrature_error:.1e}."
        flow = replace(flow, status=Status.NOT_CONVERGED, detail=detail)
    return delivered(flow, raises)


def push_forward(model: Model, density: Density, y0: ArrayLike, y: ArrayLike) -> Density:
    """Compute the density, at the macroscopic state y, of particles that had ``density`` at y0, for nx = 1::

        f(x) = f0(x0) |dg/dX(x, y)| / |dg/dX(x0, y0)|,   g(x0, y0) = g(x, y)

    Parameters
    ----------
    y0, y
        (ny,) macroscopic states; between them dg/dX must keep its rank wherever there are particles (5.5).

    Raises
    ------
    InvalidProblem
        in more than one dimension, or if a value of the model is not finite.

    Source: (5.40), with conservation of g(X, y) and of mass.
    """
    check_law(model, density)
    if model.nx != 1:
        raise InvalidProblem(f"model.nx = {model.nx}: must be 1 to push a density forward")
    before, after = shaped("y0", y0, (model.ny,)), shaped("y", y, (model.ny,))
    places = np.array([density.lower[0], *density.breaks, density.upper[0]])
    ends = np.sort(origins(model, places[:, None], before, after)[:, 0])
    return Density(partial(_pushed, model, density, before, after), ends[:1], ends[-1:], breaks=tuple(ends[1:-1]))


def origins(model: Model, x: Floats, y: Floats, y0: Floats) -> Floats:
    """Trace particles at x (n, 1) from the macroscopic state y back to y0: solve g(x0, y0) = g(x, y) for x0.

    Raises
    ------
    StepFailure
        if Newton's method does not converge, or dg/dX is singular.
    """
    level, found = model.level(x, y), x
    for _ in range(MAX_NEWTON_ITERATIONS):
        gX, _ = model.jacobians(found, y0)
        if not gX.all():
            raise StepFailure(Status.SINGULAR, "dg/dX of a particle is singular.")
        step = (level - model.level(found, y0)) / gX[:, :, 0]
        found = found + step
        if np.abs(step).max() <= NEWTON_TOLERANCE * (1 + np.abs(found).max()):
            return found
    raise StepFailure(Status.NOT_CONVERGED, "No positions that satisfy the constraint were found.")


def _pushed(model: Model, density: Density, y0: Floats, y: Floats, x: Floats) -> Floats:
    before = origins(model, x, y, y0)
    ratio = model.jacobians(x, y)[0] / model.jacobians(before, y0)[0]
    return np.asarray(density.density(before) * np.abs(ratio[:, 0, 0]))
