"""LSODA on the penalty form: a general solver of stiff ordinary differential equations, as a baseline of the chart."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.constraints.selection import Candidates
from dincl.norms import longest

Floats = NDArray[np.float64]
# The tolerance of the integrator over ``tol``: its errors add up, and should not be seen beside the overlaps. LSODA
# takes no relative tolerance below about 100 eps; the smallest is above it.
TIGHTER, SMALLEST = 0.01, 1e-13
# The longest step over the time of the run. A solver that chooses its steps sees a contact only once a step ends in it,
# and where F is constant it would step over whole discs.
LONGEST = 0.01


def lsoda(problem: dincl.Problem, tol: float, t: Floats) -> Floats:
    """Return the states (K, N, d) at times t (K,) of x' = F + strength sum_k max(0, -g_k) grad g_k.

    With strength = max_i |F_i(0, x_0)| / tol the overlap of the springs is ``tol`` [length] under the load of one
    particle at rest; the tolerances of the integrator are a hundredth of it. LSODA chooses step, order, and between
    Adams' and stiff formulas. It is given the stiff part of the Jacobian, -strength J^T J of the overlapping rows:
    differences of the right-hand side would reach across overlaps this small. It is dense, and a factorisation costs
    (N d)^3. RuntimeError if LSODA stops.

    Source: (2.2), section 1.1.3; A. C. Hindmarsh, ODEPACK (1983).
    """
    from scipy.integrate import solve_ivp

    end, within = float(t[-1]), max(TIGHTER * tol, SMALLEST)
    springs = Springs(problem, tol, LONGEST * end)
    options = {"rtol": within, "atol": within, "max_step": LONGEST * end, "jac": springs.jacobian}
    with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore"):
        warnings.simplefilter("ignore")  # of what ends the run, which its message says
        found = solve_ivp(springs, (0.0, end), problem.x0.ravel(), "LSODA", t, **options)
    if not found.success:
        raise RuntimeError(f"LSODA stopped: {found.message}")
    states: Floats = found.y.T.reshape(len(t), *problem.x0.shape)
    return states


class Springs:
    """The right-hand side on flat states (N d,), and the stiff part of its Jacobian; a step is at most ``step``."""

    def __init__(self, problem: dincl.Problem, tol: float, step: float) -> None:
        speed = longest(problem.velocity(0.0, problem.x0)) or 1.0
        self._problem, self._strength, self._search_radius = problem, speed / tol, step * speed
        self._candidates = Candidates(problem.constraints, dincl.Work())

    def __call__(self, t: float, flat: Floats) -> Floats:
        x = flat.reshape(self._problem.x0.shape)
        velocity: Floats = self._problem.velocity(t, x).ravel()
        rows = self._candidates.select(t, x, self._search_radius).at(t)
        overlap = np.maximum(-rows.values(x), 0.0)
        return velocity + self._strength * (overlap @ rows.jacobian(x)) if overlap.any() else velocity

    def jacobian(self, t: float, flat: Floats) -> Floats:
        """Return -strength sum_k grad g_k grad g_k^T over the overlaps, shape (N d, N d)."""
        x = flat.reshape(self._problem.x0.shape)
        rows = self._candidates.select(t, x, self._search_radius).at(t)
        gradients = rows.jacobian(x)[rows.values(x) < 0]
        return np.asarray(-self._strength * (gradients.T @ gradients).toarray())
