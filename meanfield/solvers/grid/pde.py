"""The mean-field PDE by finite volumes on a grid that stays where it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl import checks
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.errors import SolveFailed
from meanfield.solvers.arguments import checked_start, model_given
from meanfield.solvers.grid.bounds import swept_box
from meanfield.solvers.grid.cells import CellGrid
from meanfield.solvers.grid.motion import GridMotion
from meanfield.solvers.grid.run import GridRun
from meanfield.solvers.grid.step import NEGLIGIBLE, GridState, GridSystem
from meanfield.solvers.motion import SolverWork

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.density.density import Density
    from meanfield.model.model import Model

FEWEST_CELLS, MOST_CELLS = 8, (1_000_000, 2_000)


def solve_pde(
    model: Model,
    density: Density,
    y0: ArrayLike,
    v0: ArrayLike,
    t: ArrayLike,
    cells: int = 400,
    bounds: ArrayLike | None = None,
    *,
    throw: bool = True,
) -> GridMotion:
    """Solve the mean-field PDE (5.42) in one or two dimensions::

        m_eff(f, y) y'' = F_eff(f, y, y'),   f_t + div(f Phi(x, y)[y']) = 0,   f(0) = density

    Conservative finite volumes: MUSCL with the monotonised central limiter, upwind fluxes with Phi[y'] at the middle of
    the faces, integrals as sums of average times value at the midpoint, all of second order; the third-order SSP
    Runge-Kutta method for (f, y, y') together. The walls are closed: mass is kept to rounding. With density 0 <= f the
    limited values at the two faces of a cell are >= 0 and add up to 2 f per axis, so that an Euler step takes at most
    dt sum_axes 2 max(u_upper, -u_lower, 0)/h of it: a step in which this exceeds 1 in any stage is taken again,
    shorter, and f >= 0 always. The estimated errors of y and y' over the run are kept below 1/cells^2 of their size.

    Parameters
    ----------
    density
        initial probability density, nx = 1 or 2.
    y0, v0
        (ny,) macroscopic component and its velocity.
    t
        (K,) times to keep; the run starts at 0.
    cells
        cells per axis, at least 8.
    bounds
        lower and upper corner of the grid, (2, nx), or (2,) in one dimension; None: the box that a coarse run of the
        characteristics sweeps, and a margin.
    throw
        whether a failed run raises; else the result up to then comes back with its status.

    Raises
    ------
    InvalidProblem
        if an argument cannot be right, also if bounds do not hold the initial density.
    SolveFailed
        if det dg/dX changes its sign, numbers stop being finite, the density reaches a wall (LEFT_GRID: more than 1e-8
        of the mass would have left), or the steps get too short or too many.

    Source: (5.42).
    """
    model_given(model)
    raises = checks.flag("throw", throw)
    checks.integer("model.nx", model.nx, least=1, most=len(MOST_CELLS))
    y, v, times = checked_start(model, density, y0, v0, t)
    n = checks.integer("cells", cells, least=FEWEST_CELLS, most=MOST_CELLS[model.nx - 1])
    end = float(times[-1])
    box = swept_box(model, density, y, v, end, n) if bounds is None else _box(bounds, model.nx)
    grid = CellGrid(tuple(np.linspace(lower, upper, n + 1) for lower, upper in box.T))
    run = _begun(model, grid, GridState(_initial(grid, density), y, v), end)
    result = _followed(run, times)
    if raises and not result.status:
        raise SolveFailed(result.status, result.detail, result)
    return result


def _begun(model: Model, grid: CellGrid, start: GridState, end: float) -> GridRun:
    """A run at its start, where the model must hold."""
    try:
        gX, _ = model.jacobians(grid.centres[start.f.argmax()][None], start.y)
        stepper = GridSystem(model, grid, orientation=float(np.sign(np.linalg.det(gX[0]))))
        rate = stepper.rate(start)
    except StepFailure as error:
        box = [(float(edges[0]), float(edges[-1])) for edges in grid.edges]
        message = f"y0 = {checks.describe(start.y)}: the model must hold on the whole grid {box} (5.5); {error.detail}"
        raise InvalidProblem(message) from error
    return GridRun(stepper, start, rate, end, dt=end / max(grid.shape))


def _followed(run: GridRun, times: NDArray[np.float64]) -> GridMotion:
    """The run at the times to keep, as far as it gets."""
    kept: list[GridState] = []
    status, detail = Status.SUCCESS, ""
    try:
        for time in times:
            run.go_to(float(time))
            kept.append(run.state)
    except StepFailure as stop:
        status, detail = stop.status, f"At t = {run.now:g}: {stop.detail}"
    return _result(run, kept, times[: len(kept)], status, detail)


def _result(run: GridRun, kept: list[GridState], t: NDArray[np.float64], status: Status, detail: str) -> GridMotion:
    grid, ny = run.stepper.grid, run.stepper.model.ny
    return GridMotion(
        model=run.stepper.model,
        t=t,
        y=np.array([z.y for z in kept]).reshape(-1, ny),
        v=np.array([z.v for z in kept]).reshape(-1, ny),
        edges=grid.edges,
        f=np.array([z.f for z in kept]).reshape(-1, *grid.shape),
        status=status,
        detail=detail,
        work=SolverWork(unknowns=run.state.f.size + 2 * ny, steps=run.steps, evaluations=run.evaluations, newton=0),
    )


def _box(bounds: ArrayLike, nx: int) -> NDArray[np.float64]:
    """Lower and upper corner of the grid, (2, nx)."""
    given = checks.array("bounds", bounds)
    box = checks.shaped("bounds", given, (2,) if nx == 1 and given.ndim == 1 else (2, nx)).reshape(2, nx)
    if not (box[0] < box[1]).all():
        raise InvalidProblem(f"bounds = {checks.describe(bounds)}: the lower corner must be below the upper one")
    return box


def _initial(grid: CellGrid, density: Density) -> NDArray[np.float64]:
    """Averages over the cells, made to have the mass 1 that quadrature gives them to its error."""
    averages = grid.averages(density)
    mass = averages.sum() * grid.volume
    if not abs(mass - 1) <= NEGLIGIBLE:
        raise InvalidProblem(
            f"bounds hold {mass:.9g} of the mass of density: must hold all of it, on cells that resolve it"
        )
    return np.asarray(averages / mass).reshape(len(grid.edges[0]) - 1, -1)
