"""Mean-field PDE, solved by finite volumes on a fixed grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from dincl import checks
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from meanfield.density.density import product_points
from meanfield.density.panels import Panels
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
from meanfield.solvers.arguments import check_model, checked_start
from meanfield.solvers.ode import solve_weighted
from meanfield.solvers.result import SolverResult, SolverWork, delivered, energies

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.density.density import Density
    from meanfield.kernels.program import Program
    from meanfield.model.model import Model

    Floats = NDArray[np.float64]
    Edges = tuple[Floats, ...]

MAX_GRID_STEPS = 200_000
# Cells per axis: at least, and at most for one and for two axes. Cells up to which what depends on their midpoints
# alone is kept in memory.
MIN_CELLS, MAX_CELLS, MOST_KEPT = 8, (1_000_000, 2_000), 65_536
# Coarse run that finds the box of the grid: Gauss points per axis and piece, points per axis all over the box of the
# density, output times, tolerance, most steps. Its steps are of order 8: a motion that needs more of them needs more
# steps on a grid than are allowed.
COARSE_NODES, COARSE_POINTS, COARSE_TIMES, COARSE_TOLERANCE, COARSE_STEPS = 16, 17, 128, 1e-5, 10_000
# Margin of the box on each side. Relative to the box, for the error of the coarse run; in cells, because numerical
# diffusion carries more than 1e-9 of the mass at most 7 cells past a jump (measured). On coarse grids at most the box.
MARGIN, MARGIN_CELLS, MAX_MARGIN = 0.1, 8, 1.0
# Gauss points per axis and smooth piece of a cell. They are exact for polynomials of degree 9, so that the error of a
# cell average is far below the error of the scheme.
GAUSS_POINTS = 5
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
    """Solution of the mean-field PDE (5.42) on a fixed grid.

    Parameters
    ----------
    edges
        edges of the cells, one array per axis.
    f
        averages of the density over the cells, (K, cells) or (K, cells, cells), >= 0.
    """

    edges: Edges
    f: Floats

    def mass(self) -> Floats:
        """Compute the integral of f at the output times, (K,): 1 to rounding."""
        return np.asarray(self._weights().sum(axis=1))

    def mean(self) -> Floats:
        """Compute the integral of x f, (K, nx), by the midpoints of the cells."""
        return np.asarray(self._weights() @ midpoints(self.edges))

    def second_moment(self) -> Floats:
        """Compute the integral of x x^T f, (K, nx, nx), by the midpoints of the cells: of second order."""
        x = midpoints(self.edges)
        return np.asarray(np.einsum("kq,qi,qj->kij", self._weights(), x, x, optimize=True))

    def energy(self) -> Floats:
        """Compute the total energy (5.50) at the output times, (K,)::

        E = |y'|^2/2 + W0(y) + int (m/2 |Phi[y']|^2 + W1 + 1/2 int V(x' - x) f(x') dx') f(x) dx
        """
        x, found = midpoints(self.edges), []
        for y, v, weights in zip(self.y, self.v, self._weights(), strict=True):
            X, w = x[weights > 0], weights[weights > 0]
            found.append(sum(energies(self.model, X, w, self.model.phi(X, y) @ v, y, v)))
        return np.array(found)

    def density(self, k: int) -> Panels:
        """Return the density at the output time k, constant on cells, for ``w1``.

        Raises
        ------
        InvalidProblem
            in two dimensions, or if k is no index of an output time; negative indices count from the end.
        """
        k = self._output_index(k)
        if len(self.edges) > 1:
            raise InvalidProblem("density(k) on a grid of two axes: must be of one; f holds the averages")
        return Panels.piecewise_constant(self.edges[0], self.f[k])

    def _size(self) -> str:
        return f"{' x '.join(str(len(e) - 1) for e in self.edges)} cells"

    def _weights(self) -> Floats:
        """Return the mass of each cell at the output times, (K, number of cells)."""
        return self.f.reshape(len(self.f), -1) * float(spacings(self.edges).prod())


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
    box = swept_box(model, density, y, v, float(times[-1]), n) if bounds is None else _box(bounds, model.nx)
    edges = tuple(np.linspace(lower, upper, n + 1) for lower, upper in box.T)
    grid = _grid(model, edges, _initial_averages(edges, density), np.concatenate([y, v]))
    return delivered(_run(model, edges, grid, times), raises)


def _grid(model: Model, edges: Edges, f: Floats, z: Floats) -> Grid:
    """Set up a run; InvalidProblem if the model cannot be evaluated on the grid at the start."""
    middles = [(e[1:] + e[:-1]) / 2 for e in edges]
    centres = midpoints(edges)
    faces = [product_points([*middles[:a], edges[a], *middles[a + 1 :]]) for a in range(len(edges))]
    n0, n1 = (1, *f.shape)[-2:]
    keeps = len(centres) <= MOST_KEPT
    blocks = [-(-len(points) // BLOCK) if keeps else 1 for points in (centres, *faces)]
    box = [(float(e[0]), float(e[-1])) for e in edges]
    refusal = f"y0 = {checks.describe(z[: model.ny])}: the model must hold on the whole grid {box} (5.5)"
    try:
        gX, _ = model.jacobians(centres[f.argmax()][None], z[: model.ny])
    except StepFailure as error:
        raise InvalidProblem(f"{refusal}; {error.detail}") from error
    programs = [_across(model, axis).with_workspace(k) for axis, k in enumerate(blocks[1:])]
    grid = Grid(
        measure=measure(model, np.empty(f.size), float(np.sign(np.linalg.det(gX[0]))), blocks[0]),
        centres=centres,
        keeps=keeps,
        across0=programs[0],
        across1=programs[-1],
        faces0=faces[0],
        faces1=faces[-1],
        spacing=spacings(edges)[[0, -1]],
        volume=float(spacings(edges).prod()),
        f=np.empty((3, n0, n1)),
        z=np.empty((3, z.size)),
        speed0=np.zeros((2, n0 + 1, n1)),
        speed1=np.zeros((2, n0, n1 + 1)),
        rate=np.zeros((4, z.size)),
        line=np.empty((4, n1 + 1)),
    )
    grid.f[0], grid.z[0] = f.reshape(n0, n1), z
    code = advance(grid, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0, 1)[0]
    if code != REACHED:
        raise InvalidProblem(f"{refusal}; {FAILURES[code][1]}")
    return grid


@lru_cache(maxsize=256)
def _across(model: Model, axis: int) -> Program:
    """Build (Phi(X, y) v)_axis (5.9)."""
    ca, e = library(), model.expressions
    return program(e.X, ca.SX(0, 1), ca.vertcat(e.y, e.v), [ca.mtimes(e.phi, e.v)[axis]])


def _run(model: Model, edges: Edges, grid: Grid, times: Floats) -> GridMotion:
    """Advance a run to the last output time, or until it fails."""
    ny, end, shape = model.ny, float(times[-1]), tuple(len(e) - 1 for e in edges)
    now, dt, blocked, size, steps = 0.0, end / max(shape), 0.0, 0.0, 0
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
    work = SolverWork(grid.f[0].size + 2 * ny, steps, 1 + len(START_WEIGHTS) * steps)
    return GridMotion(
        model=model,
        t=times[: len(f)],
        y=values[:, :ny],
        v=values[:, ny:],
        status=status,
        detail=detail,
        work=work,
        edges=edges,
        f=np.array(f).reshape(-1, *shape),
    )


def _box(bounds: ArrayLike, nx: int) -> Floats:
    """Return lower and upper corner of the grid, (2, nx)."""
    given = checks.array("bounds", bounds)
    box = checks.shaped("bounds", given, (2,) if nx == 1 and given.ndim == 1 else (2, nx)).reshape(2, nx)
    if not (box[0] < box[1]).all():
        raise InvalidProblem(f"bounds = {checks.describe(bounds)}: the lower corner must be below the upper one")
    return box


def _initial_averages(edges: Edges, density: Density) -> Floats:
    """Compute cell averages of the density, scaled to mass 1; InvalidProblem if their mass is not 1 to 1e-8."""
    found = averages(edges, density)
    mass = found.sum() * spacings(edges).prod()
    if not abs(mass - 1) <= NEGLIGIBLE_MASS:
        raise InvalidProblem(
            f"bounds hold {mass:.9g} of the mass of density: must hold all of it, on cells that resolve it"
        )
    return np.asarray(found / mass)


def swept_box(model: Model, density: Density, y: Floats, v: Floats, end: float, cells: int) -> Floats:
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


def spacings(edges: Edges) -> Floats:
    """Return the width of the cells per axis."""
    return np.array([(e[-1] - e[0]) / (len(e) - 1) for e in edges])


def midpoints(edges: Edges) -> Floats:
    """Return the midpoints of the cells, (number of cells, axes)."""
    return product_points([(e[1:] + e[:-1]) / 2 for e in edges])


def averages(edges: Edges, density: Density) -> Floats:
    """Compute cell averages of a density by Gauss quadrature; cells are split where the density is not smooth."""
    ends = zip(density.lower, density.upper, strict=True)
    rules = [_rule(e, [*end, *density.breaks], end) for e, end in zip(edges, ends, strict=True)]
    values = density.density(product_points([points for points, _, _ in rules]))
    total = values.reshape([len(points) for points, _, _ in rules])
    for axis, (_, weights, first) in enumerate(rules):
        moved = np.moveaxis(total, axis, -1) * weights
        total = np.moveaxis(np.add.reduceat(moved, first, axis=-1), -1, axis)
    return np.asarray(total / spacings(edges).prod())


def _rule(edges: Floats, cuts: list[float], ends: tuple[float, float]) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Compute Gauss points, their weights (0 outside ``ends``), and the index of the first point of each cell."""
    pieces = np.union1d(edges, [cut for cut in cuts if edges[0] < cut < edges[-1]])
    middle, half = (pieces[1:] + pieces[:-1]) / 2, np.diff(pieces) / 2
    gauss, gauss_weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    inside = (ends[0] < middle) & (middle < ends[1])
    points, weights = middle[:, None] + half[:, None] * gauss, (inside * half)[:, None] * gauss_weights
    return points.ravel(), weights.ravel(), np.searchsorted(pieces, edges[:-1]) * GAUSS_POINTS
