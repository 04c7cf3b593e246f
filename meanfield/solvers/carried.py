"""A density on a line after y has changed: exact, since the constraint tells from where each particle came."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import shaped
from dincl.errors import InvalidProblem
from meanfield.density.density import Density
from meanfield.solvers.arguments import density_given, model_given
from meanfield.solvers.index import consistent

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model


def carry_density(model: Model, density: Density, y0: ArrayLike, y: ArrayLike) -> Density:
    """The density at the macroscopic state y of particles that had ``density`` at y0, for nx = 1::

        f(x) = f0(x0) |dg/dX(x, y)| / |dg/dX(x0, y0)|,   g(x0, y0) = g(x, y)

    Parameters
    ----------
    y0, y
        (ny,) macroscopic states; between them dg/dX must keep its rank wherever there are particles (5.5).

    Raises
    ------
    InvalidProblem
        in more than one dimension, or if the model has no finite value there.

    Source: (5.40), by the conservation of g(X, y) and of mass.
    """
    model_given(model)
    density_given(density)
    if model.nx != 1 or density.nx != 1:
        raise InvalidProblem(f"nx = {model.nx}, of the density {density.nx}: a density is carried in one dimension")
    before, after = shaped("y0", y0, (model.ny,)), shaped("y", y, (model.ny,))
    ends = np.sort(origins(model, np.array([density.lower, density.upper]), before, after)[:, 0])
    return Density(_Carried(model, density, before, after), ends[:1], ends[1:])


def origins(
    model: Model, x: NDArray[np.float64], y: NDArray[np.float64], y0: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Where particles at x (n, nx), when the macroscopic state is y, were when it was y0: g(., y0) = g(x, y)."""
    return consistent(model, x, y0, np.zeros_like(y0), model.level(x, y))[0]


@dataclass(frozen=True, eq=False)
class _Carried:
    model: Model
    density: Density
    y0: NDArray[np.float64]
    y: NDArray[np.float64]

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        before = origins(self.model, x, self.y, self.y0)
        ratio = self.model.jacobians(x, self.y)[0] / self.model.jacobians(before, self.y0)[0]
        return np.asarray(self.density.density(before) * np.abs(ratio[:, 0, 0]))
