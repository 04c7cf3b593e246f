"""Provoked failures of the solvers of the mean-field chapter, each with its prediction."""
# ruff: noqa: RUF001 - headings for readers have minus signs

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import brentq

from dincl.study import Study
from meanfield import (
    Density,
    InvalidModel,
    LinearFibre,
    Model,
    Moments,
    Motion,
    State,
    Status,
    solve_characteristics,
    solve_dae,
    solve_moments,
    solve_ode,
    solve_pde,
)
from meanfield.model.symbolic import library
from verification.instruments.meanfield_methods import STYLES
from verification.instruments.predicted import Case, Found, cases_study, happens, within
from verification.site.context import Context
from verification.thesis.chapter5 import cases

Floats = NDArray[np.float64]
NAME = "meanfield_failures"
# Endings that say that dg/dX is about to become singular.
SINGULAR = (Status.SINGULAR, Status.STEP_TOO_SMALL, Status.NOT_CONVERGED)
# The setting of each solver, where failures are looked for.
SOLVERS: dict[str, Callable[[Model, State, Floats], Motion]] = {
    "ode": partial(solve_ode, tol=1e-8, throw=False),
    "dae": partial(solve_dae, tol=1e-6, throw=False),
}
# Times kept before a failure, and how near to it the last one must be, relative to it.
KEPT, NEAR = 100, 0.03
KERNELS: dict[str, Callable[[Any], Any]] = {
    "1/r²": lambda r: -1 / library().sumsqr(r),
    "log|r|": lambda r: library().log(library().norm_2(r)),
    "√|r|": lambda r: library().sumsqr(r) ** 0.25,
}


def stopped(motion: Any, at: float) -> Found:
    """Return whether a run ended with a Status that names singularity, just before a time."""
    last = float(motion.t[-1]) if len(motion.t) else 0.0
    agrees = motion.status in SINGULAR and (1 - NEAR) * at < last < at * (1 + NEAR / 10) and _finite(motion)
    return Found(at, last, agrees, motion.status.name)


def _finite(motion: Any) -> bool:
    """Return whether all numbers of a result are finite."""
    return bool(np.isfinite(motion.y).all() and np.isfinite(motion.v).all())


def through_zero(solver: str) -> Found:
    """Reach y = 0 in StraightFibre, where all particles are in one point; the time is known."""
    model, law, y0, v0 = cases.model("straight"), cases.law("straight"), [1.0], [-3.0]
    X = law.quantiles(20)
    of_law = np.sqrt(law.moments()[1])

    def y(t: float) -> float:
        follows = X if solver in SOLVERS else of_law
        return float(cases.harmonic("straight", follows, np.array([t]), v0[0]).y[0, 0])

    at = float(brentq(y, 0.0, 1.0))
    t = at * np.linspace(0.0, 1.5, KEPT)
    limits: Mapping[str, Callable[[], Any]] = {
        "moments": lambda: solve_moments(model, Moments(*law.moments()), y0, v0, t, 1e-8, throw=False),
        "characteristics": lambda: solve_characteristics(model, law, y0, v0, t, 1e-8, throw=False),
        "pde": lambda: solve_pde(model, law, y0, v0, t, 24, throw=False),
    }
    return stopped(limits[solver]() if solver in limits else SOLVERS[solver](model, State(X=X, y=y0, v=v0), t), at)


def flat_element(solver: str) -> Found:
    """Reach det F(y) = 0 in TissueElement, whose first stretch goes to 0 at the time its last values give."""
    model, law = cases.model("element"), cases.law("element")
    start = State(X=law.sample(cases.stream("start", 20), 20), y=[1.0, 1.0, 0.0], v=[-3.0, 0.0, 0.0])
    motion = SOLVERS[solver](model, start, np.linspace(0.0, 1.0, KEPT))
    det = motion.y[:, 0] * motion.y[:, 1] - motion.y[:, 2] ** 2
    # The determinant falls almost linearly: where the line through its last values meets 0.
    rate = np.polyfit(motion.t[-5:], det[-5:], 1)
    return stopped(motion, float(-rate[1] / rate[0]))


def fold(solver: str) -> Found:
    """Reach a fold of g = X + 1.5 sin X - y at cos X = -2/3, where X' = y'/(1 + 1.5 cos X) has no limit."""
    ca = library()
    model = Model(g=lambda X, y: X + 1.5 * ca.sin(X) - y, W0=lambda y: (y - 8) ** 2 / 2, W1=lambda X: 0.05 * X**2)
    motion = SOLVERS[solver](model, State(X=[[0.5], [0.8], [1.0]], y=[1.0], v=[0.5]), np.linspace(0.0, 4.0, KEPT))
    at, reached = float(np.arccos(-2 / 3)), float(motion.X[-1].max())
    agrees = motion.status in SINGULAR and 0.9 * at < reached < at and _finite(motion)
    return Found(at, reached, agrees, motion.status.name)


