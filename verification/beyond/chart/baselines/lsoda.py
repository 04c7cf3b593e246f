"""LSODA on the penalty form: a general solver of stiff ordinary differential equations."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.checks import number
from dincl.constraints.selection import Candidates
from dincl.errors import StepFailure
from dincl.norms import longest
from verification.beyond.chart.baselines.kept import Kept

Floats = NDArray[np.float64]
# The tolerance of the integrator over ``tol``: its errors add up, and should not be seen beside the overlaps.
TIGHTER = 0.01
# The longest step over the time of the run. A solver that chooses its steps sees a contact only once a step ends in it,
# and where F is constant it would step over whole discs.
LONGEST = 0.01
# LSODA takes no relative tolerance below about 100 eps; this one is above it.
SMALLEST = 1e-13


@dataclass(frozen=True)
class Lsoda(dincl.Scheme):
    """x' = F + strength sum_k max(0, -g_k) grad g_k by scipy's LSODA, strength = max_i |F_i(0, x_0)| / tol.

    Under the load of one particle the overlap of the springs is then ``tol`` at rest. LSODA chooses step, order, and
    between Adams' and stiff formulas. It is given the stiff part of the Jacobian, -strength J^T J of the overlapping
    rows: differences of the right-hand side would reach across overlaps this small. It is dense, and a factorisation
    costs (N d)^3.

    Parameters
    ----------
    tol
        Overlap of one loaded contact [length]; the tolerances of the integrator are a hundredth of it.

    Source: (2.2), section 1.1.3; A. C. Hindmarsh, ODEPACK (1983).
    """

    tol: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", number("tol", self.tol, positive=True))

    def run(self, problem: dincl.Problem, times: Floats) -> dincl.RunOutcome:
        """Go from step to step of LSODA; output states come from its dense output."""
        kept = Kept(problem, times)
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                _integrate(problem, self.tol, float(times[-1]), kept)
        except StepFailure as failure:
            return kept.outcome(failure)
        return kept.outcome()


def _integrate(problem: dincl.Problem, tol: float, end: float, kept: Kept) -> None:
    from scipy.integrate import LSODA

    shape = problem.x0.shape
    for t in kept.due(0.0):
        kept.keep(float(t), problem.x0)
    if end == 0:
        return
    within, step = max(TIGHTER * tol, SMALLEST), LONGEST * end
    springs = _Springs(problem, tol, step, kept)
    solver = LSODA(springs, 0.0, problem.x0.ravel(), end, rtol=within, atol=within, max_step=step, jac=springs.jacobian)
    while solver.status == "running":
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of what ends the run, which its Status says
            message = solver.step()
        if solver.status == "failed":
            raise StepFailure(dincl.Status.NOT_CONVERGED, f"LSODA stopped at t = {solver.t:.6g}: {message}")
        kept.work.steps += 1
        due = kept.due(solver.t)
        if len(due):
            for t, x in zip(due, solver.dense_output()(due).T, strict=True):
                kept.keep(float(t), x.reshape(shape))


class _Springs:
    """The right-hand side on flat states (N d,), and the stiff part of its Jacobian."""

    def __init__(self, problem: dincl.Problem, tol: float, longest_step: float, kept: Kept) -> None:
        speed = longest(problem.velocity(0.0, problem.x0)) or 1.0
        self._shape, self._kept = problem.x0.shape, kept
        self._candidates, self._search_radius = Candidates(problem.constraints, kept.work), longest_step * speed
        self._strength = speed / tol

    def __call__(self, t: float, flat: Floats) -> Floats:
        x = flat.reshape(self._shape)
        velocity = self._kept.velocity(t, x).ravel()
        rows = self._candidates.select(t, x, self._search_radius).at(t)
        overlap = np.maximum(-rows.values(x), 0.0)
        if not overlap.any():
            return velocity
        moved: Floats = velocity + self._strength * (overlap @ rows.jacobian(x))
        return moved

    def jacobian(self, t: float, flat: Floats) -> Floats:
        """Return -strength sum_k grad g_k grad g_k^T over the overlaps, shape (N d, N d)."""
        self._kept.work.count_call("lsoda", 1)
        x = flat.reshape(self._shape)
        rows = self._candidates.select(t, x, self._search_radius).at(t)
        gradients = rows.jacobian(x)[rows.values(x) < 0]
        return np.asarray(-self._strength * (gradients.T @ gradients).toarray())
