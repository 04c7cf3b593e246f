"""Chapter 3, sections 2.3 to 2.3.2: the damped Arrow-Hurwicz method (DAHA), its step, its limits, where it stops."""

from __future__ import annotations

from typing import Any

import numpy as np

import dincl
from dincl.minimise import DampedArrowHurwicz, minimise
from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter3.sampled import ALPHA, BETA, EPS, GAMMA, C

sp = library()
z, before, push, c, h, v, a, b, d, w, size = sp.symbols("z before push c h v a b d w alpha")

ROUNDING, TOL = 1e-12, 1e-8
# Factors of c = 2: 1 and 2 are the last but two and the last but one.
DAMPINGS = (0.1, 0.5, 1.0, 2.0, 10.0)
# What counts as more, where a parameter is doubled.
GROWS = 1.4
# Of a stability limit that is found by bisection.
BISECTIONS = 40
# Stiffnesses W'' of springs; the iteration bears 40,000.
SPRINGS = (1.0, 100.0, 5000.0, 19000.0)
REST = np.array([1.0, 2.0])


def damped(now: Any, before: Any, push: Any, c: Any, dtau: Any) -> Any:
    """Return z_(n+1) of (3.25) as printed, for numbers and symbols; push is the sum of the terms with alpha, gamma."""
    return (2 * now - (1 - dtau * c / 2) * before - dtau**2 * push) / (1 + dtau * c / 2)


def path(t: Any) -> Any:
    """Return a path with the derivatives v, a, b, d at the present."""
    return z + v * t + a * t**2 / 2 + b * t**3 / 6 + d * t**4 / 24


def lowest(force: Any) -> list[Any]:
    """Return the terms below h^2 of both quotients of (3.25) less a + force."""
    quotients = (path(h) - 2 * z + path(-h)) / h**2 + c / (2 * h) * (path(h) - path(-h))
    error = sp.Poly(sp.expand(quotients - a - force), h)
    return [error.coeff_monomial(h**power) for power in (0, 1)]


AFTER = damped(z, before, push, c, h)
SOLVED = (AFTER - 2 * z + before) / h**2 + push
ONE_STEP, TWO_STEPS = (damped(z, before, push, factor / h, h).diff(before) for factor in (2, 1))

_discretised = argument(
    "c3.discretised",
    "(3.25); section 2.3",
    "A discretisation of (3.22) and (3.23) yields the damped Arrow-Hurwicz algorithm (DAHA).",
    "(3.25) is a difference formula for the damped second-order system (3.23).",
    vanishes(
        lowest(c * v),
        lowest(-c * v),
        "(3.25) is z̈ + cż + force = 0 of (3.23) up to terms with Δτ², for every path",
        "−cż",
    ),
    vanishes(
        SOLVED + c / (2 * h) * (AFTER - before),
        SOLVED - c / (2 * h) * (AFTER - before),
        "the printed z_{n+1} solves (3.25) for all states, forces, c and Δτ",
        "−c",
    ),
    vanishes(ONE_STEP, TWO_STEPS, "at c = 2/Δτ z_{n+1} does not depend on z_{n−1}", "c = 1/Δτ"),
    also=("c3.solved", "c3.one-step"),
    chosen="the multiplier is a given function of time, so that its misprinted update does not matter",
)


def radius(stiff: float, c: float, dtau: float) -> float:
    """Return the spectral radius of (3.25) for an energy with ``stiff`` = alpha W'', without constraints."""
    columns = [(damped(z, before, stiff * z, c, dtau), z) for z, before in ((1.0, 0.0), (0.0, 1.0))]
    return float(np.abs(np.linalg.eigvals(np.array(columns, dtype=float).T)).max())


def limit(c: float, dtau: float) -> float:
    """Return the largest alpha W'' for which the iteration does not grow, by bisection."""
    low, high = 0.0, 1e3
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        low, high = (middle, high) if radius(middle, c, dtau) <= 1 + ROUNDING else (low, middle)
    return low


def iterations(c: float, dtau: float) -> float:
    """Return the iterations in which a soft spring loses a factor e."""
    return -1 / float(np.log(radius(1e-3, c, dtau)))


