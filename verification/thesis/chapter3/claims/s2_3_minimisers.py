"""Chapter 3, section 2.3: the Lagrangian, the signs of the Arrow-Hurwicz methods as printed, where they converge."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import dincl
from dincl.minimise import ArrowHurwicz, DampedArrowHurwicz, Stationary, minimise
from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.algebra import library
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument

# m = min(0, g(z)) of one row; sup over lambda of W + lambda m is W for m = 0 and infinite for m < 0.
W, level, m, L, K = reals("W level m L K")
OUTSIDE = [m < 0, W + level * m == L]

_saddle = argument(
    "c3.saddle",
    "(3.20)",
    "Solutions of (3.20) will also be solutions of the original problem (3.18).",
    "inf sup of ℒ = W + Σ λ_ℓ min(0, g_ℓ) over all λ gives the minima of W over S.",
    follows([m == 0, W + level * m == L], W == L, -W == L, "ℒ = W for every λ where g ≥ 0", "−W"),
    follows(
        [*OUTSIDE, level * m == K - W + 1],
        L > K,
        ([*OUTSIDE, level * m == -(K - W + 1)], L > K),
        "where g < 0 ℒ is above any K for λ = (K − W + 1)/g: inf sup ℒ is taken in S, at the least W",
        "λ = −(K − W + 1)/g",
    ),
)


STEPS = 2000
# Steps of the methods for discs: a few more than the damped one needs.
PATIENCE = 500
# Of a recursion that is cut off where it blows up.
FAR = 1e12
TOL = 1e-8
# Of a residual that is no rounding, and of a rate that is no zero.
SEEN, SLOWEST = 0.1, 1e-6

Step = Callable[[float, float], tuple[float, float]]


def slope(x: float) -> float:
    """Return grad W for W = (x + 1)^2/2; on x >= 0 the minimum is x = 0, where it is 1."""
    return x + 1


def on_a_wall(step: Step) -> tuple[float, float]:
    """Return (x, lambda) after STEPS of a recursion from (1, 0), or once |x| > FAR."""
    x, lam = 1.0, 0.0
    for _ in range(STEPS):
        x, lam = step(x, lam)
        if abs(x) > FAR:
            break
    return x, lam


def first_method(side: float, turn: float) -> tuple[float, float]:
    """Return where Method 3.3 ends with + side * lambda grad g, and lambda + turn * beta g of the sign -side."""
    alpha, beta = 0.1, 0.5
    bound = min if side > 0 else max

    def step(x: float, lam: float) -> tuple[float, float]:
        z = x - alpha * (slope(x) + side * lam)
        return z, bound(0.0, lam + turn * beta * z)

    return on_a_wall(step)


@claim(
    "c3.arrow-hurwicz",
    "The two printed steps of the Arrow-Hurwicz method find a minimum of W over g ≥ 0.",
    source="Method 3.3; (3.21), (3.22)",
    also=("c3.equilibria",),
    quote="z_{n+1} := z_n - α(∇W(z_n) + Σ λ_ℓ ∇g_ℓ(z_n)), λ_{ℓ,n+1} := min(0, λ_{ℓ,n} - β g_ℓ(z_{n+1}))",
    correction=Correction(
        "either λ ≤ 0 with + Σ λ_ℓ ∇g_ℓ and min(0, λ_ℓ + βg_ℓ), or λ ≥ 0 with - Σ λ_ℓ ∇g_ℓ and max(0, λ_ℓ - βg_ℓ)",
        Effect.MODEL,
        "(3.21), (3.22), for which the method is the semi-implicit Euler method, and Method 3.4",
        why=(
            "where g > 0 the printed update makes λ negative, and −αλ∇g then moves the state along +∇g, deeper into "
            "the feasible set: g grows further, and so does −λ, without end"
        ),
        place=1979,
    ),
    rests_on=("c3.saddle",),
    chosen="W = (x + 1)²/2 on x ≥ 0, with the minimum 0; α = 0.1, β = 0.5, 2000 steps from x = 1, λ = 0; the first "
    "step is from z_0 to z_1, though “n > 0” is printed",
)
def _method() -> Evidence:
    """Run Method 3.3 with the printed signs and with both consistent ones."""
    printed, (negative, below), (positive, above) = first_method(1, -1)[0], first_method(1, 1), first_method(-1, -1)
    return Evidence(
        printed=(
            equal(f"x at the end, or above {FAR:g}, signs as printed", printed, 0.0, TOL),
            at_most("growth rate of (3.21), (3.22) at the minimum, signs as printed", growth_rate(1, -1), -SLOWEST),
        ),
        corrected=(
            equal("x at the end, with λ ≤ 0 and λ + βg", negative, 0.0, TOL),
            equal("λ at the end, with λ ≤ 0 and λ + βg", below, -1.0, TOL),
            equal("x at the end, with λ ≥ 0 and −λ∇g", positive, 0.0, TOL),
            equal("λ at the end, with λ ≥ 0 and −λ∇g", above, 1.0, TOL),
            at_most("growth rate at the minimum, with λ ≤ 0 and λ̇ = +βg", growth_rate(1, 1), -SLOWEST),
            at_most("growth rate at the minimum, with λ ≥ 0 and −λ∇g", growth_rate(-1, -1), -SLOWEST),
        ),
    )


def growth_rate(side: float, turn: float) -> float:
    """Return the growth rate of x' = -alpha (grad W + side * lambda), lambda' = turn * beta x, linearised at x = 0."""
    alpha, beta, bend = 0.1, 0.5, slope(1.0) - slope(0.0)
    return float(np.linalg.eigvals([[-alpha * bend, -side * alpha], [turn * beta, 0.0]]).real.max())


@claim(
    "c3.not-always",
    "The undamped method can fail for discs where the damped one converges.",
    source="section 2.3",
    quote=(
        "the direct application of the Arrow-Hurwicz algorithm does not always converge for … non-overlapping spheres"
    ),
    rests_on=("c3.arrow-hurwicz", "c3.daha-multiplier"),
    chosen="the corrected signs, step sizes 0.1, at most 500 steps; two and four discs that are drawn to one point",
)
def _not_always() -> Evidence:
    stop, problems = Stationary(TOL), {"two discs": two_discs(), "four discs": dincl.scenes.four_disks()}
    methods = (
        ArrowHurwicz(0.1, 0.1, stop, PATIENCE, squared=True),
        DampedArrowHurwicz(0.1, 0.1, 1.0, 2.0, 1.0, stop, PATIENCE, squared=True),
    )
    plain, other = (
        {name: minimise(problem, method, throw=False) for name, problem in problems.items()} for method in methods
    )
    return Evidence(
        printed=(
            *(
                at_least(f"residual of the Arrow-Hurwicz method, {name}", run.residual, SEEN)
                for name, run in plain.items()
            ),
            *(
                at_most(f"residual of the damped method after {run.iterations} steps, {name}", run.residual, TOL)
                for name, run in other.items()
            ),
        )
    )


def two_discs() -> dincl.Problem:
    """Return two discs of radius 1/2 drawn to the origin with W = |x|^2/2, from a little apart."""
    return dincl.Problem([[-0.6, 0.1], [0.7, 0.0]], lambda _t, x: -x, [dincl.NonOverlap(0.5)])


@claim(
    "c3.daha-multiplier",
    "The damped method finds the minimum with min(0, ·) in the update of its multipliers.",
    source="Method 3.4",
    quote="λ_{ℓ,n+1} = min(0, λ_{ℓ,n} - Δτ β g_ℓ(z_n))",
    correction=Correction(
        "λ_{ℓ,n+1} = max(0, λ_{ℓ,n} - Δτ β g_ℓ(z_n))",
        Effect.MODEL,
        "the method: with min, discs that overlap do not notice each other",
        why=(
            "λ begins at 0, grows while g < 0 and must not become negative, as (3.25) has − Σ λ∇g; min(0, ·) keeps it "
            "at 0 there"
        ),
        place=2014,
    ),
    rests_on=("c3.discretised",),
    chosen="the wall of c3.arrow-hurwicz, cΔτ = 2; n starts at 1 with z_1 = z_0, and λ_1 = 0: the thesis sets only λ_0",
)
def _damped_multiplier() -> Evidence:
    alpha, beta, gamma = 0.2, 0.1, 0.2

    def step(bound: Callable[[float, float], float]) -> Step:
        def recursion(x: float, lam: float) -> tuple[float, float]:
            return x - (alpha * (slope(x) - lam) + gamma * x * lam) / 2, bound(0.0, lam - beta * x)

        return recursion

    (printed, negative), (right, lam) = on_a_wall(step(min)), on_a_wall(step(max))
    return Evidence(
        printed=(equal(f"x at the end, with min(0, ·) and λ = {negative:.3g} there", printed, 0.0, TOL),),
        corrected=(
            equal("x at the end, with max(0, ·)", right, 0.0, TOL),
            equal("λ at the end, with max(0, ·)", lam, 1.0, TOL),
        ),
    )


# w = grad W - sum lambda grad g, q = sum g lambda grad g.
z = library().symbols("z")


# Roots x + iy, x >= 0, of s^3 + C s^2 + GAMMA lambda J s + ALPHA BETA J: contact, J = 8, lambda = 1/4, or 1/200.
(x,) = reals("x")
