"""Chapter 3, section 2.3: the Arrow-Hurwicz methods as printed."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import dincl
from dincl.minimise import ArrowHurwicz, DampedArrowHurwicz, RelativeMove, Stationary, minimise
from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if

STEPS = 2000
ROUNDING = 1e-12
TOL = 1e-8
# Table 4.
ALPHA, BETA, GAMMA, C, EPS = 1e-4, 0.25, 1e-3, 2.0, 1e-6


def _on_a_wall(step: Callable[[float, float, float], tuple[float, float]]) -> tuple[float, float]:
    """(x, lambda) after STEPS of a recursion in (x_n, x_{n-1}, lambda_n), from (1, 1, 0); cut off where it blows up."""
    before = x = 1.0
    lam = 0.0
    for _ in range(STEPS):
        (after, lam), before = step(x, before, lam), x
        x = after
        if abs(x) > 1 / ROUNDING:
            break
    return x, lam


def _method(_: Tables) -> Verdict:
    """W = (x + 1)^2/2, g = x >= 0: the minimum is x = 0, where grad W = 1."""
    alpha, beta = 0.1, 0.5

    def step(sign: float) -> Callable[[float, float, float], tuple[float, float]]:
        def recursion(x: float, _before: float, lam: float) -> tuple[float, float]:
            z = x - alpha * (x + 1 + lam)
            return z, min(0.0, lam + sign * beta * z)

        return recursion

    (printed, _), (right, lam) = _on_a_wall(step(-1.0)), _on_a_wall(step(1.0))
    return corrected_if(
        abs(printed) < TOL,
        abs(right) < TOL and abs(lam + 1) < TOL,
        f"W = (x + 1)²/2 on x ≥ 0: as printed it ends at x = {printed:.3g}, for the multiplier grows where the row "
        f"holds and vanishes where it is violated; with λ + βg it ends at x = {right:.0e}, λ = {lam:.6f}. The same "
        "with multipliers ≥ 0: minus in the first step, max(0, λ - βg) in the second",
    )


def _equilibria(_: Tables) -> Verdict:
    """The system linearised at x = 0 with its multiplier, for W = (x + 1)^2/2, g = x."""
    alpha, beta = 0.1, 0.5
    growth = {sign: np.linalg.eigvals([[-alpha, -sign * alpha], [-beta, 0.0]]).real.max() for sign in (1.0, -1.0)}
    return corrected_if(
        growth[1.0] < 0,
        growth[-1.0] < 0,
        f"W = (x + 1)²/2 on x ≥ 0: with the printed plus the minimum is an equilibrium at λ = -1 only, a saddle with "
        f"growth rate {growth[1.0]:.3f}, and (3.22) lets λ grow to positive values where g < 0; with a minus, as in "
        f"(3.23), the equilibrium is λ = 1 and attracts with rate {growth[-1.0]:.3f}",
    )


def _damped_multiplier(_: Tables) -> Verdict:
    """The same minimum by Method 3.4 with c dtau = 2."""
    alpha, beta, gamma = 0.2, 0.1, 0.2

    def step(bound: Callable[[float, float], float]) -> Callable[[float, float, float], tuple[float, float]]:
        def recursion(x: float, _before: float, lam: float) -> tuple[float, float]:
            return x - (alpha * (x + 1 - lam) + gamma * x * lam) / 2, bound(0.0, lam - beta * x)

        return recursion

    (printed, negative), (right, lam) = _on_a_wall(step(min)), _on_a_wall(step(max))
    return corrected_if(
        abs(printed) < TOL,
        abs(right) < TOL and abs(lam - 1) < TOL,
        f"W = (x + 1)²/2 on x ≥ 0: with min it ends at x = {printed:.3g}, λ = {negative:.3g}; with max at {right:.0e}, "
        f"λ = {lam:.6f}, for (3.25) pushes along +λ∇g",
    )


def _two_discs() -> dincl.Problem:
    """Two discs of radius 1/2 drawn to the origin with W = |x|^2/2, from a little apart."""
    return dincl.Problem([[-0.6, 0.1], [0.7, 0.0]], lambda _t, x: -x, [dincl.NonOverlap(0.5)])


def _attractive(_: Tables) -> Verdict:
    """N = 2, distances squared, |r| = 1: curvature h = 0 and J J^T = 8 at contact, multiplier scale/4."""

    def growth(scale: float) -> float:
        curvature, steep, lam = 0.0, 8.0, scale / 4
        cubic = [1.0, C, ALPHA * curvature + GAMMA * lam * steep, ALPHA * BETA * steep]
        return float(np.roots(cubic).real.max())

    strong, weak = growth(1.0), growth(0.02)
    bound = ALPHA * BETA / (C * GAMMA)
    return holds_if(
        strong < 0,
        f"linearised at two discs in contact, Table 4: growth rate {strong:.1e} with W = ‖z‖²/2 (λ* = 1/4), but "
        f"{weak:+.1e} with 1/50 of it: it attracts just if c(αh + γλ*‖∇g‖²) > αβ‖∇g‖², here λ* > {bound:.4f}",
    )


def _not_always(_: Tables) -> Verdict:
    stop, four, two = Stationary(TOL), dincl.scenes.four_disks(), _two_discs()
    plain = {
        "two discs": minimise(two, ArrowHurwicz(0.1, 0.1, stop, STEPS, squared=True), throw=False),
        "four discs": minimise(four, ArrowHurwicz(0.1, 0.1, stop, STEPS, squared=True), throw=False),
    }
    damped = [
        minimise(problem, DampedArrowHurwicz(0.1, 0.1, 1.0, 2.0, 1.0, stop, STEPS, squared=True), throw=False)
        for problem in (two, four)
    ]
    left = ", ".join(f"{name} {found.residual:.2f}" for name, found in plain.items())
    done = " and ".join(f"{found.iterations}" for found in damped)
    return holds_if(
        not any(found.status for found in plain.values()) and all(found.status for found in damped),
        f"residual after {STEPS} steps, distances squared: {left}; the damped method meets {TOL:g} after {done} steps",
    )


def _rescaled(_: Tables) -> Verdict:
    """A power of two, so that equal means equal to the last bit."""
    scene, dtau, stop = dincl.scenes.four_disks(), 4.0, 1e-5
    alpha, beta, gamma = 0.1, 0.1, 1.0
    one = DampedArrowHurwicz(alpha, beta, gamma, 1.5, 1.0, RelativeMove(stop), STEPS)
    other = DampedArrowHurwicz(
        alpha / dtau**2, beta / dtau, gamma / dtau**2, 1.5 / dtau, dtau, RelativeMove(stop / dtau), STEPS
    )
    a, b = minimise(scene, one), minimise(scene, other)
    apart = float(np.abs(a.x - b.x).max())
    return holds_if(
        a.iterations == b.iterations and apart == 0,
        f"Δτ = {dtau:g} with α/Δτ², γ/Δτ², β/Δτ, c/Δτ, ε/Δτ against Δτ = 1, four discs: {a.iterations} and "
        f"{b.iterations} steps, {apart:g} apart",
    )


REST = np.array([1.0, 2.0])


def _pulled() -> dincl.Problem:
    """One particle without constraints, W = |x - REST|^2/2; at the start grad W is a fortieth of x."""
    return dincl.Problem([1.025 * REST], lambda _t, x: REST - x)


def _update(_: Tables) -> Verdict:
    problem = _pulled()
    step = minimise(problem, DampedArrowHurwicz(ALPHA, BETA, GAMMA, C, 1.0, Stationary(TOL), 1), throw=False)
    ratio = float((step.x - problem.x0)[0, 0] / (ALPHA * problem.drift(0.0, problem.x0)[0, 0]))
    return corrected_if(
        abs(ratio - 1) < 1e-6,
        abs(ratio - 0.5) < 1e-6,
        f"the formula above it divides by 1 + cΔτ/2 = 2: the step is {ratio:.4f} times the printed one, so α/2 and γ/2 "
        "must stand for α and γ, in (3.27) and (3.28) as well; then (3.32) gives μ = 2Δt/(n* α) = 0.267",
    )


def _stopping(_: Tables) -> Verdict:
    found = minimise(_pulled(), DampedArrowHurwicz.published())
    gradient = float(np.linalg.norm(found.x - REST) / np.linalg.norm(found.x))
    bound = EPS / ALPHA
    return corrected_if(
        gradient <= bound,
        gradient <= 2 * bound,
        f"W = ‖z - a‖²/2 with Table 4: after {found.iterations} steps ‖∇W‖/‖z‖ = {gradient:.4f}: the bound is 2ε/α = "
        f"{2 * bound:.2f}, since the step is α/2 (with Δτ: 2ε/(αΔτ))",
    )


CLAIMS = (
    Claim(
        "c3.arrow-hurwicz",
        "Method 3.3",
        "z_{n+1} := z_n - α(∇W(z_n) + Σ λ_ℓ ∇g_ℓ(z_n)), λ_{ℓ,n+1} := min(0, λ_{ℓ,n} - β g_ℓ(z_{n+1}))",
        _method,
    ),
    Claim(
        "c3.equilibria",
        "(3.21), (3.22)",
        "attractive equilibria of the constructed dynamical system … ż = -α(∇W + Σ λ_ℓ ∇g_ℓ), λ̇_ℓ = -βg_ℓ",
        _equilibria,
    ),
    Claim(
        "c3.not-always",
        "section 2.3",
        "the direct application of the Arrow-Hurwicz algorithm does not always converge for … non-overlapping spheres",
        _not_always,
    ),
    Claim("c3.daha-multiplier", "Method 3.4", "λ_{ℓ,n+1} = min(0, λ_{ℓ,n} - Δτ β g_ℓ(z_n))", _damped_multiplier),
    Claim("c3.rescaled", "Remark 3.5", "For example, we can choose without loss of generality Δτ = 1.", _rescaled),
    Claim(
        "c3.attractive",
        "section 2.3",
        "For special cases such as N = 2 … the underlying dynamical system … has an attractive equilibrium",
        _attractive,
    ),
    Claim("c3.update", "(3.26)", "z_{n+1} = z_n - α∇W(z_n) + Σ (αλ_ℓ - γλ_ℓ g_ℓ(z_n)) ∇g_ℓ", _update),
    Claim("c3.stopping", "Remark 3.6", "‖∇W(z_{n*})‖ / ‖z_{n*}‖ ≤ ε/α = 10⁻⁶/10⁻⁴ = 0.01", _stopping),
)