def least_weight(c: float, dtau: float) -> float:
    """Return the smallest multiplier with which a weight comes to rest on a floor (no curvature, |grad g| = 1)."""
    low, high = 0.0, 1e3
    for _ in range(BISECTIONS):
        lam = (low + high) / 2
        basis = np.eye(3)
        columns = [
            (damped(z, before, GAMMA * lam * z - ALPHA * change, c, dtau), z, change - dtau * BETA * z)
            for z, before, change in basis
        ]
        stable = np.abs(np.linalg.eigvals(np.array(columns, dtype=float).T)).max() < 1
        low, high = (low, lam) if stable else (lam, high)
    return high


@claim(
    "c3.stable-choice",
    "A larger damping c and a larger step make DAHA more stable, and take more iterations.",
    source="section 2.3.1",
    quote=(
        "Increasing the damping coefficient c and the time-step size Δt can reduce the numerical instabilities, but it"
        " also directly increases the number of required iterations."
    ),
    correction=Correction(
        (
            "Δτ must be decreased: energies are stable for Δτ²αW'' ≤ 4, whatever c is; a larger c helps contacts only."
            " Both take more iterations"
        ),
        Effect.MODEL,
        "the choice of parameters: a larger Δτ is less stable and needs fewer iterations",
        why="explicit steps of a stiff system become stable by shorter, not longer steps",
        place=2037,
    ),
    rests_on=("c3.discretised", "c3.daha-multiplier"),
    chosen="the step is Δτ of (3.25), in which Δt does not occur; c and Δτ are doubled or halved from c = 2, Δτ = 1/2",
)
def _choice() -> Evidence:
    c, dtau = 2.0, 0.5
    bound, taken, weight = limit(c, dtau), iterations(c, dtau), least_weight(c, dtau)
    bounds = [limit(factor * c, dtau) * dtau**2 for factor in DAMPINGS]
    longer, shorter = (limit(c, step) / bound for step in (2 * dtau, dtau / 2))
    quick, slow = (iterations(c, step) / taken for step in (2 * dtau, dtau / 2))
    stable, many = "largest stable W'' of a spring over before", "iterations over before"
    return Evidence(
        printed=(
            at_least(f"c doubled: {stable}", bounds[-2] / bounds[-3], GROWS),
            at_least(f"Δτ doubled: {stable}", longer, GROWS),
            at_least(f"Δτ doubled: {many}", quick, GROWS),
        ),
        corrected=(
            *(
                equal(f"Δτ²αW'' at the stability limit, c = {factor * c:g}", found, 4.0, 1e-6)
                for factor, found in zip(DAMPINGS, bounds, strict=True)
            ),
            at_least(f"c doubled: {many}", iterations(2 * c, dtau) / taken, GROWS),
            at_most(
                "c doubled: least multiplier of a contact at rest over before",
                least_weight(2 * c, dtau) / weight,
                1 / GROWS,
            ),
            at_least(f"Δτ halved: {stable}", shorter, GROWS),
            at_least(f"Δτ halved: {many}", slow, GROWS),
        ),
    )


def last_move(product: float) -> float:
    """Return the last relative move for a bounded force, steep where it rests, dtau^2 alpha max W'' = ``product``."""
    width = 0.1
    before = now = 1.3
    for _ in range(2000):
        before, now = now, float(damped(now, before, product * width * np.tanh((now - 1) / width), C, 1.0))
    return abs(now - before) / abs(before)


def pulled() -> dincl.Problem:
    """Return one particle without constraints, W = |x - REST|^2/2; at the start grad W is a fortieth of x."""
    return dincl.Problem([1.025 * REST], lambda _t, x: REST - x)


# (3.25) with c = 2, dtau = 1 (Table 4); w is the gradient of W.
TABLE_4 = damped(z, before, size * w, 2, 1) - z

_update = identity(
    "c3.update",
    "(3.26)",
    "z_{n+1} = z_n - α∇W(z_n) + Σ (αλ_ℓ - γλ_ℓ g_ℓ(z_n)) ∇g_ℓ",
    "With Table 4 a step of DAHA moves by α∇W.",
    right=TABLE_4 + size * w / 2,
    wrong=TABLE_4 + size * w,
    correction=Correction(
        "α/2 and γ/2 for α and γ, also in (3.27) and (3.28); or Table 4 with α and γ doubled",
        Effect.MODEL,
        "Remark 3.6, (3.28) to (3.32): the damping coefficient of the first-order model",
        why="with c = 2 and Δτ = 1 the factor 1/(1 + Δτc/2) of the line before is 1/2",
        place=2041,
    ),
    rests_on=("c3.discretised",),
)


