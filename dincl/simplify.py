"""Which parts of a method a scene needs: simpler methods beside the full one, decided by bounds of errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe, function, instance
from dincl.equivalence.bias import check_tolerance
from dincl.equivalence.bounded import (
    ErrorBounds,
    NoQuantity,
    RunCost,
    Solved,
    largest_difference,
    reference,
    timed,
)
from dincl.equivalence.search import AND, Simplest, search
from dincl.errors import InvalidProblem
from dincl.norms import longest
from dincl.problem import Problem
from dincl.schemes.base import FixedStep, Scheme
from dincl.schemes.catch_up import CatchUp, LinearisedCatchUp, MidpointCatchUp
from dincl.schemes.event_driven import EventDriven
from dincl.schemes.pbd import PBD, SecondOrderPBD
from dincl.schemes.xpbd import XPBD
from dincl.solve import solve

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.trajectory import Trajectory

Quantity = Callable[["Trajectory"], "ArrayLike"]
Change = Callable[[Scheme], Scheme | None]
# The tolerance of the event-driven scheme is divided by this to refine it.
TIGHTER = 10.0


def simplify(
    problem: Problem,
    scheme: Scheme,
    quantity: Quantity | None,
    tolerance: float,
    t: ArrayLike,
    *,
    simpler: Mapping[str, Scheme] | None = None,
) -> Simplest:
    """Find the simplest method that gives a quantity of a scene as the full method does, within a tolerance.

    The reference is the full method with a quarter of its step, and the error of the reference twice the change from
    half of the step (for ``EventDriven``: with a tenth of the tolerance, and twice the change). A simpler method is
    compared as it runs, with its own step: its bias b is known to the error e of the reference. It is enough if
    |b| + e < tolerance, not enough if |b| - e > tolerance, and otherwise open. It also runs with half of its step, and
    the larger one of both biases counts, so that a method which agrees at one step by chance is not enough.

    What is enough alone is combined, of each kind the method that costs the least, and while the combination is not
    enough, the part with the largest bias is dropped. What is left out says why.

    Parameters
    ----------
    problem
        The scene.
    scheme
        The full method, such as ``CatchUp(1e-3, Ipopt(1e-11))``. Its parts are: the second order of ``SecondOrderPBD``
        (without it the drift, an acceleration, is a velocity: friction of 1 per unit of time takes the place of
        inertia), the projection (linearised or one sweep in place of exact), the sweeps, the step.
    quantity
        Trajectory -> a number or an array, e.g. ``lambda path: path.final[:, 1].mean()``; of an array the largest
        difference counts. None: all positions at the times t, max_i |X_i - X_i'| [length].
    tolerance
        The largest bias that does not matter, > 0, in the unit of the quantity.
    t
        Output times, as for ``solve``.
    simpler
        Your own methods by name, in place of the parts; at most one of them is the answer. Required if the scheme has
        no step, such as ``EventDriven``.

    Returns
    -------
    Simplest
        ``answer``, ``saving`` (CPU time; counted work: evaluations of the drift, projections onto single constraints,
        iterations of solvers) and ``table``, a row for each method.

    Raises
    ------
    InvalidProblem
        If an argument is invalid, or the full method fails.
    """
    instance("problem", problem, Problem, "a dincl.Problem")
    if not isinstance(scheme, FixedStep | EventDriven):
        raise InvalidProblem(f"scheme = {describe(scheme)}: must be a scheme with a step, or EventDriven(tol)")
    if quantity is not None:
        function("quantity", quantity, "a function of a Trajectory, or None for all positions")
    limit = check_tolerance(tolerance)
    parts = PARTS if simpler is None else _own(simpler)
    kinds = {name: kind for name, (kind, _) in parts.items()}
    reasons = {name: "" if change(scheme) is not None else _missing(scheme) for name, (_, change) in parts.items()}
    if simpler is None and all(reasons.values()):
        raise InvalidProblem(f"scheme = {describe(scheme)}: has no part to leave out: pass simpler = {{name: scheme}}")
    solved = partial(_solved, problem, quantity, t)
    try:
        full = solved(scheme, 4)
    except NoQuantity as failure:
        raise InvalidProblem(f"scheme = {describe(scheme)}: the full method must not fail: {failure}") from failure
    distance = largest_difference if quantity is not None else _farthest
    bounds = ErrorBounds(
        reference(full, distance), lambda name: solved(_changed(scheme, name.split(AND), parts), 2), distance, limit
    )
    return search(bounds, kinds, reasons)


def _solved(problem: Problem, quantity: Quantity | None, t: ArrayLike, scheme: Scheme, finest: int) -> Solved:
    """Run a scheme with its step, half of it, ... 1/finest of it; raises NoQuantity if one of the runs fails."""

    def run(scheme: Scheme) -> Trajectory:
        try:
            path = solve(problem, scheme, t, throw=False)
        except InvalidProblem as error:
            raise NoQuantity(str(error)) from error
        if not path.status:
            raise NoQuantity(f"{path.status.name}: {path.detail}")
        return path

    first, seconds = timed(lambda: run(scheme))
    finer = [run(one) for one in _refined(scheme, finest)]
    values = []
    for path in (first, *finer):
        value = path.x if quantity is None else np.asarray(quantity(path), dtype=np.float64)
        if not np.isfinite(value).all():
            raise InvalidProblem(f"quantity = {describe(value)}: must be finite")
        values.append(value)
    work = first.stats.drift_evaluations + first.stats.constraint_projections + first.stats.solver_iterations
    return Solved(tuple(values), RunCost(seconds, float(work)))


def _refined(scheme: Scheme, finest: int) -> list[Scheme]:
    if isinstance(scheme, EventDriven):
        return [replace(scheme, tol=scheme.tol / TIGHTER)]
    if isinstance(scheme, FixedStep):
        return [replace(scheme, dt=scheme.dt / factor) for factor in (2, 4) if factor <= finest]
    return []


def _farthest(first: object, second: object) -> float:
    """Return max_i |X_i - X_i'| over all times of states (K, N, d)."""
    moved = np.asarray(first) - np.asarray(second)
    return longest(moved.reshape(-1, moved.shape[-1]))


