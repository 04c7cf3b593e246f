"""Chapter 5, sections 2.5 and 3.3: the energy and what it says about the speed of the macroscopic component."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.instant import (
    Floats,
    Instant,
    force0,
    force1,
    general_instant,
    kernel,
    kinetic,
    omega,
    phi,
    potential,
    pulls,
    pushed,
    slope,
)
from verification.claims.wavy import runge_kutta

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# What the integration of the pendulum leaves, and far above it.
SLACK = 1e-6
M, ENERGY = 0.1, 0.1
WEIGHTS = np.array([0.4, 0.3, 0.2, 0.1])


def along(at: Instant, f: Callable[[Floats, Floats], Floats]) -> float:
    """The rate of f(X, y) along the motion."""
    return float(slope(lambda s: f(at.X + s * at.U, at.y + s * at.v), np.zeros(()), np.ones(())))


def accelerated(at: Instant) -> float:
    """The rate of the kinetic energy."""
    return float(at.v @ at.a + at.system.m * (at.U * at.A).sum(axis=1).mean())


def highest_speed(m: float) -> float:
    """The largest |y'|^2 of (1 + m) y'' = -sin y from y = pi/2 at rest: W0 = -cos y, g = X - y; E = 0."""

    def rate(z: Floats) -> Floats:
        return np.array([z[1], -np.sin(z[0]) / (1 + m)])

    path = runge_kutta(rate, np.array([np.pi / 2, 0.0]), 3.0)
    return float((path[:, 1] ** 2).max())


def free_speed() -> float:
    """|y'| of a free motion with g = X - y, of which the energy is (1 + m)|y'|^2/2."""
    return float(np.sqrt(2 * ENERGY / (1 + M)))


def _energy(_: Tables) -> Verdict:
    at = general_instant()
    rate = accelerated(at) + along(at, lambda X, y: potential(at.system, X, y))
    parts = abs(accelerated(at))
    return holds_if(
        abs(rate) < TOL < parts,
        f"with 𝒱(X_k − X_i), 𝒱 being a function of one vector: the kinetic energy changes at a rate of {parts:.2f}, "
        f"the sum by {abs(rate):.0e}",
    )


def _lagrangian(_: Tables) -> Verdict:
    at = general_instant()
    system, pairs = at.system, at.system.V(at.X[:, None] - at.X[None])
    each = system.m / 2 * (at.U**2).sum(axis=1) - system.W1(at.X) - pairs.mean(axis=0) / 2
    L = at.v @ at.v / 2 - system.W0(at.y) + each.mean()
    E = kinetic(system, at.U, at.v) + potential(system, at.X, at.y)
    printed, right = (abs(at.v @ at.v + s * (at.U**2).sum(axis=1).mean() - E - L) for s in (0.0, system.m))
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"‖ẏ‖² − E differs from L of (5.8) by {printed:.2f}, the particles' kinetic energy twice; "
        f"L = ‖ẏ‖² + m/N Σ_i ‖Ẋ_i‖² − E, by {right:.0e}",
    )


def _bound(_: Tables) -> Verdict:
    """A pendulum that starts at the energy 0; its potential -cos y is at least -1."""
    found, printed, right = highest_speed(M), 0.0, 2 * (0.0 + 1.0)
    return corrected_if(
        found <= printed + SLACK,
        found <= right + SLACK,
        f"W₀ = −cos y fulfils (A1a), (A1b); from y = π/2 at rest E = 0, but ‖ẏ‖² reaches {found:.3f}. It needs "
        f"potentials ≥ 0, or 2(E − their infimum), here {right:g}; the same for M_v in Theorems 5.9, 5.12 and 5.16",
    )


def _constant(_: Tables) -> Verdict:
    return _too_small(2 * ENERGY**2, "2E²", "E³ < ½")


def _constant_limit(_: Tables) -> Verdict:
    return _too_small(2 * ENERGY, "2E", "E < ½")


def _too_small(printed: float, formula: str, where: str) -> Verdict:
    speed, right = free_speed(), float(np.sqrt(2 * ENERGY))
    return corrected_if(
        speed <= printed,
        speed <= right,
        f"a free motion of energy {ENERGY:g} (m = {M:g}, g = X − y) has ‖ẏ‖ = {speed:.3f}, but M_v = {formula} is "
        f"{printed:.3g}; by (5.38) M_v = √(2E) = {right:.3f}. What is printed is too small for {where}",
    )


