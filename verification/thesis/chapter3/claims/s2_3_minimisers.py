"""Chapter 3, section 2.3: the signs of the Arrow-Hurwicz methods as printed, and where the methods converge."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import dincl
from dincl.minimise import ArrowHurwicz, DampedArrowHurwicz, Minimum, Stationary, minimise
from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity
from verification.formal.reals import implication
from verification.thesis.chapter3.claims.s2_3_1_daha import damped
from verification.thesis.text.quoted import claim

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
    """Grad W for W = (x + 1)^2/2; on x >= 0 the minimum is x = 0, where it is 1."""
    return x + 1


def on_a_wall(step: Step) -> tuple[float, float]:
    """(x, lambda) after STEPS of a recursion from (1, 0)."""
    x, lam = 1.0, 0.0
    for _ in range(STEPS):
        x, lam = step(x, lam)
        if abs(x) > FAR:
            break
    return x, lam


def first_method(side: float, turn: float) -> tuple[float, float]:
    """Where Method 3.3 ends: + side * lambda grad g in its first step, lambda + turn * beta g of the sign -side."""
    alpha, beta = 0.1, 0.5
    bound = min if side > 0 else max

    def step(x: float, lam: float) -> tuple[float, float]:
        z = x - alpha * (slope(x) + side * lam)
        return z, bound(0.0, lam + turn * beta * z)

    return on_a_wall(step)


@claim(
    "c3.arrow-hurwicz",
    "The two steps of the Arrow-Hurwicz method, which find a minimum of W over g ≥ 0.",
    "Method 3.3",
    Verdict.CORRECTED,
    chosen="step sizes and one row, the wall x ≥ 0; the first step is from z_0 to z_1, though “n > 0” is printed",
)
def _method() -> Evidence:
    """Method 3.3 with the printed signs and with both consistent ones."""
    printed, (negative, below), (positive, above) = first_method(1, -1)[0], first_method(1, 1), first_method(-1, -1)
    return Evidence(
        f"W = (x + 1)²/2 on x ≥ 0, minimum 0: as printed it ends at x = {printed:.3g}, for the multiplier grows where "
        f"the row holds and vanishes where it is violated; with λ ≤ 0 and λ + βg, as in the appendix, at x = "
        f"{negative:.0e}, λ = {below:.6f}; with λ ≥ 0 and -λ∇g at x = {positive:.0e}, λ = {above:.6f}",
        printed=(equal("x at the end, as printed", printed, 0.0, TOL),),
        corrected=(
            equal("x at the end, λ ≤ 0", negative, 0.0, TOL),
            equal("λ at the end, λ ≤ 0", below, -1.0, TOL),
            equal("x at the end, λ ≥ 0", positive, 0.0, TOL),
            equal("λ at the end, λ ≥ 0", above, 1.0, TOL),
        ),
    )


def growth_rate(side: float, turn: float) -> float:
    """Of x' = -alpha (grad W + side * lambda), lambda' = turn * beta x, linearised at x = 0 with its multiplier."""
    alpha, beta, bend = 0.1, 0.5, slope(1.0) - slope(0.0)
    return float(np.linalg.eigvals([[-alpha * bend, -side * alpha], [turn * beta, 0.0]]).real.max())


@claim(
    "c3.equilibria",
    "The system whose attractive equilibria are to be the minima.",
    "(3.21), (3.22)",
    Verdict.CORRECTED,
)
def _equilibria() -> Evidence:
    printed, negative, positive = growth_rate(1, -1), growth_rate(1, 1), growth_rate(-1, -1)
    return Evidence(
        f"W = (x + 1)²/2 on x ≥ 0: as printed the minimum is an equilibrium at λ = -1 only, a saddle with growth rate "
        f"{printed:.3f}, and (3.22) lets λ grow to positive values where g < 0; with λ ≤ 0 and λ̇ = +βg it attracts "
        f"with rate {negative:.3f}, with λ ≥ 0 and a minus in (3.21), as in (3.23), with {positive:.3f}",
        printed=(at_most("growth rate at the minimum, as printed", printed, -SLOWEST),),
        corrected=(
            at_most("growth rate at the minimum, λ ≤ 0", negative, -SLOWEST),
            at_most("growth rate at the minimum, λ ≥ 0", positive, -SLOWEST),
        ),
    )


@claim(
    "c3.not-always",
    "The undamped method can fail for discs where the damped one converges.",
    "section 2.3",
    chosen="signs that the optimality conditions ask for; step sizes 0.1",
)
def _not_always() -> Evidence:
    """Two and four discs that are drawn to one point, distances squared."""
    stop, problems = Stationary(TOL), {"two discs": two_discs(), "four discs": dincl.scenes.four_disks()}
    plain = {
        name: found(problem, ArrowHurwicz(0.1, 0.1, stop, PATIENCE, squared=True)) for name, problem in problems.items()
    }
    damped = [
        found(problem, DampedArrowHurwicz(0.1, 0.1, 1.0, 2.0, 1.0, stop, PATIENCE, squared=True))
        for problem in problems.values()
    ]
    left = ", ".join(f"{name} {run.residual:.2f}" for name, run in plain.items())
    done = " and ".join(f"{run.iterations}" for run in damped)
    return Evidence(
        f"residual after {PATIENCE} steps: {left}; the damped method meets {TOL:g} after {done} steps",
        printed=(
            at_least("least residual of the Arrow-Hurwicz method", min(run.residual for run in plain.values()), SEEN),
            at_most("largest residual of the damped method", max(run.residual for run in damped), TOL),
        ),
    )


def found(problem: dincl.Problem, method: ArrowHurwicz | DampedArrowHurwicz) -> Minimum:
    """The end of the iteration, whether or not it converged."""
    return minimise(problem, method, throw=False)


def two_discs() -> dincl.Problem:
    """Two discs of radius 1/2 drawn to the origin with W = |x|^2/2, from a little apart."""
    return dincl.Problem([[-0.6, 0.1], [0.7, 0.0]], lambda _t, x: -x, [dincl.NonOverlap(0.5)])


@claim(
    "c3.daha-multiplier",
    "How the damped method updates its multipliers.",
    "Method 3.4",
    Verdict.CORRECTED,
    chosen="n starts at 1 with z_1 = z_0, and λ_1 = 0: the text sets only λ_0",
)
def _damped_multiplier() -> Evidence:
    """The same wall by Method 3.4 with c dtau = 2."""
    alpha, beta, gamma = 0.2, 0.1, 0.2

    def step(bound: Callable[[float, float], float]) -> Step:
        def recursion(x: float, lam: float) -> tuple[float, float]:
            return x - (alpha * (slope(x) - lam) + gamma * x * lam) / 2, bound(0.0, lam - beta * x)

        return recursion

    (printed, negative), (right, lam) = on_a_wall(step(min)), on_a_wall(step(max))
    return Evidence(
        f"W = (x + 1)²/2 on x ≥ 0, minimum 0: with min it ends at x = {printed:.3g}, λ = {negative:.3g}; with max at "
        f"{right:.0e}, λ = {lam:.6f}, for (3.25) pushes along +λ∇g",
        printed=(equal("x at the end, min as printed", printed, 0.0, TOL),),
        corrected=(equal("x at the end, max", right, 0.0, TOL), equal("λ at the end, max", lam, 1.0, TOL)),
    )


@claim(
    "c3.rescaled",
    "The step Δτ can be absorbed in the other parameters.",
    "Remark 3.5",
    Verdict.PROVED,
)
def _rescaled() -> Evidence:
    """(3.25) for dtau and for 1; w = grad W - sum lambda grad g, q = sum g lambda grad g."""
    return proved(
        identity(
            "(3.25) with Δτ = 1 and αΔτ², γΔτ², cΔτ for α, γ, c has the same next state for all states and forces",
            lambda s, z, before, w, q, h, a, c, d: (
                damped(z, before, a * w + c * q, d, h) - damped(z, before, (a * w + c * q) * h**2, d * h**s, 1)
            ),
            "c/Δτ",
        )
    )


@claim(
    "c3.attractive",
    "For two discs the damped system is attracted by the minimum.",
    "section 2.3",
    Verdict.PROVED_INSTANCE,
    chosen="W = ‖z‖²/2; for a W that is much weaker the parameters of Table 4 do not attract",
    tried_on="two discs, W = ‖z‖²/2, linearised",
)
def _attractive() -> Evidence:
    """s^3 + C s^2 + GAMMA lambda J s + ALPHA BETA J at contact, J = 8, lambda = 1/4, has no root x + iy with x >= 0."""
    return proved(
        implication(
            "s³ + 2s² + 0.002s + 0.0002 has no root with a real part ≥ 0: the contact of two discs attracts (Table 4)",
            lambda s, x, y: (
                [
                    x**3 - 3 * x * y**2 + 2 * (x**2 - y**2) + s * 2 * x / 1000 + 2 / 10000 == 0,
                    3 * x**2 * y - y**3 + 4 * x * y + s * 2 * y / 1000 == 0,
                ],
                x < 0,
            ),
            "λ = 1/200",
            0.02,
        )
    )
