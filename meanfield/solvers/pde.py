"""Mean-field PDE, solved by finite volumes on a fixed grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from dincl import checks
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.density import Panels
from meanfield.forces import measure
from meanfield.kernels.grid import (
    AT_WALLS,
    NEGLIGIBLE_MASS,
    NO_FORCE,
    NO_SPEED,
    REACHED,
    SINGULAR,
    START_WEIGHTS,
    TOO_MANY,
    TOO_SHORT,
    Grid,
    advance,
)
from meanfield.kernels.program import BLOCK
from meanfield.model.state import State
from meanfield.model.symbolic import library, program
from meanfield.solvers.ode import solve_weighted
from meanfield.solvers.result import SolverResult, SolverWork, checked_limit, delivered, total_energy

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats
    from meanfield.density import Density
    from meanfield.kernels.program import Program
    from meanfield.model.model import Model

MAX_GRID_STEPS = 200_000
MIN_CELLS, MAX_CELLS = 8, 100_000
# Coarse run that finds the box of the grid: Gauss points per piece, points all over the box of the density, output
# times, tolerance, most steps. Its steps are of order 8: a motion that needs more of them needs more steps on a grid
# than are allowed.
COARSE_NODES, COARSE_POINTS, COARSE_TIMES, COARSE_TOLERANCE, COARSE_STEPS = 16, 17, 128, 1e-5, 10_000
# Margin of the box on each side. Relative to the box, for the error of the coarse run; in cells, because numerical
# diffusion carries more than 1e-9 of the mass at most 7 cells past a jump (measured). On coarse grids at most the box.
MARGIN, MARGIN_CELLS, MAX_MARGIN = 0.1, 8, 1.0
# Status and detail of a run that an advance ended.
FAILURES = {
    TOO_SHORT: (Status.STEP_TOO_SMALL, "the next step would have the length {dt:g}."),
    AT_WALLS: (Status.LEFT_GRID, "the walls held back {blocked:.1e} of the mass."),
    SINGULAR: (
        Status.SINGULAR,
        f"det dg/dX is zero or changed its sign for more than {NEGLIGIBLE_MASS:g} of the mass.",
    ),
    NO_FORCE: (Status.NON_FINITE, "the effective mass or force is not finite."),
    NO_SPEED: (Status.NON_FINITE, "a speed on the grid is not finite."),
    TOO_MANY: (Status.TOO_MANY_STEPS, "{steps} steps; at this rate the run takes {total}, at most {most} are allowed."),
}


@dataclass(frozen=True, eq=False, repr=False)
class GridMotion(SolverResult):
    """Solution of the mean-field PDE (5.42) on a fixed grid of a line.

    Parameters
    ----------
    edges
        edges of the cells (cells + 1,), equidistant.
    f
        averages of the density over the cells, (K, cells), >= 0.
    """

    edges: Floats
    f: Floats

    def mass(self) -> Floats:
        """Compute the integral of f at the output times, (K,): 1 to rounding."""
        return np.asarray(self._weights().sum(axis=1))

    def mean(self) -> Floats:
        """Compute the integral of x f, (K, 1), by the midpoints of the cells."""
        return np.asarray(self._weights() @ midpoints(self.edges)[:, None])

    def second_moment(self) -> Floats:
        """Compute the integral of x^2 f, (K, 1, 1), by the midpoints of the cells: of second order."""
        return np.asarray(self._weights() @ midpoints(self.edges)[:, None] ** 2)[:, :, None]

    def energy(self) -> Floats:
        """Compute the total energy (5.50) at the output times, (K,)::

        E = |y'|^2/2 + W0(y) + int (m/2 |Phi[y']|^2 + W1 + 1/2 int V(x' - x) f(x') dx') f(x) dx
        """
        x, found = midpoints(self.edges)[:, None], []
        for y, v, weights in zip(self.y, self.v, self._weights(), strict=True):
            X, w = x[weights > 0], weights[weights > 0]
            found.append(total_energy(self.model, X, w, self.model.phi(X, y) @ v, y, v))
        return np.array(found)

    def density(self, k: int) -> Panels:
        """Return the density at the output time k, constant on cells, for ``w1``; negative k count from the end.

        Raises
        ------
        InvalidProblem
            if k is no index of an output time.
        """
        count = len(self.t)
        if count == 0:
            raise InvalidProblem(f"k = {checks.describe(k)}: the run ended before its first output time")
        f = self.f[checks.integer("k", k, least=-count, most=count - 1)]
        return Panels(self.edges, f[:, None] / (f @ np.diff(self.edges)))

    def _size(self) -> str:
        return f"{len(self.edges) - 1} cells"

    def _weights(self) -> Floats:
        """Return the mass of each cell at the output times, (K, cells)."""
        return self.f * spacing(self.edges)


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
    """Solve the mean-field PDE (5.42) on a line::

        m_eff(f, y) y'' = F_eff(f, y, y'),   f_t + div(f Phi(x, y)[y']) = 0,   f(0) = density

    In space: conservative finite volumes of second order, MUSCL with the monotonised central limiter, upwind fluxes
    with Phi[y'] at the faces, integrals as sums of average times value at the midpoint. In time: the third-order SSP
    Runge-Kutta method for (f, y, y') together. The walls are closed, so that mass is conserved to rounding. For f >= 0
    the limited values at the two faces of a cell are >= 0 and their sum is 2 f; the outflow of an Euler step is at most
    the fraction dt 2 max(u_right, -u_left, 0)/h of f. A step for which this fraction exceeds 1 in a stage is repeated
    with a shorter dt, so that f stays >= 0. The estimated errors of y and y' over the run are kept below 1/cells^2 of
    their size.

    Parameters
    ----------
    density
        initial probability density, nx = 1.
    y0, v0
        (ny,) macroscopic component and its velocity.
    t
        (K,) output times, >= 0 and increasing; the run starts at 0.
    cells
        number of cells, 8 to 100 000.
    bounds
        ends of the grid, (2,); None: the interval that a coarse run of the characteristics sweeps, with a margin.
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
    raises = checks.flag("throw", throw)
    y, v, times = checked_limit(model, density, y0, v0, t)
    if model.nx > 1:
        raise InvalidProblem(f"model.nx = {model.nx}: must be 1 on a grid; solve_characteristics takes 1 to 3")
    n = checks.integer("cells", cells, least=MIN_CELLS, most=MAX_CELLS)
    if bounds is None:
        lower, upper = swept(model, density, y, v, float(times[-1]), n)
    else:
        lower, upper = checks.shaped("bounds", bounds, (2,))
        if not lower < upper:
            raise InvalidProblem(f"bounds = {checks.describe(bounds)}: the lower one must be below the upper one")
    edges = np.linspace(lower, upper, n + 1)
    grid = _grid(model, edges, _initial_averages(edges, density), np.concatenate([y, v]))
    return delivered(_run(model, edges, grid, times), raises)


def _grid(model: Model, edges: Floats, f: Floats, z: Floats) -> Grid:
    """Set up a run; InvalidProblem if the model cannot be evaluated on the grid at the start."""
    n, centres = len(f), midpoints(edges)[:, None]
    box = (float(edges[0]), float(edges[-1]))
    refusal = f"y0 = {checks.describe(z[: model.ny])}: the model must hold on the whole grid {box} (5.5)"
    try:
        gX, _ = model.jacobians(centres[f.argmax()][None], z[: model.ny])
    except StepFailure as error:
        raise InvalidProblem(f"{refusal}; {error.detail}") from error
    grid = Grid(
        measure=measure(model, np.empty(n), float(np.sign(gX[0, 0, 0])), -(-n // BLOCK)),
        centres=centres,
        across=_across(model).with_workspace(-(-(n + 1) // BLOCK)),
        faces=edges[:, None],
        spacing=spacing(edges),
        f=np.empty((3, n)),
        z=np.empty((3, z.size)),
        speed=np.zeros((2, n + 1)),
        rate=np.zeros((4, z.size)),
        line=np.empty((2, n + 1)),
    )
    grid.f[0], grid.z[0] = f, z
    code = advance(grid, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0, 1)[0]
    if code != REACHED:
        raise InvalidProblem(f"{refusal}; {FAILURES[code][1]}")
    return grid


@lru_cache(maxsize=256)
def _across(model: Model) -> Program:
    """Build Phi(X, y) v (5.9)."""
    ca, e = library(), model.expressions
    return program(e.X, ca.SX(0, 1), ca.vertcat(e.y, e.v), [ca.mtimes(e.phi, e.v)])


def _run(model: Model, edges: Floats, grid: Grid, times: Floats) -> GridMotion:
    """Advance a run to the last output time, or until it fails."""
    ny, end, n = model.ny, float(times[-1]), len(edges) - 1
    now, dt, blocked, size, steps = 0.0, end / n, 0.0, 0.0, 0
    f, z = [], []
    status, detail = Status.SUCCESS, ""
    for time in times:
        code, now, dt, blocked, size, steps = advance(
            grid, now, float(time), end, dt, blocked, size, steps, MAX_GRID_STEPS
        )
        if code != REACHED:
            status, text = FAILURES[code]
            total = f"{steps / (now / end):.1e}" if now > 0 else "infinitely many"
            text = text.format(dt=dt, blocked=blocked, steps=steps, total=total, most=MAX_GRID_STEPS)
            detail = f"At t = {now:g}: {text}"
            break
        f.append(grid.f[0].copy())
        z.append(grid.z[0].copy())
    values = np.array(z).reshape(-1, 2 * ny)
    work = SolverWork(n + 2 * ny, steps, 1 + len(START_WEIGHTS) * steps)
    return GridMotion(
        model=model,
        t=times[: len(f)],
        y=values[:, :ny],
        v=values[:, ny:],
        status=status,
        detail=detail,
        work=work,
        edges=edges,
        f=np.array(f).reshape(-1, n),
    )


def _initial_averages(edges: Floats, density: Density) -> Floats:
    """Compute cell averages of the density, scaled to mass 1; InvalidProblem if the grid does not hold its mass."""
    F = density.panels.distribution(edges)
    if not abs(F[-1] - F[0] - 1) <= NEGLIGIBLE_MASS:
        raise InvalidProblem(f"bounds hold {F[-1] - F[0]:.9g} of the mass of density: must hold all of it")
    found = np.maximum(np.diff(F), 0.0)
    return np.asarray(found / (found.sum() * spacing(edges)))


def swept(model: Model, density: Density, y: Floats, v: Floats, end: float, cells: int) -> tuple[float, float]:
    """Compute an interval that contains the density until ``end``, with a margin.

    Gauss points of the density determine y. Points all over the box of the density move along with weight 0; the result
    contains their paths. If the run fails, for example because one of them becomes singular, the result contains the
    paths until then.
    """
    nodes, weights = density.nodes(COARSE_NODES)
    tracers = np.linspace(density.lower, density.upper, COARSE_POINTS)
    start = State(X=np.concatenate([nodes, tracers]), y=y, v=v)
    all_weights = np.concatenate([weights, np.zeros(len(tracers))])
    t = np.linspace(0.0, end, COARSE_TIMES + 1)
    motion = solve_weighted(model, start, all_weights, t, COARSE_TOLERANCE, throw=False, most_steps=COARSE_STEPS)
    paths = motion.X[:, len(nodes) :]
    lower, upper = float(paths.min()), float(paths.max())
    by_cells = MARGIN_CELLS / (cells - 2 * MARGIN_CELLS) if cells > 3 * MARGIN_CELLS else MAX_MARGIN
    margin = max(MARGIN, by_cells) * (upper - lower)
    return lower - margin, upper + margin


def spacing(edges: Floats) -> float:
    """Return the width of a cell."""
    return float((edges[-1] - edges[0]) / (len(edges) - 1))


def midpoints(edges: Floats) -> Floats:
    """Return the midpoints of the cells, (cells,)."""
    return np.asarray((edges[1:] + edges[:-1]) / 2)