def stiff_steps() -> Found:
    """Count the steps of an explicit method over a fixed time: they grow with the frequency sqrt(k0)."""
    stiffness, steps = np.array([1e2, 1e3, 1e4, 3e4]), []
    for k in stiffness:
        model = LinearFibre(m=1.0, k0=float(k), y_rest=1.5, k1=0.5)
        steps.append(solve_ode(model, State(X=[[1.0], [1.3]], y=[1.0], v=[0.0]), [1.0], 1e-8).work.steps)
    power = float(np.polyfit(np.log(stiffness[1:]), np.log(steps[1:]), 1)[0])
    return within(0.5, power, 0.1, f"{steps[-1]} steps at k = {stiffness[-1]:g}")


def unbounded_kernel(kind: str) -> Found:
    """Take a kernel without a finite value or force at distance 0: the model is refused, or the run ends."""
    try:
        model = Model(g=lambda X, y: X / y, W0=lambda y: y**2, W1=lambda X: X**2, V=KERNELS[kind])
        motion = solve_ode(model, State(X=[[1.0], [1.2]], y=[1.0], v=[0.0]), [0.1], 1e-6, throw=False)
    except InvalidModel as error:
        return happens(True, f"InvalidModel: {str(error).rpartition(': ')[2][:80]}")
    return happens(motion.status is Status.NON_FINITE, motion.status.name)


def blow_up(solver: str) -> Found:
    """Let y go to infinity by W0 = -y^4 without another force: 1/y(t) = 1 - t from y = v = 1, by the energy."""
    model = Model(g=lambda X, y: X - y, W0=lambda y: -(y**4), W1=lambda X: 0 * X)
    motion = SOLVERS[solver](model, State(X=[[1.0]], y=[1.0], v=[1.0]), np.linspace(0.0, 1.5, KEPT))
    last = float(motion.t[-1])
    return Found(1.0, last, not motion.status and abs(last - 1) < 0.05 and _finite(motion), motion.status.name)


def left_grid() -> Found:
    """Let the density of LinearFibre leave the grid, at a known time."""
    law, case, end = Density.uniform(0.4, 1.6), cases.CASES["linear"], 1.8
    X = law.quantiles(2000)
    at = float(brentq(lambda t: cases.harmonic("linear", X, np.array([t])).y[0, 0] - case.y0[0] + 1.6 - end, 0.0, 1.0))
    t = at * np.linspace(0, 2, KEPT)
    motion = solve_pde(cases.model("linear"), law, case.y0, case.v0, t, 400, bounds=(0.0, end), throw=False)
    last = float(motion.t[-1])
    agrees = motion.status is Status.LEFT_GRID and abs(last / at - 1) < 0.15 and _finite(motion)
    return Found(at, last, agrees, motion.status.name)


def _each(short: str, solvers: tuple[str, ...], title: str, theory: str, find: Callable[[str], Found]) -> list[Case]:
    """Return a case for each solver."""
    return [Case(f"{short}-{one}", f"{title}, {STYLES[one][0]}", theory, partial(find, one)) for one in solvers]


LIMITS = ("moments", "characteristics", "pde")
CASES = (
    *_each("zero", (*SOLVERS, *LIMITS), "StraightFibre, y → 0", "ends at the time of y = 0", through_zero),
    *_each("flat", tuple(SOLVERS), "TissueElement, det F(y) → 0", "ends at the time of det F = 0", flat_element),
    *_each("fold", tuple(SOLVERS), "A fold of g", "ends before X with cos X = −2/3", fold),
    Case("stiff-ode", "Stiff springs, ODE (DOP853)", "steps ~ k^0.5: power of k", stiff_steps),
    *(
        Case(f"kernel-{kind}", f"Kernel V = {kind}", "refused, or NON_FINITE", partial(unbounded_kernel, kind))
        for kind in KERNELS
    ),
    *_each("blow", ("ode",), "W0 = −y⁴, y → ∞", "ends at t = 1", blow_up),
    Case("grid-pde", "The density reaches the end of the grid, PDE", "ends at the time of the end", left_grid),
)
FEW = ("zero-moments", "kernel-1/r²")


def study(smallest: bool = False) -> Study:
    """Return the study of all cases."""
    chosen = [one for one in CASES if not smallest or one.id in FEW]
    return cases_study(chosen, NAME, "Mean field: failures")


def show(context: Context) -> None:
    """Give the failures beside what theory predicts."""
    words = pd.DataFrame([{"case": one.id, "title": one.title, "theory": one.theory} for one in CASES])
    context.show(NAME, context.headed(NAME, words.merge(context.tables[NAME], on="case")))
