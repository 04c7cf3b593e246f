"""Single failures that theory predicts, with the number or the kind that is expected."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from dincl.minimise import minimise
from dincl.study import Study
from verification.instruments.predicted import Case, Found, boundary, cases_study, happens, within
from verification.methods.stability import few_sweeps, long_steps
from verification.methods.stability.schemes import SCHEMES, Maker

Floats = NDArray[np.float64]
PRECISION = 1e-3


# Springs come to rest up to dt strength = 2 / lambda_max(J J^T).

DT = 1e-3
# A run is at rest if it moves, in its last step, by less than this part of dt |F|.
RESTING = 1e-2
# At the distance e from the limit a step changes the error by the factor 1 -+ 2 e: SPRING_PRECISION SPRING_STEPS is 6.
SPRING_STEPS, SPRING_PRECISION = 1500, 4e-3


def row_limit(n: int) -> float:
    """Return 2 / (2 + 2 cos(2 pi / (2 n + 1))): n discs on a wall, J J^T = tridiag(-1, 2, -1), but 1 at the wall."""
    return 1 / (1 + math.cos(2 * math.pi / (2 * n + 1)))


def pair() -> dincl.Problem:
    """Return two discs that are pressed together along the diagonal."""
    push = np.array([[0.6, 0.8], [-0.6, -0.8]])
    return dincl.Problem([[0.0, 0.0], [0.6, 0.8]], constant(push), [dincl.NonOverlap(0.5)])


def rests(problem: dincl.Problem, strength: float) -> bool:
    """Return whether springs of this strength come to rest."""
    end = SPRING_STEPS * DT
    path = dincl.solve(problem, dincl.Penalty(dt=DT, strength=strength), t=[end - DT, end], throw=False)
    load = float(np.abs(problem.drift(0.0, problem.x0)).max())
    return bool(path.status) and float(np.abs(path.x[-1] - path.x[-2]).max()) <= RESTING * DT * load


def _springs(make: Callable[[], dincl.Problem], expected: float, allowed: float, words: str) -> Found:
    found = DT * boundary(partial(rests, make()), expected / DT / 2, 2 * expected / DT, SPRING_PRECISION)
    return within(expected, found, allowed, words)


def chatter(dt: float, strength: float) -> float:
    """Measure how far a disc that the force 1 presses onto a wall moves to and fro, under the force as printed."""
    scheme = dincl.Penalty(dt=dt, strength=strength, exponent=1)
    return float(np.ptp(dincl.solve(few_sweeps.pressed(1), scheme, t=dt * np.arange(1000, 2001)).x))


def _printed() -> Found:
    # The load and the strengths have no common measure, so that chatter does not become periodic.
    strengths = [math.sqrt(2) * factor for factor in (1, 10, 100)]
    ratios = [chatter(dt, s) / (dt * s) for dt in (1e-1, 1e-2, 1e-3, 1e-4) for s in strengths]
    agrees = max(ratios) <= 1 + 1e-9 and min(ratios) > 0.95
    words = f"range / (dt strength) is {min(ratios):.3f} ... {max(ratios):.3f} for dt from 1e-4 to 0.1"
    return Found(1.0, min(ratios), agrees, words)


SPRINGS = (
    Case(
        "penalty-wall",
        "Springs, one disc on a wall",
        "unstable beyond dt k |J Jᵀ| = 2: dt k = 2",
        partial(_springs, partial(few_sweeps.pressed, 1), 2.0, 2 * SPRING_PRECISION, "one disc on a wall"),
    ),
    Case(
        "penalty-pair",
        "Springs, two discs",
        "|J Jᵀ| = 2: dt k = 1",
        partial(_springs, pair, 1.0, 2 * SPRING_PRECISION, "two discs pressed together"),
    ),
    Case(
        "penalty-row-8",
        "Springs, a row of 8 on a wall",
        "λ_max(J Jᵀ) = 2 + 2 cos(2π/(2n + 1)) → 4",
        partial(_springs, partial(few_sweeps.pressed, 8), row_limit(8), 2 * SPRING_PRECISION, "8 discs in a row"),
    ),
    Case(
        "penalty-printed",
        "The force as printed",
        "constant in size, so a disc chatters at every dt: its range over dt k",
        _printed,
    ),
)


# Sweeps over rows of discs.

# Sweeps over which a contraction is measured, after the faster modes have died out: multiples of n^2.
SETTLING, MEASURING = 1.0, 0.25


def contraction(count: int) -> float:
    """Return the factor by which a sweep of XPBD shortens the overlap of a row of ``count`` contacts in a step."""
    row = np.arange(count + 1)[:, None]
    problem = dincl.Problem(1.0 * row, constant(-1e-3 * row), [dincl.NonOverlap(few_sweeps.RADIUS)])
    first, more = max(4, round(SETTLING * count**2)), max(6, round(MEASURING * count**2))
    ends = [dincl.solve(problem, dincl.XPBD(1.0, sweeps=sweeps), t=1.0) for sweeps in (first, first + more)]
    overlaps = [float(end.violation()[-1]) for end in ends]
    return float((overlaps[1] / overlaps[0]) ** (1 / more))


def predicted_contraction(count: int) -> float:
    """Return cos^2(pi / (m + 1)): the spectral radius of I - (D + L)^{-1} A for A = tridiag(-1, 2, -1)  (Young)."""
    return math.cos(math.pi / (count + 1)) ** 2


def _contraction(count: int) -> Found:
    """Compare the sweeps for a factor e, 1 / -log(rho), since rho itself is near 1."""
    expected, found = (-1 / math.log(rho) for rho in (predicted_contraction(count), contraction(count)))
    return within(expected, found, 1e-3, f"sweeps for a factor e, {count} contacts")


def equilibrium(n: int, dt: float, sweeps: int = 1) -> Floats:
    """Return where PBD leaves the row, shape (n,): how much closer to the wall than it should be, from a run of PBD."""
    end = dt * (40 * n + 4 * n**2)
    path = dincl.solve(few_sweeps.pressed(n), dincl.PBD(dt=dt, sweeps=sweeps), t=end)
    left: Floats = (few_sweeps.packed(n) - path.final)[:, 0]
    return left


def _equilibrium() -> Found:
    counts = (2, 3, 5, 8, 16)
    worst = max(
        abs(equilibrium(n, dt)[-1] / (dt * few_sweeps.sunk(n)) - 1) for n in counts for dt in (1e-4, 1e-3, 2e-3)
    )
    shown = ", ".join(f"{n}: {few_sweeps.sunk(n):g}" for n in counts)
    words = f"depth of the last disc / (dt |F|), n: depth {shown}; largest deviation {worst:.0e}"
    return Found(0.0, worst, worst < 1e-3, words)


ROWS = (
    *(
        Case(
            f"sweep-contraction-{count}",
            f"Dual sweeps, {count} contacts in a row",
            "−1/log cos²(π/(m + 1)) ≈ (m + 1)²/π² sweeps for a factor e",
            partial(_contraction, count),
        )
        for count in (10, 200)
    ),
    Case(
        "pbd-equilibrium",
        "Equilibrium of PBD in a row",
        "dt |F| (n + (n − 1)(n − 2)/2) too deep: relative deviation",
        _equilibrium,
    ),
)


# Crowds.

MANY = 1000
# Most of the way is done by then: e^-3 of the spread is left [time].
SETTLED = 3.0


def _collapse() -> Found:
    """Let a thousand discs collapse under one sweep."""
    found = []
    for dt, sweeps in ((1e-3, 1), (1e-2, 1), (1e-1, 1), (1e-1, 16), (1e-2, 16)):
        path = dincl.solve(few_sweeps.crowd(MANY), dincl.PBD(dt=dt, sweeps=sweeps), t=SETTLED)
        found.append(
            (dt, sweeps, few_sweeps.gyration(path.final) / few_sweeps.densest(MANY), float(path.violation()[-1]))
        )
    listed = "; ".join(f"dt = {dt:g}, {sweeps}: {size:.2f}, {overlap:.2f}" for dt, sweeps, size, overlap in found)
    # Across a radius of the heap R discs lie behind each other, and dt R^2/2 is what their drift adds up to in a step.
    load = few_sweeps.radius(MANY) ** 2 / 2
    collapsed, cured = found[1][2], found[-1][2]
    return happens(
        collapsed < 0.75 and found[2][2] < 0.4 and cured > 1 - few_sweeps.ALIKE and found[0][3] > 1e-3 * load / 2,
        f"radius of gyration over that of the densest heap, and largest overlap, for dt, sweeps: {listed} (a single "
        f"sweep needs dt well below 2/R² = {1 / load:.3f}, R = {few_sweeps.radius(MANY):.0f} discs)",
    )


def _coincide() -> Found:
    outcomes = {}
    for dt in (1 - 1e-3, 1.0, 1 + 1e-3):
        path = dincl.solve(dincl.scenes.four_disks(), dincl.PBD(dt=dt), t=20 * dt, throw=False)
        outcomes[dt] = path.status
    refused = dincl.Status.COINCIDENT_CENTRES
    words = ", ".join(f"dt = {dt:g}: {status.name}" for dt, status in outcomes.items())
    return happens([dt for dt, status in outcomes.items() if status is refused] == [1.0], words)


def _coincide_linearised() -> Found:
    """Rows are linearised where the discs were, and there they have directions."""
    scheme = SCHEMES["linearised with Daqp"](dt=1.0)
    path = dincl.solve(dincl.scenes.four_disks(), scheme, t=20.0, throw=False)
    overlap = float(path.violation()[-1])
    words = f"{path.status.name}, overlap {overlap:.0e}, while the prediction is a single point"
    return happens(bool(path.status) and overlap < 1e-8, words)


CROWDS = (
    Case(
        "collapse",
        "A thousand attracted discs, one sweep",
        "one sweep does not carry the load dt R²/2: the heap collapses",
        _collapse,
    ),
    Case(
        "coincide-pbd",
        "Centres driven to coincide, PBD",
        "F = −x, dt = 1: refused just there, not at dt = 1 ± 0.001",
        _coincide,
    ),
    Case(
        "coincide-linearised",
        "Centres driven to coincide, linearised",
        "rows have directions where the discs were: it goes on, without overlap",
        _coincide_linearised,
    ),
)


# Stiff drifts.

# Below the limit symplectic Euler swings by up to 1/sqrt(4 - dt^2 k) of the start, so a large bound is taken.
BLOWN, DRIFT_STEPS = 100.0, 1000


def bounded(label: str, rate: float) -> bool:
    """Return whether steps of length 1 stay within BLOWN times the start."""
    path = dincl.solve(long_steps.drawn(rate), SCHEMES[label](dt=1.0), t=float(DRIFT_STEPS), throw=False)
    return float(np.abs(path.final).max()) <= BLOWN * float(np.abs(long_steps.START).max())


def _stiff(label: str, expected: float) -> Found:
    found = boundary(partial(bounded, label), expected / 2, 2 * expected, PRECISION)
    # Just above the limit the growth over the steps of a run is too small to be seen.
    return within(expected, found, 1e-2, f"dt rate, {label}")


DRIFTS = (
    Case("drift-pbd", "A stiff drift, PBD", "explicit Euler: dt k = 2", partial(_stiff, "PBD", 2.0)),
    Case(
        "drift-second",
        "A stiff drift, second-order PBD",
        "symplectic Euler: dt² k = 4",
        partial(_stiff, long_steps.SECOND, 4.0),
    ),
)


# Steps of the prox-regularity radius.

GAP_PRECISION = 1e-4
# So many that a step is as good as a projection.
MANY_SWEEPS = 256


def stays(make: Maker, dt: float) -> bool:
    """Return whether the point is above the gap after one step."""
    problem, height = long_steps.opening(0.6)
    path = dincl.solve(problem, make(dt=dt), t=dt, throw=False)
    return bool(path.status) and float(path.final[0, 1]) > height / 2


def _passes(make: Maker, over: float, words: str) -> Found:
    """Find the step, over h, at which the point stops staying above."""
    height = long_steps.opening(0.6)[1]
    found = boundary(lambda part: stays(make, part * height), 0.5 * over, 2 * over, GAP_PRECISION)
    return within(over, found, 3 * GAP_PRECISION, f"{words}, c = 0.6")


def _linearised() -> Found:
    """S~ at the corner is the tangent wedge, which the point cannot leave."""
    steps = (0.5, 1.0, 2.0, 10.0, 1e3)
    held = [stays(SCHEMES["linearised with Daqp"], s) for s in steps]
    return happens(all(held), f"it stays above for steps up to {steps[-1]:g} times η")


RADII = (
    Case(
        "gap-sweeps",
        "Through the gap of two discs, PBD",
        "each projection keeps the side until step = η = h",
        partial(_passes, partial(dincl.PBD, sweeps=MANY_SWEEPS), 1.0, f"PBD, {MANY_SWEEPS} sweeps: step / h"),
    ),
    *(
        Case(
            f"gap-{name}",
            f"Through the gap of two discs, {label}",
            "a local minimum above: it passes only at step = 2h, not at h",
            partial(_passes, SCHEMES[label], 2.0, f"{label}: step / h"),
        )
        for name, label in zip(("catch_up_ipopt", "catch_up_daqp"), long_steps.SEARCH, strict=True)
    ),
    Case("gap-linearised", "Through the gap of two discs, linearised", "never: S̃ is the wedge above", _linearised),
)


# Saddle points.

# A residual of a tenth of that of the start, in at most so many steps: a factor of 1 - 1/800 a step.
NEAR, MOST, ALLOWED = 0.05, 2000, 1e-2


def weight() -> dincl.Problem:
    """Return min x for x >= 1, from 1.5: the same minimum as ``long_steps.spring`` with h = 0."""
    push = constant(np.array([[-1.0]]))
    return dincl.Problem([[1.5]], push, [dincl.HalfSpace(normal=(1,), offset=1.0)])


def converges(method: str, alpha: float, beta: float) -> bool:
    """Return whether a method gets near the minimum of ``long_steps.spring``."""
    limit = MOST // 4 if method == long_steps.UZAWA else MOST  # each of its steps is a minimisation
    found = minimise(long_steps.spring(), long_steps.minimiser(method, alpha, beta, limit=limit), throw=False)
    return found.residual <= NEAR


def _alpha() -> Found:
    """alpha (2 h + beta j) = 4 at beta = 1: the eigenvalue -1 of [[1 - a, a], [-b (1 - a), 1 - a b]]."""
    found = boundary(lambda alpha: converges(long_steps.PLAIN, alpha, 1.0), 0.3, 1.9, PRECISION)
    return within(4 / 3, found, ALLOWED, "α at β = 1, Arrow-Hurwicz")


def _beta() -> Found:
    found = boundary(lambda beta: converges(long_steps.PLAIN, 0.5, beta), 1.0, 50.0, PRECISION)
    return within(6.0, found, ALLOWED, "β at α = 0.5, Arrow-Hurwicz")


def _damped() -> Found:
    """The modulus 1 of a complex pair of [[1 - a h / 2, a / 2], [-b, 1]]: its determinant 1 - a (h - b) / 2."""
    found = boundary(lambda beta: converges(long_steps.DAMPED, 1.0, beta), 0.2, 5.0, PRECISION)
    return within(1.0, found, ALLOWED, "dτ β at α = 1, damped, γ = 0: β dτ < h")


def _uzawa() -> Found:
    found = boundary(lambda step: converges(long_steps.UZAWA, 1.0, step), 0.3, 9.0, PRECISION)
    return within(2.0, found, ALLOWED, "step of Uzawa, 2 / |B A⁻¹ Bᵀ|")


def _weight() -> Found:
    """h = 0: the determinant is 1, and the pair swings for ever, whatever the steps; gamma damps it."""
    choices = [(alpha, beta) for alpha in (0.01, 0.1) for beta in (0.1, 1.0)]
    swings = [
        minimise(weight(), long_steps.minimiser(long_steps.PLAIN, *steps), throw=False).status for steps in choices
    ]
    damped = minimise(weight(), long_steps.minimiser(long_steps.DAMPED, 0.1, 0.1, gamma=0.1), throw=False)
    reported = sum(status is dincl.Status.NOT_CONVERGED for status in swings)
    words = f"a weight on a floor: {reported} of {len(swings)} choices reach {long_steps.LIMIT} steps; damped with γ: "
    agrees = reported == len(swings) and bool(damped.status)
    return happens(agrees, f"{words}{damped.status.name} in {damped.iterations}")


SADDLES = (
    Case("saddle-alpha", "Arrow-Hurwicz beyond its descent step", "α (2h + β|J|²) = 4: α = 4/3", _alpha),
    Case("saddle-beta", "Arrow-Hurwicz beyond its ascent step", "α (2h + β|J|²) = 4: β = 6", _beta),
    Case("saddle-damped", "Damped Arrow-Hurwicz beyond its ascent step", "dτ β = h for c dτ = 2, γ = 0", _damped),
    Case("saddle-uzawa", "Uzawa beyond its step", "2/|B A⁻¹ Bᵀ| = 2", _uzawa),
    Case("saddle-weight", "Arrow-Hurwicz without curvature", "never at rest for h = 0; the damped form is", _weight),
)


# Solvers that find a local minimum only.


def projected(start: Floats, y: Floats) -> Floats:
    """Return P_S(y) of discs, searched from ``start``, by Ipopt: one catch-up step."""
    problem = dincl.Problem(start, constant(y - start), [dincl.NonOverlap(0.5)])
    return dincl.solve(problem, SCHEMES["catch-up with Ipopt"](dt=1.0), t=1.0).final


def _swapped() -> Found:
    """Two intervals predicted past each other by 0.1: it is shorter to let them pass, but Ipopt puts them back."""
    passed = 0.1
    y = np.array([[0.5 + passed / 2], [0.5 - passed / 2]])
    found = projected(np.array([[0.0], [1.0]]), y)
    nearest = (1 - passed) / math.sqrt(2)
    words = f"distance (1 + 0.1)/√2, in the old order; the nearest point, in the new order, is {nearest:.4f} away"
    return within((1 + passed) / math.sqrt(2), float(np.linalg.norm(found - y)), 1e-6, words)


LOCAL = (
    Case("local-swapped", "Ipopt in a local minimum: two intervals that passed each other", "(1 + δ)/√2", _swapped),
)

CASES: tuple[Case, ...] = (*SPRINGS, *ROWS, *CROWDS, *DRIFTS, *RADII, *SADDLES, *LOCAL)
# Each takes less than a second.
QUICK = ("penalty-wall", "sweep-contraction-10", "coincide-pbd", "drift-second", "gap-linearised", "local-swapped")


def study(smallest: bool = False) -> Study:
    """Return all cases, or a few."""
    cases = [case for case in CASES if case.id in QUICK] if smallest else CASES
    return cases_study(cases, "stability_cases", "Stability: cases")
