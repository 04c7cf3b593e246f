"""Push-forward of a density on a line by the constraint: exact, because g(X, y) and mass are conserved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import shaped
from dincl.errors import InvalidProblem
from meanfield.density.density import Density
from meanfield.solvers.arguments import check_density, check_model
from meanfield.solvers.index_one import consistent_values

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model


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
    check_model(model)
    check_density(density)
    if model.nx != 1 or density.nx != 1:
        raise InvalidProblem(f"nx = {model.nx} of the model, {density.nx} of the density: both must be 1")
    before, after = shaped("y0", y0, (model.ny,)), shaped("y", y, (model.ny,))
    places = np.array([density.lower[0], *density.breaks, density.upper[0]])
    ends = np.sort(origins(model, places[:, None], before, after)[:, 0])
    return Density(_PushedForward(model, density, before, after), ends[:1], ends[-1:], breaks=tuple(ends[1:-1]))


def origins(
    model: Model, x: NDArray[np.float64], y: NDArray[np.float64], y0: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Trace particles at x (n, nx) from the macroscopic state y back to y0: solve g(x0, y0) = g(x, y) for x0."""
    return consistent_values(model, x, y0, np.zeros_like(y0), model.level(x, y))[0]


@dataclass(frozen=True, eq=False)
class _PushedForward:
    model: Model
    density: Density
    y0: NDArray[np.float64]
    y: NDArray[np.float64]

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        before = origins(self.model, x, self.y, self.y0)
        ratio = self.model.jacobians(x, self.y)[0] / self.model.jacobians(before, self.y0)[0]
        return np.asarray(self.density.density(before) * np.abs(ratio[:, 0, 0]))
