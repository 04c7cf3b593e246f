"""Mean-field PDE, solved by finite volumes on a fixed grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl import checks
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.density.quadrature import product_points
from meanfield.errors import SolveFailed
from meanfield.model.state import State
from meanfield.solvers.arguments import check_model, checked_start
from meanfield.solvers.grid.cells import CellGrid
from meanfield.solvers.grid.grid_motion import GridMotion
from meanfield.solvers.grid.run import GridRun
from meanfield.solvers.grid.step import NEGLIGIBLE_MASS, GridState, GridSystem
from meanfield.solvers.motion import SolverWork
from meanfield.solvers.ode import solve_weighted

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.density.density import Density
    from meanfield.model.model import Model

# Cells per axis: at least, and at most for one and for two axes.
MIN_CELLS, MAX_CELLS = 8, (1_000_000, 2_000)
# Coarse run that finds the box of the grid: Gauss points per axis and piece, points per axis all over the box of the
# density, output times, tolerance, most steps. Its steps are of order 8: a motion that needs more of them needs more
# steps on a grid than are allowed.
COARSE_NODES, COARSE_POINTS, COARSE_TIMES, COARSE_TOLERANCE, COARSE_STEPS = 16, 17, 128, 1e-5, 10_000
# Margin of the box on each side. Relative to the box, for the error of the coarse run; in cells, because numerical
# diffusion carries more than 1e-9 of the mass at most 7 cells past a jump (measured). On coarse grids at most the box.
MARGIN, MARGIN_CELLS, MAX_MARGIN = 0.1, 8, 1.0


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

    In space: conservative finite volumes of second order, MUSCL with the monotonised central limiter, upwind fluxes
    with Phi[y'] at the midpoints of the faces, integrals as sums of average times value at the midpoint. In time: the
    third-order SSP Runge-Kutta method for (f, y, y') together. The walls are closed, so that mass is conserved to
    rounding. For f >= 0 the limited values at the two faces of a cell are >= 0 and their sum is 2 f per axis; the
    outflow of an Euler step is at most the fraction dt sum_axes 2 max(u_upper, -u_lower, 0)/h of f. A step for which
    this fraction exceeds 1 in a stage is repeated with a shorter dt, so that f stays >= 0. The estimated errors of y
    and y' over the run are kept below 1/cells^2 of their size.

    Parameters
    ----------
    density
        initial probability density, nx = 1 or 2.
    y0, v0
        (ny,) macroscopic component and its velocity.
    t
        (K,) output times, >= 0 and increasing; the run starts at 0.
    cells
        cells per axis, at least 8.
    bounds
        lower and upper corner of the grid, (2, nx), or (2,) in one dimension; None: the box that a coarse run of the
        characteristics sweeps, with a margin.
    throw
        raise SolveFailed on failure; otherwise return the output times reached, with their Status.

    Raises
    ------
    InvalidProblem
        if an argument is invalid, or bounds do not contain the initial density.
    SolveFailed
        if det dg/dX changes its sign, a value is not finite, the density reaches a wall (LEFT_GRID: more than 1e-8 of
        the mass would leave the grid), or the steps become too short or too many.

    Source: (5.42).
    """
    check_model(model)
    raises = checks.flag("throw", throw)
    checks.integer("model.nx", model.nx, least=1, most=len(MAX_CELLS))
    y, v, times = checked_start(model, density, y0, v0, t)
    n = checks.integer("cells", cells, least=MIN_CELLS, most=MAX_CELLS[model.nx - 1])
    end = float(times[-1])
    box = swept_box(model, density, y, v, end, n) if bounds is None else _box(bounds, model.nx)
    grid = CellGrid(tuple(np.linspace(lower, upper, n + 1) for lower, upper in box.T))
    run = _start(model, grid, GridState(_initial_averages(grid, density), y, v), end)
    result = _run(run, times)
    if raises and not result.status:
        raise SolveFailed(result.status, result.detail, result)
    return result


