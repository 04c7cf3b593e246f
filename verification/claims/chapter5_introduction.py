"""Chapter 5, section 1: what the introduction says."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.chapter5_examples import ONE, X0, M, fibre, shifted, tissue, with_springs
from verification.claims.instant import (
    STEP,
    Floats,
    Instant,
    effective_force,
    effective_mass,
    force1,
    instant,
    wavy_system,
)
from verification.claims.wavy import soft

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-2
SEED = 65
LINE = np.linspace(-20.0, 20.0, 2001)
# Some state of the macroscopic component.
Y, YDOT = np.array([0.4, -0.3]), np.array([0.7, -0.5])


def brownian(x: float, t: float) -> float:
    """The density of Brownian motion that starts at 0."""
    return float(np.exp(-(x**2) / (2 * t)) / np.sqrt(2 * np.pi * t))


def _diffusive(_: Tables) -> Verdict:
    """Diffusion leaves the density of Brownian motion as it is: a G(a x, b t) = G(x, t)."""
    eps, x, t = 0.1, 0.5, 1.0
    printed, right = (a * brownian(a * x, b * t) / brownian(x, t) for a, b in ((eps**2, eps), (eps, eps**2)))
    return corrected_if(
        abs(printed - 1) < TOL,
        abs(right - 1) < TOL,
        f"the density of Brownian motion at ε = {eps}: scaled as printed it is {printed:.3f} times itself, scaled by "
        f"(ε²t, εx) it is {right:.3f} times: the powers are swapped",
    )


def _estimate(_: Tables) -> Verdict:
    """Two equal solutions."""
    y, v = Y, YDOT
    printed, right = (np.linalg.norm(y + s * y) + np.linalg.norm(v + s * v) for s in (1.0, -1.0))
    return corrected_if(
        bool(printed <= 0),
        bool(right <= 0),
        f"for two equal solutions the right side is 0, the left {printed:.2f}; with ‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖, as in "
        f"(5.60), it is {right:g}",
    )


def distance(first: Floats, second: Floats) -> float:
    """W1 of two sets of as many points on a line."""
    return float(np.abs(np.sort(first) - np.sort(second)).mean())


def _inverse_mass(_: Tables) -> Verdict:
    """Pairs of random measures on a line: the inverse masses against the distance, in units of Lip of 1 + m Phi^2."""
    rng = np.random.default_rng(SEED)
    bound = float(np.abs(np.diff(M * soft(LINE) ** 2)).max() / (LINE[1] - LINE[0]))
    ratios = []
    for first, second in rng.normal(0.0, 2.0, (20, 2, 5)):
        inverse = [1 / (1 + M * (soft(x) ** 2).mean()) for x in (first, second)]
        ratios.append(abs(inverse[0] - inverse[1]) / (bound * distance(first, second)))
    return holds_if(
        max(ratios) <= 1,
        f"g = X + sin(X)/2 − y: 20 pairs of measures reach {max(ratios):.2f} of Lip(m_eff⁽¹⁾) W₁(μ₁, μ₂), the "
        "constant of Lemma 5.7 with δ_m = 1",
    )


def _generalises(_: Tables) -> Verdict:
    """Linear forces and g = X - y: the size of F1, and difference quotients of the force on y, near and far."""
    system = with_springs(shifted().system.g)
    sizes = [float(np.abs(force1(system, np.array([[x]]))).max()) for x in (1.0, 1e6)]

    def quotient(x: float) -> float:
        X = (np.array([[x + s]]) for s in (0.5, -0.5))
        there, back = (effective_force(system, one, np.ones(1), np.ones(1)).item() for one in X)
        return abs(there - back)

    near, far = quotient(1.0), quotient(1e6)
    return corrected_if(
        sizes[1] / sizes[0] < 1 + TOL,
        sizes[1] > 1 / WRONG and abs(far / near - 1) < TOL,
        f"linear forces are not bounded ({sizes[0]:.1f} at |X| = 1, {sizes[1]:.0e} at 10⁶), so (A1b), (A1d) leave the "
        f"linear case out. With a constant Φ they need no bound: F_eff has the slope {near:.2f} near, {far:.2f} far",
    )


def _changing_mass(_: Tables) -> Verdict:
    """The rate of the effective mass along the motion, for the examples and for a fibre with g = X + sin(X)/2 - y."""

    def rate(at: Instant) -> float:
        there, back = (effective_mass(at.system, at.X + s * at.U, at.y + s * at.v) for s in (STEP, -STEP))
        return float(np.abs(there - back).max() / (2 * STEP))

    examples, wavy = max(rate(at) for at in (fibre(), shifted(), tissue())), rate(instant(wavy_system(M), X0, *ONE))
    return holds_if(
        wavy > WRONG and examples < TOL,
        f"with g = X + sin(X)/2 − y it changes at a rate of {wavy:.2f}; along the motions of Examples 5.2, 5.3 and "
        f"5.4, however, it is constant (rate {examples:.0e}), since X = F(y)ξ makes Φ[v] = F(v)ξ with a constant ξ",
    )


CLAIMS = (
    Claim("c5.diffusive-scaling", "5, 1", "the diffusive scaling limit requires (t, x) ↦ (εt, ε²x)", _diffusive),
    Claim(
        "c5.inverse-mass", "5, 1", "μ ↦ (∫ m_eff⁽¹⁾(x, y) dμ(x))⁻¹ is bounded and Lipschitz continuous", _inverse_mass
    ),
    Claim("c5.abstract-estimate", "5, 1", "W₁(μ₁ᵗ, μ₂ᵗ) + ‖y₁ + y₂‖ + ‖ẏ₁ + ẏ₂‖ ≤ C e^{Lt} (…)", _estimate),
    Claim(
        "c5.generalises",
        "5, 1",
        "This article generalises … Instead of assuming that the constraints and forces are linear, we allow nonlinear",
        _generalises,
    ),
    Claim(
        "c5.changing-mass", "5, 1", "the mean-field mass is non-constant in contrast to the linear case", _changing_mass
    ),
)