def _own(simpler: Mapping[str, Scheme]) -> dict[str, tuple[str, Change]]:
    """Return methods of the user as changes of one kind."""
    instance("simpler", simpler, Mapping, "a dictionary name -> scheme")
    if not simpler:
        raise InvalidProblem("simpler = {}: must have one scheme or more")
    for name, scheme in simpler.items():
        instance(f"simpler[{name!r}]", scheme, Scheme, "a scheme such as PBD(dt=1e-3)")
    return {name: ("method", partial(_instead, scheme)) for name, scheme in simpler.items()}


def _instead(scheme: Scheme, _: Scheme) -> Scheme:
    return scheme


def _changed(scheme: Scheme, names: list[str], parts: Mapping[str, tuple[str, Change]]) -> Scheme:
    """Return the scheme without the parts of these names; a change that no longer applies changes nothing."""
    for name in names:
        scheme = parts[name][1](scheme) or scheme
    return scheme


def _missing(scheme: Scheme) -> str:
    return f"{type(scheme).__name__} does not have this part"


def _without_inertia(scheme: Scheme) -> Scheme | None:
    return PBD(scheme.dt, scheme.sweeps) if isinstance(scheme, SecondOrderPBD) else None


def _linearised(scheme: Scheme) -> Scheme | None:
    exact = type(scheme) in (CatchUp, MidpointCatchUp)
    return LinearisedCatchUp(scheme.dt, scheme.projection) if exact else None  # type: ignore[attr-defined]


def _one_sweep(scheme: Scheme) -> Scheme | None:
    """Return the scheme with one sweep, PBD in place of a projection; None if it has one already."""
    if isinstance(scheme, CatchUp | MidpointCatchUp):
        return PBD(scheme.dt)
    if isinstance(scheme, PBD | XPBD | SecondOrderPBD) and scheme.sweeps > 1:
        return replace(scheme, sweeps=1)
    return None


def _longer(factor: int) -> Change:
    return lambda scheme: replace(scheme, dt=factor * scheme.dt) if isinstance(scheme, FixedStep) else None


# Each part with its kind, of which a combination has one, in the order in which they are changed.
PARTS: dict[str, tuple[str, Change]] = {
    "first order": ("order", _without_inertia),
    "linearised projection": ("projection", _linearised),
    "one sweep": ("projection", _one_sweep),
    "dt twice as long": ("step", _longer(2)),
    "dt four times as long": ("step", _longer(4)),
    "dt eight times as long": ("step", _longer(8)),
}
