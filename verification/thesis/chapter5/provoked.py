"""Provoked failures of the solvers of the mean-field chapter, each with its prediction."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from meanfield import (
    Density,
    InvalidModel,
    LinearFibre,
    Model,
    Moments,
    Motion,
    State,
    Status,
    StraightFibre,
    reduce,
    solve_characteristics,
    solve_dae,
    solve_moments,
    solve_ode,
    solve_pde,
    solve_rattle,
)
from meanfield.model.symbolic import library
from verification.instruments.meanfield_methods import SOLVERS
from verification.thesis.chapter2.stability.boundary import boundary
from verification.thesis.chapter5 import cases, exact

Floats = NDArray[np.float64]
# The setting of each solver, where failures are looked for.
SETTINGS = {"ode": 1e-8, "reduced": 1e-8, "dae": 1e-6, "rattle2": 0.01}
PARTICLE_SOLVERS = ("ode", "dae", "rattle2")
# Endings that say that dg/dX is about to become singular.
SINGULAR = (Status.SINGULAR, Status.STEP_TOO_SMALL, Status.NOT_CONVERGED)
# Times kept before a failure, and how near to it the last one must be, relative to it.
KEPT, NEAR = 100, 0.03
# How far a start is off the constraint.
OFF = 1e-3
KERNELS = ("1/r²", "log|r|", "√|r|")


class Provoked(NamedTuple):
    """What was predicted and found, in words, and whether they agree."""

    predicted: str
    found: str
    agrees: bool


def off_constraint(name: str, solver: str) -> Provoked:
    """Provoke a start whose U or level is off by OFF: it is refused, and the message says by how much."""
    model, start = cases.model("wavy"), cases.few("wavy", 5)
    true = start.complete(model, 1e-8)
    wrong = getattr(true, name) + OFF
    try:
        SOLVERS[solver](
            model, State(X=start.X, y=start.y, v=start.v, **{name: wrong}), np.array([1.0]), SETTINGS[solver]
        )
    except InvalidModel as error:
        said = str(error)
        return Provoked(f"InvalidModel, off by {OFF:g}", said.partition(" for ")[0], f" = {OFF:.3g} for " in said)
    return Provoked(f"InvalidModel, off by {OFF:g}", "accepted", False)


def through_zero(solver: str) -> Provoked:
    """Provoke y -> 0 in StraightFibre, where all particles are in one point; the time is known."""
    model, law = StraightFibre(**cases.FIBRE), cases.law("straight")
    y0, v0 = [1.0], [-3.0]
    X = law.quantiles(20)
    true = partial(_straight, X if solver in SOLVERS else np.sqrt(law.moments()[1]), y0[0], v0[0])
    at = float(brentq(true, 0.0, 1.0))
    t = at * np.linspace(0.0, 1.5, KEPT)
    limits: Mapping[str, Callable[[], Any]] = {
        "moments": lambda: solve_moments(model, Moments(*law.moments()), y0, v0, t, 1e-8, throw=False),
        "characteristics": lambda: solve_characteristics(model, law, y0, v0, t, 1e-8, throw=False),
        "pde": lambda: solve_pde(model, law, y0, v0, t, 24, throw=False),
    }
    if solver in limits:
        return stopped(limits[solver](), at)
    return stopped(_tried(solver, model, State(X=X, y=y0, v=v0), t), at)


def _straight(X: Floats, y0: float, v0: float, t: float) -> float:
    """Return y(t) of StraightFibre with another v0: harmonic, see ``exact.harmonic``."""
    m, k0, rest, k1 = (cases.FIBRE[key] for key in ("m", "k0", "y_rest", "k1"))
    share = float((X**2).mean()) / y0**2
    stiffness = k0 + k1 * share
    rate = np.sqrt(stiffness / (1 + m * share))
    middle = k0 * rest / stiffness
    return float(middle + (y0 - middle) * np.cos(rate * t) + v0 / rate * np.sin(rate * t))


def flat_element(solver: str) -> Provoked:
    """Provoke det F(y) = 0 in TissueElement, whose first stretch goes to 0 at the time its last values give."""
    model, law = cases.model("element"), cases.law("element")
    start = State(X=law.sample(cases.stream("start", 20), 20), y=[1.0, 1.0, 0.0], v=[-3.0, 0.0, 0.0])
    t = np.linspace(0.0, 1.0, KEPT)
    motion = _tried(solver, model, start, t)
    det = motion.y[:, 0] * motion.y[:, 1] - motion.y[:, 2] ** 2
    # The determinant falls almost linearly: where the line through its last values meets 0.
    rate = np.polyfit(motion.t[-5:], det[-5:], 1)
    return stopped(motion, float(-rate[1] / rate[0]))


def fold(solver: str) -> Provoked:
    """Provoke a fold of g = X + 1.5 sin X - y at cos X = -2/3, where X' = y'/(1 + 1.5 cos X) has no limit."""
    ca = library()
    model = Model(g=lambda X, y: X + 1.5 * ca.sin(X) - y, W0=lambda y: (y - 8) ** 2 / 2, W1=lambda X: 0.05 * X**2)
    motion = _tried(solver, model, State(X=[[0.5], [0.8], [1.0]], y=[1.0], v=[0.5]), np.linspace(0.0, 4.0, KEPT))
    at, reached = float(np.arccos(-2 / 3)), float(motion.X[-1].max())
    agrees = motion.status in SINGULAR and 0.9 * at < reached < at and _finite(motion)
    return Provoked(f"X reaches {at:.4g}", f"{motion.status.name} after X = {reached:.4g}", agrees)


def _tried(solver: str, model: Model, start: State, t: Floats) -> Motion:
    calls: dict[str, Callable[..., Motion]] = {"ode": solve_ode, "dae": solve_dae, "rattle2": solve_rattle}
    if solver == "reduced":
        return solve_ode(reduce(model), start, t, SETTINGS[solver], throw=False)
    return calls[solver](model, start, t, SETTINGS[solver], throw=False)


def stopped(motion: Any, at: float) -> Provoked:
    """Return whether a run ended with a Status that names singularity, just before a time."""
    last = float(motion.t[-1]) if len(motion.t) else 0.0
    agrees = motion.status in SINGULAR and (1 - NEAR) * at < last < at * (1 + NEAR / 10) and _finite(motion)
    return Provoked(f"ends at t = {at:.4g}", f"{motion.status.name} after t = {last:.4g}", agrees)


def _finite(motion: Any) -> bool:
    """Return whether all numbers of a result are finite."""
    return bool(np.isfinite(motion.y).all() and np.isfinite(motion.v).all())


def stiff_steps() -> Provoked:
    """Provoke stiffness: the steps of an explicit method over fixed times grow with the frequency sqrt(k0)."""
    stiffness = np.array([1e2, 1e3, 1e4, 3e4])
    steps = []
    for k in stiffness:
        model = LinearFibre(m=1.0, k0=float(k), y_rest=1.5, k1=0.5)
        steps.append(solve_ode(model, State(X=[[1.0], [1.3]], y=[1.0], v=[0.0]), [1.0], SETTINGS["ode"]).work.steps)
    slope = float(np.polyfit(np.log(stiffness[1:]), np.log(steps[1:]), 1)[0])
    return Provoked(
        "steps ~ k^0.5", f"steps ~ k^{slope:.3f}, {steps[-1]} at k = {stiffness[-1]:g}", abs(slope - 0.5) < 0.05
    )


def rattle_limit() -> Provoked:
    """Provoke instability of RATTLE of order 2, the Verlet scheme, beyond dt sqrt((k0 + k1)/(1 + m)) = 2."""
    k0, k1, m, steps = 100.0, 0.5, 1.0, 200
    model = LinearFibre(m=m, k0=k0, y_rest=1.5, k1=k1)
    start = State(X=[[1.0], [1.3]], y=[1.0], v=[0.0])

    def bounded(dt: float) -> bool:
        motion = solve_rattle(model, start, [steps * dt], dt, throw=False)
        return bool(motion.status) and bool(np.abs(motion.y).max() < 100)

    expected = 2 * np.sqrt((1 + m) / (k0 + k1))
    found = boundary(bounded, expected / 2, 2 * expected, 1e-3)
    return Provoked(f"dt = {expected:.4g}", f"dt = {found:.4g}", abs(found / expected - 1) < 0.01)


def unbounded_kernel(kind: str) -> Provoked:
    """Provoke kernels without a finite value or force at distance 0: the model is refused, or the run ends."""
    ca = library()
    V = {
        "1/r²": lambda r: -1 / ca.sumsqr(r),
        "log|r|": lambda r: ca.log(ca.norm_2(r)),
        "√|r|": lambda r: ca.sumsqr(r) ** 0.25,
    }[kind]
    predicted = "refused, or NON_FINITE"
    try:
        model = Model(g=lambda X, y: X / y, W0=lambda y: y**2, W1=lambda X: X**2, V=V)
        motion = solve_ode(model, State(X=[[1.0], [1.2]], y=[1.0], v=[0.0]), [0.1], 1e-6, throw=False)
    except InvalidModel as error:
        return Provoked(predicted, f"InvalidModel: {str(error).rpartition(': ')[2][:80]}", True)
    return Provoked(predicted, motion.status.name, motion.status is Status.NON_FINITE)


def blow_up(solver: str) -> Provoked:
    """Provoke y -> infinity by W0 = -y^4 in the time int dy/v, known from the energy (LinearFibre, no other force)."""
    model = Model(g=lambda X, y: X - y, W0=lambda y: -(y**4), W1=lambda X: 0 * X)
    # (1 + m)/2 v^2 - y^4 = 0 from y = v = 1: 1/y(t) = 1 - t.
    motion = _tried(solver, model, State(X=[[1.0]], y=[1.0], v=[1.0]), np.linspace(0.0, 1.5, KEPT))
    last = float(motion.t[-1])
    return Provoked(
        "ends at t = 1",
        f"{motion.status.name} after t = {last:.4g}",
        not motion.status and abs(last - 1) < 0.05 and _finite(motion),
    )


def left_grid() -> Provoked:
    """Provoke a density of LinearFibre that leaves the grid, at a known time."""
    name, law = "linear", Density.uniform(0.4, 1.6)
    case, end = cases.CASES[name], 1.8
    X = law.quantiles(2000)

    def gap(t: float) -> float:
        return float(exact.harmonic(name, X, np.array([t])).y[0, 0]) - case.y0[0] + 1.6 - end

    at = float(brentq(gap, 0.0, 1.0))
    motion = solve_pde(
        cases.model(name), law, case.y0, case.v0, at * np.linspace(0, 2, KEPT), 400, bounds=(0.0, end), throw=False
    )
    last = float(motion.t[-1])
    agrees = motion.status is Status.LEFT_GRID and abs(last / at - 1) < 0.15 and _finite(motion)
    return Provoked(f"reached at t = {at:.4g}", f"{motion.status.name} after t = {last:.4g}", agrees)