def _start(model: Model, grid: CellGrid, start: GridState, end: float) -> GridRun:
    """Set up a run; InvalidProblem if the model cannot be evaluated on the grid at the start."""
    try:
        gX, _ = model.jacobians(grid.centres[start.f.argmax()][None], start.y)
        system = GridSystem(model, grid, orientation=float(np.sign(np.linalg.det(gX[0]))))
        rate = system.rate(start)
    except StepFailure as error:
        box = [(float(edges[0]), float(edges[-1])) for edges in grid.edges]
        message = f"y0 = {checks.describe(start.y)}: the model must hold on the whole grid {box} (5.5); {error.detail}"
        raise InvalidProblem(message) from error
    return GridRun(system, start, rate, end, dt=end / max(grid.shape))


def _run(run: GridRun, times: NDArray[np.float64]) -> GridMotion:
    """Advance a run to the last output time, or until it fails."""
    states: list[GridState] = []
    status, detail = Status.SUCCESS, ""
    try:
        for time in times:
            run.advance_to(float(time))
            states.append(run.state)
    except StepFailure as failure:
        status, detail = failure.status, f"At t = {run.now:g}: {failure.detail}"
    return _result(run, states, times[: len(states)], status, detail)


def _result(run: GridRun, states: list[GridState], t: NDArray[np.float64], status: Status, detail: str) -> GridMotion:
    grid, ny = run.system.grid, run.system.model.ny
    return GridMotion(
        model=run.system.model,
        t=t,
        y=np.array([z.y for z in states]).reshape(-1, ny),
        v=np.array([z.v for z in states]).reshape(-1, ny),
        edges=grid.edges,
        f=np.array([z.f for z in states]).reshape(-1, *grid.shape),
        status=status,
        detail=detail,
        work=SolverWork(unknowns=run.state.f.size + 2 * ny, steps=run.steps, evaluations=run.evaluations, newton=0),
    )


def _box(bounds: ArrayLike, nx: int) -> NDArray[np.float64]:
    """Return lower and upper corner of the grid, (2, nx)."""
    given = checks.array("bounds", bounds)
    box = checks.shaped("bounds", given, (2,) if nx == 1 and given.ndim == 1 else (2, nx)).reshape(2, nx)
    if not (box[0] < box[1]).all():
        raise InvalidProblem(f"bounds = {checks.describe(bounds)}: the lower corner must be below the upper one")
    return box


def _initial_averages(grid: CellGrid, density: Density) -> NDArray[np.float64]:
    """Compute cell averages of the density, scaled to mass 1; InvalidProblem if their mass is not 1 to 1e-8."""
    averages = grid.averages(density)
    mass = averages.sum() * grid.volume
    if not abs(mass - 1) <= NEGLIGIBLE_MASS:
        raise InvalidProblem(
            f"bounds hold {mass:.9g} of the mass of density: must hold all of it, on cells that resolve it"
        )
    return np.asarray(averages / mass).reshape(len(grid.edges[0]) - 1, -1)


def swept_box(
    model: Model, density: Density, y: NDArray[np.float64], v: NDArray[np.float64], end: float, cells: int
) -> NDArray[np.float64]:
    """Compute lower and upper corner, (2, nx), of a box that contains the density until ``end``, with a margin.

    Gauss points of the density determine y. Points all over the box of the density move along with weight 0; the result
    contains their paths. If the run fails, for example because one of them becomes singular, the result contains the
    paths until then.
    """
    nodes, weights = density.nodes(COARSE_NODES)
    axes = [np.linspace(a, b, COARSE_POINTS) for a, b in zip(density.lower, density.upper, strict=True)]
    tracers = product_points(axes)
    start = State(X=np.concatenate([nodes, tracers]), y=y, v=v)
    all_weights = np.concatenate([weights, np.zeros(len(tracers))])
    t = np.linspace(0.0, end, COARSE_TIMES + 1)
    motion = solve_weighted(model, start, all_weights, t, COARSE_TOLERANCE, throw=False, most_steps=COARSE_STEPS)
    swept = motion.X[:, len(nodes) :].reshape(-1, model.nx)
    lower, upper = swept.min(axis=0), swept.max(axis=0)
    by_cells = MARGIN_CELLS / (cells - 2 * MARGIN_CELLS) if cells > 3 * MARGIN_CELLS else MAX_MARGIN
    margin = max(MARGIN, by_cells) * (upper - lower)
    return np.array([lower - margin, upper + margin])
