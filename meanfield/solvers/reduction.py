"""What of a model need not be integrated: which reduction holds, and the equations that are left."""

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
from meanfield.model.state import oriented
from meanfield.model.symbolic import library, program
from meanfield.model.translate import vectorised
from meanfield.solvers.arguments import model_given
from meanfield.solvers.moments import points, sample_moments

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield.model.model import Model
    from meanfield.model.state import FullState


class Positions(Enum):
    """How the particles follow from y; ``value`` is the sentence for a reader."""

    SHIFT = "Phi = G is constant: X_i(t) = X_i(0) + G (y(t) - y(0))."
    AFFINE = "g is affine in X: X_i(t) = B(y)^{-1} (c_i - b(y)) with g = B(y) X + b(y)."
    FLOW = "g is not affine in X: the particles must be integrated, X_i' = Phi(X_i, y) y'."


@dataclass(frozen=True, eq=False)
class Reduction:
    """The least that has to be integrated for a model.

    ``positions`` says how the particles follow from y; ``obstacle`` what keeps effective mass and force from being
    functions of the first two moments, None if nothing does. With positions in closed form ``solve_ode`` integrates
    2 ny unknowns, and if the moments close too, a step costs the same for any number of particles.

    Source: after (5.31); Remark 5.20.
    """

    model: Model
    positions: Positions
    obstacle: str | None

    def __reduce__(self) -> tuple[Any, ...]:
        return Reduction, (self.model, self.positions, self.obstacle)

    def degrees_of_freedom(self, particles: int) -> int:
        """Unknowns that ``solve_ode`` integrates for so many particles, an integer >= 1."""
        particles = integer("particles", particles, least=1)
        carried = particles * self.model.nx if self.positions is Positions.FLOW else 0
        return 2 * self.model.ny + carried

    def moment_unknowns(self) -> int:
        """Unknowns of ``solve_moments``: y, y', rho and the upper half of sigma.

        Raises
        ------
        NotClosed
            if the moments do not close.
        """
        if self.obstacle is not None:
            raise NotClosed(f"the moment equations do not close: {self.obstacle}")
        nx = self.model.nx
        return 2 * self.model.ny + nx + nx * (nx + 1) // 2

    def unknowns(self, start: FullState, weights: NDArray[np.float64] | None) -> Explicit:
        """The reduced system (y, v) for an integrator.

        Raises
        ------
        NotClosed
            if the particles do not follow from y in closed form.
        """
        if self.positions is Positions.FLOW:
            raise NotClosed(f"no reduction holds: {self.positions.value} Solve the model itself.")
        return Explicit(self, start, weights)

    @cached_property
    def place(self) -> Callable[..., list[NDArray[np.float64]]]:
        """X as a function of arrays (level, y): elements of shape (N,)."""
        ca = library()
        e = self.model.expressions
        c = ca.SX.sym("c", self.model.nx)
        at_zero = ca.substitute(ca.horzcat(e.gX, e.level), e.X, ca.SX.zeros(self.model.nx))
        B, b = at_zero[:, : self.model.nx], at_zero[:, self.model.nx]
        return vectorised(program([c, e.y], [ca.mtimes(ca.inv_minor(B), c - b)]), ["c", "y"], [True, False])


def reduce(model: Model) -> Reduction:
    """Which reduction holds for a model: look at ``positions`` and ``obstacle`` of what is returned.

    The question is put to the expressions, so that a form in which something does not visibly cancel may be missed;
    what is found holds.

    Raises
    ------
    InvalidProblem
        if it is no Model.
    """
    model_given(model)
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


class Explicit:
    """The unknowns (y, v) alone: the particles, or their moments, follow from y."""

    def __init__(self, reduction: Reduction, start: FullState, weights: NDArray[np.float64] | None) -> None:
        self._model, self._place = reduction.model, reduction.place
        self._level, self._weights = start.level, weights
        self.start = np.concatenate([start.y, start.v])
        self.orientation = oriented(self._model, start)
        self.shares = np.ones(self.start.size)
        # X is affine in the constants c, so few of them with the moments of all give the moments of all particles.
        self._few = points(sample_moments(start.level, weights)) if closure(self._model) else None

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """z' and the orientation at z; NaN where there is none."""
        ny = self._model.ny
        y, v = z[:ny], z[ny:]
        level, weights = (self._level, self._weights) if self._few is None else self._few
        found = field(self._model, self._placed(level, y), weights, y, v)
        return np.concatenate([v, found.acceleration()]), found.orientation

    def positions(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """X of shape (N, nx) at z."""
        return self._placed(self._level, z[: self._model.ny])

    def _placed(self, level: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        elements: list[Any] = self._place(level, y)
        return np.column_stack([np.broadcast_to(element, len(level)) for element in elements])