def _mean_field(_: Tables) -> Verdict:
    """The rate of (5.50) for a measure of four points with unequal weights, by (5.40)."""
    at, w = general_instant(), WEIGHTS
    system, moved = at.system, phi(at.system, at.X, at.y)
    curved = omega(system, at.X, at.y, at.v, at.v)
    each = force1(system, at.X) + np.tensordot(w, pulls(system, at.X), axes=1) - system.m * curved
    mass = np.eye(3) + system.m * np.tensordot(w, moved.transpose(0, 2, 1) @ moved, axes=1)
    a = np.linalg.solve(mass, force0(system, at.y) + w @ pushed(moved, each))

    def stored(X: Floats, y: Floats) -> Floats:
        return np.asarray(system.W0(y) + w @ system.W1(X) + w @ system.V(X[:, None] - X[None]) @ w / 2)

    gained = at.v @ a + system.m * (w @ (at.U * (moved @ a + curved)).sum(axis=1))
    rate = gained + along(at, stored)
    return holds_if(
        abs(rate) < TOL < abs(gained),
        f"with the outer dμᵗ(x), which is left out: for four points of unequal weights the kinetic energy changes at a "
        f"rate of {abs(gained):.2f}, the sum by {abs(rate):.0e}",
    )


def _power(_: Tables) -> Verdict:
    """(5.52) for all pairs of four particles, and the sum (5.53)."""
    at = general_instant()
    X, U, pull = at.X, at.U, pulls(at.system, at.X)
    rates = slope(lambda s: at.system.V((X + s * U)[:, None] - (X + s * U)[None]), np.zeros(()), np.ones(()))
    first = np.einsum("ka,kia->ki", U, pull) - np.einsum("ia,kia->ki", U, pull)
    swapped = kernel(at.system, X[None, :], np.broadcast_to(X[:, None], pull.shape))
    second = -np.einsum("ka,kia->ki", U, swapped) - np.einsum("ia,kia->ki", U, pull)
    total = -(U * pull.mean(axis=0)).sum(axis=1).mean()
    off = max(np.abs(rates - first).max(), np.abs(rates - second).max(), abs(rates.mean() / 2 - total))
    return holds_if(off < TOL, f"both lines of (5.52) and the integral (5.53) hold to {off:.0e}, for an even 𝒱")


CLAIMS = (
    Claim("c5.energy", "Lemma 5.5, (5.37)", "E = … + 1/(2N) Σ_k 𝒱(X_k, X_i)) is a conserved quantity", _energy),
    Claim("c5.speed-bound", "(5.38)", "‖ẏ(t)‖² ≤ 2E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ)", _bound),
    Claim("c5.energy-lagrangian", "proof of Lemma 5.5", "the Lagrangian L = ‖ẏ‖² − E", _lagrangian),
    Claim("c5.speed-constant", "proof of Theorem 5.9", "M_v := 2(E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ))²", _constant),
    Claim(
        "c5.mean-field-energy",
        "Lemma 5.11, (5.50)",
        "E = ½‖ẏ‖² + 𝒲₀(y) + ∫ m/2 ‖Φ(x, y)ẏ‖² + 𝒲₁(x) + ½∫ 𝒱(x′ − x) dμᵗ(x′) is conserved",
        _mean_field,
    ),
    Claim(
        "c5.interaction-power",
        "(5.52), (5.53)",
        "d/dt 𝒱(Xᵗ(x′) − Xᵗ(x)) = −Ẋᵗ(x′)K(Xᵗ(x), Xᵗ(x′)) − Ẋᵗ(x)K(Xᵗ(x′), Xᵗ(x))",
        _power,
    ),
    Claim(
        "c5.speed-constant-limit",
        "proof of Theorem 5.12",
        "M_v := 2E(y, ẏ, μⁱⁿⁱᵗ). Then every solution candidate has to satisfy ‖ẏ(t)‖ ≤ M_v",
        _constant_limit,
    ),
)
