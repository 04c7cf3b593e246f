"""The simplest description that answers: ODE, moments, characteristics or PDE in place of N particles."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, cast, get_args

import numpy as np

from dincl.checks import describe, integer
from dincl.equivalence.bias import check_tolerance
from dincl.equivalence.bounded import ErrorBounds, NoQuantity, RunCost, Solved, largest_difference, reference, timed
from dincl.equivalence.paired import LOOKS, equivalence
from dincl.equivalence.search import Row, Simplest, compared, search
from dincl.errors import InvalidProblem
from meanfield.errors import SolveFailed
from meanfield.model.closure import obstacle
from meanfield.model.state import State
from meanfield.solvers.arguments import TIGHTEST, check_model, check_state, checked_start, output_times
from meanfield.solvers.arguments import tolerance as checked_tol
from meanfield.solvers.characteristics import Flow, solve_characteristics
from meanfield.solvers.dae import solve_dae
from meanfield.solvers.grid.grid_motion import GridMotion
from meanfield.solvers.grid.pde import solve_pde
from meanfield.solvers.moments import MomentMotion, sample_moments, solve_moments
from meanfield.solvers.ode import solve_ode
from meanfield.solvers.push_forward import push_forward
from meanfield.solvers.reduction import Positions, reduce
from meanfield.transport.wasserstein import w1

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.density.density import Density
    from meanfield.model.model import Model

Quantity = Literal["y", "v", "mean", "density"]
FULL, CELLS = "particles with multipliers", (50, 200)
# A tolerance of a solver is divided by this to refine it, the number of cells multiplied by the other.
TIGHTER, FINER = 10.0, 2
# The first draw of a confirmation, which no description was chosen by.
FRESH = 1_000_000


def simplify(
    model: Model,
    quantity: Quantity,
    tolerance: float,
    start: State,
    t: ArrayLike,
    tol: float,
    *,
    density: Density | None = None,
    runs: int | None = None,
    seed: int = 0,
) -> Simplest:
    """Find the simplest description that gives a quantity as N particles with multipliers do, within a tolerance.

    The full model is ``solve_dae``. Simpler are ``solve_ode``, with the particles in closed form too, ``solve_moments``
    and, of the density, ``solve_characteristics`` and ``solve_pde`` with 50 and 200 cells. The largest difference at
    the output times counts; it has a sign if the quantity is one number at one time.

    For the given particles a bias b is known to the error e of the full model, twice its change with a tenth of tol. A
    description is enough if |b| + e < tolerance, not enough if |b| - e > tolerance. It is also solved with a tenth of
    tol (twice the cells), and the larger bias counts. With ``runs`` each run draws its particles from the density, and
    two one-sided tests of the mean bias over the runs decide (``dincl.equivalence.paired``), with e added to the
    interval: "enough" is said of a mean bias of the tolerance in at most 5 % of the cases. The cheapest description
    that is enough runs with fresh particles before it is the answer. For few particles it may cost more than the full
    model, as ``saving`` says.

    Parameters
    ----------
    quantity
        "y" or "v": macroscopic state or its velocity; "mean": mean position; "density": W1 of the distributions.
    tolerance
        The largest bias that does not matter, > 0, in the unit of the quantity.
    start, t, tol
        As for ``solve_dae``.
    density
        Density of the particles, for the mean-field limit and for draws; None: there is none.
    runs
        The most runs, one of 64, 128, ..., 8192, each with as many particles as ``start`` has, drawn from the density;
        None: the particles of ``start``.
    seed
        Of the draws.

    Returns
    -------
    Simplest
        ``answer``, ``saving`` (CPU time; counted work: unknowns times evaluations of the right-hand side) and
        ``table``, a row for each description.

    Raises
    ------
    InvalidProblem
        If an argument is invalid.
    SolveFailed
        If the full model fails.
    """
    check_model(model)
    check_state(start)
    if quantity not in get_args(Quantity):
        raise InvalidProblem(f"quantity = {describe(quantity)}: must be one of {', '.join(get_args(Quantity))}")
    limit, tol = check_tolerance(tolerance), checked_tol(tol)
    if density is not None:
        checked_start(model, density, start.y, start.v, t)
    if runs is not None and (runs not in LOOKS or density is None):
        allowed = f"one of {', '.join(map(str, LOOKS))}, with a density to draw from"
        raise InvalidProblem(f"runs = {describe(runs)}: must be {allowed}")
    task = _Task(model, quantity, output_times(t), tol, density, start.y)
    full = task.solved(FULL, start)
    known = reference(full, task.distance)
    reasons = {name: one.obstacle(task) for name, one in DESCRIPTIONS.items()}
    decider: ErrorBounds | _Draws
    if runs is None:
        decider = ErrorBounds(known, lambda name: task.solved(name, start), task.distance, limit)
    else:
        decider = _Draws(task, start, limit, known.error, runs, integer("seed", seed, least=0))
    return search(decider, dict.fromkeys(DESCRIPTIONS, "description"), reasons)


@dataclass(frozen=True)
class _Task:
    """Question to every description."""

    model: Model
    quantity: Quantity
    t: NDArray[np.float64]
    tol: float
    density: Density | None
    y0: ArrayLike

    def solved(self, name: str, start: State) -> Solved:
        """Solve as asked for, which is timed, and finer; raises NoQuantity, of the full model SolveFailed."""
        (value, cost), seconds = timed(lambda: self.measured(name, start))
        finer, _ = self.measured(name, start, finer=True)
        return Solved((value, finer), cost._replace(seconds=seconds))

    def measured(self, name: str, start: State, *, finer: bool = False) -> tuple[object, RunCost]:
        """Return the quantity and the cost of a description; raises as ``solved``."""
        tol = max(self.tol / TIGHTER, TIGHTEST) if finer else self.tol
        solve = DESCRIPTIONS[name].solve if name != FULL else _dae
        began = time.process_time()
        try:
            result = solve(self, start, tol, FINER if finer else 1)
        except (SolveFailed, InvalidProblem) as error:
            if name == FULL:
                raise
            raise NoQuantity(str(error)) from error
        seconds = max(time.process_time() - began, 1e-9)
        return self._value(result), RunCost(seconds, float(result.work.unknowns * result.work.evaluations))

    def distance(self, first: Any, second: Any) -> float:
        """Return the largest difference at the output times."""
        if self.quantity == "density":
            return max(w1(a, b) for a, b in zip(first, second, strict=True))
        return largest_difference(first, second)

    def _value(self, result: Any) -> object:
        if self.quantity in ("y", "v"):
            return getattr(result, self.quantity)
        if self.quantity == "density":
            return [self._measure(result, k) for k in range(len(self.t))]
        if isinstance(result, GridMotion):
            return result.mean()
        if isinstance(result, MomentMotion):
            return result.mean
        return np.average(result.X, axis=1, weights=result.weights)

    def _measure(self, result: Any, k: int) -> Any:
        """Return the distribution at an output time for ``w1``; on a line exact for characteristics."""
        if isinstance(result, Flow):
            start = self.density if self.model.nx == 1 else None
            return result.measure(k) if start is None else push_forward(self.model, start, self.y0, result.y[k])
        return result.density(k) if isinstance(result, GridMotion) else result.X[k]


class _Description(NamedTuple):
    """A simpler model: why a task does not have it, "" if it does; its solution (task, start, tol, finer)."""

    obstacle: Callable[[_Task], str]
    solve: Callable[[_Task, State, float, int], Any]


def _dae(task: _Task, start: State, tol: float, finer: int) -> Any:
    return solve_dae(task.model, start, task.t, tol)


def _ode(task: _Task, start: State, tol: float, finer: int) -> Any:
    return solve_ode(task.model, start, task.t, tol)


def _closed_form(task: _Task, start: State, tol: float, finer: int) -> Any:
    return solve_ode(reduce(task.model), start, task.t, tol)


def _moments(task: _Task, start: State, tol: float, finer: int) -> Any:
    X = np.asarray(start.X)
    return solve_moments(task.model, sample_moments(X, None), start.y, start.v, task.t, tol)


def _characteristics(task: _Task, start: State, tol: float, finer: int) -> Any:
    return solve_characteristics(task.model, cast("Density", task.density), start.y, start.v, task.t, tol)


def _pde(cells: int) -> Callable[[_Task, State, float, int], Any]:
    def solve(task: _Task, start: State, tol: float, finer: int) -> Any:
        return solve_pde(task.model, cast("Density", task.density), start.y, start.v, task.t, finer * cells)

    return solve


def _no_closed_form(task: _Task) -> str:
    flows = reduce(task.model).positions is Positions.FLOW
    return "the particles do not follow from y in closed form" if flows else ""


def _no_moments(task: _Task) -> str:
    if task.quantity == "density":
        return "two moments are no density"
    why = obstacle(task.model)
    return f"the moment equations do not close: {why}" if why else ""


def _no_density(task: _Task) -> str:
    return "" if task.density is not None else "there is no density of the particles"


def _no_grid(task: _Task) -> str:
    if task.density is not None and task.model.nx > (1 if task.quantity == "density" else 2):
        return f"a grid of {task.model.nx} axes has no {task.quantity}"
    return _no_density(task)


DESCRIPTIONS = {
    "ODE": _Description(lambda _: "", _ode),
    "ODE, particles in closed form": _Description(_no_closed_form, _closed_form),
    "moments": _Description(_no_moments, _moments),
    "characteristics": _Description(_no_density, _characteristics),
    **{f"PDE, {cells} cells": _Description(_no_grid, _pde(cells)) for cells in CELLS},
}
# Those that start from the density, and are the same for all draws.
LIMITS = ("characteristics", *(f"PDE, {cells} cells" for cells in CELLS))


@dataclass
class _Draws:
    """Decisions by draws of the particles: the mean bias over runs, by two one-sided tests at a few looks."""

    task: _Task
    start: State
    tolerance: float
    error: float
    runs: int
    seed: int
    solved: dict[tuple[str, int], tuple[object, RunCost]] = field(default_factory=dict)

    def decide(self, models: Sequence[str], error: float, *, again: bool) -> list[Row]:
        """Look at the models again and again, until they are decided or have all of their runs."""
        found: dict[str, Row] = {}
        for look in (look for look in LOOKS if look <= self.runs):
            for model in models:
                if found.get(model, {"verdict": "open"})["verdict"] == "open":
                    found[model] = self._row(model, range(FRESH if again else 0, look + (FRESH if again else 0)), error)
        return [found[model] for model in models]

    def _row(self, model: str, draws: range, error: float) -> Row:
        try:
            own = [self._of(model, draw) for draw in draws]
        except NoQuantity as failure:
            return compared(model, None, cpu=np.nan, work=np.nan, runs=len(draws), reason=str(failure))
        full = [self._of(FULL, draw) for draw in draws]
        biases = np.array([self.task.distance(a, b) for (a, _), (b, _) in zip(own, full, strict=True)])
        one = equivalence(biases, self.tolerance, shares=False, level=error / len(LOOKS)).widened(self.error)
        cpu, work = (np.median([c for _, c in own], axis=0) / np.median([c for _, c in full], axis=0)).tolist()
        return compared(model, one, cpu=cpu, work=work, runs=len(draws))

    def _of(self, model: str, draw: int) -> tuple[object, RunCost]:
        """Return the quantity of a model in a draw, solved once."""
        key = (model, -1 if model in LIMITS else draw)
        if key not in self.solved:
            self.solved[key] = self.task.measured(model, self._drawn(draw))
        return self.solved[key]

    def _drawn(self, draw: int) -> State:
        count, density = len(np.asarray(self.start.X)), cast("Density", self.task.density)
        X = density.sample(np.random.default_rng([self.seed, draw]), count)
        return State(X=X, y=self.start.y, v=self.start.v)
