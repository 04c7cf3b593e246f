"""Particles and their constraint in a plane: the picture of a motion in one and two dimensions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import StepFailure
from meanfield import plotting

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from meanfield.model.model import Model

# Points per axis on which the levels of g are drawn, and room about the particles.
FINE, ROOM = 81, 0.12


def draw_particles(ax: Any, model: Model, y: NDArray[np.float64], X: NDArray[np.float64]) -> None:
    """Paths of particles X (K, N, nx) and level lines of g, which they keep to, for nx = 1, 2.

    In one dimension with one macroscopic component, the plane is that of (y, X), where a particle stays on its line;
    with several, that of their order in y[0]. In two, it is the plane of the particles, with g at the last y.
    """
    if model.nx == 2:
        plotting.draw_paths(ax, X[..., 0], X[..., 1], "Particles, and g at the last y")
        plane = _axis(X[..., 0]), _axis(X[..., 1])
        points = np.stack(np.meshgrid(*plane), axis=-1).reshape(-1, 2)
        values = _levels(model, points, y[-1])
        plotting.draw_levels(ax, plane, [v.reshape(FINE, FINE) for v in values.T], ("$X_1$", "$X_2$"))
        ax.set_aspect("equal")
        return
    states = np.repeat(y[:, :1], X.shape[1], axis=1)
    plotting.draw_paths(ax, states, X[..., 0], "Particles, each on its level of g")
    plane = _axis(states), _axis(X[..., 0])
    levels = []
    if model.ny == 1:
        columns = [_levels(model, plane[1][:, None], np.array([value])) for value in plane[0]]
        levels = [np.concatenate(columns, axis=1)]
    plotting.draw_levels(ax, plane, levels, ("y" if model.ny == 1 else "$y_1$", "X"))


def _axis(values: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = float(values.min()), float(values.max())
    room = ROOM * ((high - low) or 1.0)
    return np.linspace(low - room, high + room, FINE)


def _levels(model: Model, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """g at points, NaN where the model has no value for one of them."""
    try:
        return model.level(x, y)
    except StepFailure:
        return np.full((len(x), model.nx), np.nan)
