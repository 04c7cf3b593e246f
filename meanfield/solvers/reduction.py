"""Reductions of a model: which unknowns follow from y in closed form, and the equations of the others."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import integer
from meanfield.errors import NotClosed
from meanfield.forces.field import field
from meanfield.model.closure import closure, obstacle
from meanfield.model.state import orientation_at
from meanfield.model.symbolic import library, program
from meanfield.model.translate import vectorised
from meanfield.solvers.arguments import check_model
from meanfield.solvers.moments import points, sample_moments
from meanfield.solvers.motion import energies

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.model import Model
    from meanfield.model.state import FullState


class Positions(Enum):
    """Relation between the particles and y; ``value`` states it in a sentence."""

    SHIFT = "Phi = G is constant: X_i(t) = X_i(0) + G (y(t) - y(0))."
    AFFINE = "g is affine in X: X_i(t) = B(y)^{-1} (c_i - b(y)) with g = B(y) X + b(y)."
    FLOW = "g is not affine in X: the particles must be integrated, X_i' = Phi(X_i, y) y'."


@dataclass(frozen=True, eq=False)
class Reduction:
    """Reduction of a model to the unknowns that must be integrated.

    ``positions`` states how the particles follow from y. ``obstacle`` states why effective mass and force are not
    functions of the first two moments, None if they are. With positions in closed form, ``solve_ode`` integrates 2 ny
    unknowns; if the moment equations close too, the cost of a step does not depend on the number of particles.

    Source: after (5.31); Remark 5.20.
    """

    model: Model
    positions: Positions
    obstacle: str | None

    def __reduce__(self) -> tuple[Any, ...]:
        return Reduction, (self.model, self.positions, self.obstacle)

    def degrees_of_freedom(self, particles: int) -> int:
        """Count the unknowns that ``solve_ode`` integrates for a number of particles, an integer >= 1."""
        particles = integer("particles", particles, least=1)
        coordinates = particles * self.model.nx if self.positions is Positions.FLOW else 0
        return 2 * self.model.ny + coordinates

    def moment_unknowns(self) -> int:
        """Count the unknowns of ``solve_moments``: y, y', rho and the upper half of sigma.

        Raises
        ------
        NotClosed
            if the moments do not close.
        """
        if self.obstacle is not None:
            raise NotClosed(f"the moment equations do not close: {self.obstacle}")
        nx = self.model.nx
        return 2 * self.model.ny + nx + nx * (nx + 1) // 2

    def system(self, start: FullState, weights: NDArray[np.float64] | None) -> ReducedSystem:
        """Build the reduced system of the unknowns (y, v).

        Raises
        ------
        NotClosed
            if the particles do not follow from y in closed form.
        """
        if self.positions is Positions.FLOW:
            raise NotClosed(f"no reduction holds: {self.positions.value} Pass the model to solve_ode.")
        return ReducedSystem(self, start, weights)

    @cached_property
    def closed_form(self) -> Callable[..., list[NDArray[np.float64]]]:
        """X as a function of arrays (level, y): a list of its components, of shape (N,) or ()."""
        ca = library()
        e = self.model.expressions
        c = ca.SX.sym("c", self.model.nx)
        at_zero = ca.substitute(ca.horzcat(e.gX, e.level), e.X, ca.SX.zeros(self.model.nx))
        B, b = at_zero[:, : self.model.nx], at_zero[:, self.model.nx]
        return vectorised(program([c, e.y], [ca.mtimes(ca.inv_minor(B), c - b)]), ["c", "y"], [True, False])


def reduce(model: Model) -> Reduction:
    """Find the reduction that holds for a model; see its ``positions`` and ``obstacle``.

    Reductions are found from the expressions of the model. A reduction that is found holds; one that depends on terms
    that do not cancel symbolically may be missed.

    Raises
    ------
    InvalidProblem
        if the argument is no Model.
    """
    check_model(model)
    ca = library()
    e = model.expressions
    phi = ca.vec(e.phi)
    if ca.jacobian(phi, ca.vertcat(e.X, e.y)).nnz() == 0:
        positions = Positions.SHIFT
    elif ca.jacobian(ca.vec(e.gX), e.X).nnz() == 0:
        positions = Positions.AFFINE
    else:
        positions = Positions.FLOW
    return Reduction(model, positions, obstacle(model))


class ReducedSystem:
    """System of the unknowns (y, v); the particles, or their moments, follow from y in closed form."""

    def __init__(self, reduction: Reduction, start: FullState, weights: NDArray[np.float64] | None) -> None:
        self.model, self._closed_form = reduction.model, reduction.closed_form
        self._level, self._weights = start.level, weights
        self.start = np.concatenate([start.y, start.v])
        self.orientation = orientation_at(self.model, start)
        self.error_weights = np.ones(self.start.size)
        # X is affine in the constants c_i: a few constants with the same moments give the moments of all particles.
        self._representatives = points(sample_moments(start.level, weights)) if closure(self.model) else None

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Compute z' and the orientation at z; NaN where they are undefined."""
        ny = self.model.ny
        y, v = z[:ny], z[ny:]
        level, weights = self._representatives or (self._level, self._weights)
        found = field(self.model, self._positions(level, y), weights, y, v)
        return np.concatenate([v, found.acceleration()]), found.orientation

    def positions(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return X of shape (N, nx) at z."""
        return self._positions(self._level, z[: self.model.ny])

    def path(
        self, z: NDArray[np.float64], rate: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return y and the first particle as one array, and its rate.

        One particle is enough: dg/dX depends on y alone if g is affine in X; if Phi is constant, so is dg/dX in time.
        """
        ny = self.model.ny
        y, v = z[:ny], z[ny:]
        X = self._positions(self._level[:1], y)
        return np.append(y, X), np.append(v, self.model.phi(X, y) @ v)

    def energies(self, z: NDArray[np.float64], rate: NDArray[np.float64]) -> tuple[float, float]:
        """Compute the kinetic and the potential energy at z."""
        y, v = z[: self.model.ny], z[self.model.ny :]
        level, weights = self._representatives or (self._level, self._weights)
        X = self._positions(level, y)
        return energies(self.model, X, weights, self.model.phi(X, y) @ v, y, v)

    def _positions(self, level: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        elements: list[Any] = self._closed_form(level, y)
        return np.column_stack([np.broadcast_to(element, len(level)) for element in elements])