def turns(path: list[float]) -> int:
    """Return how often a path around 0 changes sign."""
    side = np.sign([z for z in path if abs(z) > TOL])
    return int((side[1:] != side[:-1]).sum())


def relaxed(stiff: float) -> list[float]:
    """Return z_n of a spring without constraints."""
    before, path = 1.0, [1.0]
    for _ in range(1000):
        before, now = path[-1], damped(path[-1], before, ALPHA * stiff * path[-1], C, 1.0)
        path.append(now)
    return path


def landed(weight: float) -> list[float]:
    """Return z_n of a weight a little above the floor z >= 0, with the multiplier that holds it."""
    before, lam, path = 1e-3, weight, [1e-3]
    for _ in range(5000):
        now = path[-1]
        path.append(damped(now, before, ALPHA * (weight - lam) + GAMMA * lam * now, C, 1.0))
        before, lam = now, max(0.0, lam - BETA * now)
    return path


@claim(
    "c3.overdamped",
    "With Table 4 the states run into their rest without swinging around it.",
    source="section 2.3.1",
    quote=(
        "We see in particular, that the Damped Arrow-Hurwicz Algorithm approaches the equilibrium on an overdamped "
        "trajectory."
    ),
    correction=Correction(
        "… approaches it on an overdamped trajectory where no constraint is active; at a contact the state swings",
        Effect.PROOF,
        "nothing of Remark 3.6 and section 3.1, which leave the constraints out",
        why=(
            "c = 2 with Δτ = 1 removes the inertia of z alone: z and λ together are of second order, λ sums up g, and "
            "(3.26), from which the sentence is read off, has the terms of the constraints"
        ),
        place=2043,
    ),
    rests_on=("c3.daha-multiplier",),
    chosen="springs with W'' from 1 to 19,000, and a weight on a floor in 5000 iterations",
)
def _overdamped() -> Evidence:
    crossed = max(turns(relaxed(stiff)) for stiff in SPRINGS)
    free = equal("crossings of the rest by springs, without constraints", crossed, 0.0)
    swung = equal("crossings of the rest by a weight on a floor", turns(landed(1.0)), 0.0)
    return Evidence(printed=(free, swung), corrected=(free,))


DESCENT = damped(z, before, size * w, 2 / h, h) - z

_descent = identity(
    "c3.descent",
    "Remark 3.6",
    "Let us consider the situation without constraints, e.g. M = 0, and with parameters as in Table 4. In this case "
    "the DAHA method reduces to a gradient decent method with fixed step size.",
    "Without constraints and with c = 2/Δτ DAHA is gradient descent, z_{n+1} = z_n − ½Δτ²α∇W(z_n).",
    right=DESCENT + h**2 * size * w / 2,
    wrong=DESCENT - h**2 * size * w / 2,
    rests_on=("c3.discretised",),
    chosen="the step size is not asked for: it is α/2, see c3.update",
)


@claim(
    "c3.stopping",
    "Where DAHA stops ‖∇W‖/‖z‖ is at most ε/α.",
    source="Remark 3.6; section 2.3.1",
    also=("c3.endless",),
    quote="‖∇W(z_{n*})‖ / ‖z_{n*}‖ ≤ ε/α = 10⁻⁶/10⁻⁴ = 0.01",
    correction=Correction(
        "≤ 2ε/α = 0.02, for the step is α/2: it follows from c3.update",
        Effect.NUMBER,
        "the accuracy that Remark 3.6 derives",
        why="by c3.update the step is α/2 ∇W, so ‖∇W‖ = 2/α times the way of a step",
        place=2061,
    ),
    rests_on=("c3.update", "c3.descent"),
    chosen="W = ‖z − a‖²/2 with Table 4",
)
def _stopping() -> Evidence:
    found = minimise(pulled(), DampedArrowHurwicz.published())
    gradient = float(np.linalg.norm(found.x - REST) / np.linalg.norm(found.x))
    what = f"‖∇W‖/‖z‖ where it stops, after {found.iterations} steps"
    return Evidence(
        printed=(at_most(what, gradient, EPS / ALPHA),),
        corrected=(
            at_most(what, gradient, 2 * EPS / ALPHA),
            at_most("last relative move with Δτ²αW'' = 3", last_move(3.0), EPS),
            at_least("last relative move with Δτ²αW'' = 8, which need not stop", last_move(8.0), 1e3 * EPS),
        ),
    )
