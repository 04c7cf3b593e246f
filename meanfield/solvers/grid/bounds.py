"""Where a density will be carried to: the box for a grid that stays where it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meanfield.model.state import State
from meanfield.solvers.ode import solve_weighted

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from meanfield.density.density import Density
    from meanfield.model.model import Model

# A coarse run: Gauss points per axis and piece, points of the frame per axis, times looked at, tolerance, most steps. A
# motion that takes more of these, which are of order 8, takes more than are allowed on a grid.
NODES, FRAME, TIMES, TOLERANCE, STEPS = 16, 17, 128, 1e-5, 10_000
# Room on each side: relative to the box, for what a coarse run misses; and in cells, where numerical diffusion carries
# more than 1e-9 of the mass past a jump (measured: 7 cells at most). On coarse grids never more than the box itself.
MARGIN, ROOM, MOST_MARGIN = 0.1, 8, 1.0


def swept_box(
    model: Model, density: Density, y: NDArray[np.float64], v: NDArray[np.float64], end: float, cells: int
) -> NDArray[np.float64]:
    """Lower and upper corner, (2, nx), of a box that holds the density from time 0 to ``end``, with a margin.

    Gauss points of the density move y; points all over its box are carried along, with weight 0. A run that fails, also
    because one of these becomes singular, gives the box until then.
    """
    nodes, weights = density.nodes(NODES)
    axes = [np.linspace(a, b, FRAME) for a, b in zip(density.lower, density.upper, strict=True)]
    frame = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, model.nx)
    start = State(X=np.concatenate([nodes, frame]), y=y, v=v)
    all_weights = np.concatenate([weights, np.zeros(len(frame))])
    t = np.linspace(0.0, end, TIMES + 1)
    motion = solve_weighted(model, start, all_weights, t, TOLERANCE, throw=False, most_steps=STEPS)
    swept = motion.X[:, len(nodes) :].reshape(-1, model.nx)
    lower, upper = swept.min(axis=0), swept.max(axis=0)
    by_cells = ROOM / (cells - 2 * ROOM) if cells > 3 * ROOM else MOST_MARGIN
    margin = max(MARGIN, by_cells) * (upper - lower)
    return np.array([lower - margin, upper + margin])
