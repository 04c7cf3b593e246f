"""Chapter 5, section 1: what the introduction says."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal, proved
from verification.formal.reals import implication
from verification.thesis.chapter5.claims.s2_3_examples import ONE, X0, M, fibre, shifted, tissue, with_springs
from verification.thesis.chapter5.claims.s2_5_inverse import inverses
from verification.thesis.chapter5.instant import (
    STEP,
    Floats,
    Instant,
    effective_force,
    effective_mass,
    force1,
    general_instant,
    instant,
    wavy_system,
)

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-4
# Some state of the macroscopic component.
Y, YDOT = np.array([0.4, -0.3]), np.array([0.7, -0.5])


def brownian(x: float, t: float) -> float:
    """The density of Brownian motion that starts at 0."""
    return float(np.exp(-(x**2) / (2 * t)) / np.sqrt(2 * np.pi * t))


@claim(
    "c5.diffusive-scaling",
    "The scaling of time and space under which diffusion looks the same.",
    source="section 1",
    quote="the diffusive scaling limit requires (t, x) ↦ (εt, ε²x)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "(t, x) ↦ (ε²t, εx)",
        Effect.NUMBER,
        "the next sentence, which has ε²x for εx; that scaled positions leave the constraints stands",
        why="diffusion keeps x²/t: if lengths are multiplied by ε, times are by ε²",
        place=3099,
    ),
    tried_on="Brownian motion at one point, one time and one ε",
)
def _diffusive() -> Evidence:
    """Diffusion leaves the density of Brownian motion as it is: a G(a x, b t) = G(x, t)."""
    eps, x, t = 0.1, 0.5, 1.0
    printed, right = (a * brownian(a * x, b * t) / brownian(x, t) for a, b in ((eps**2, eps), (eps, eps**2)))
    return Evidence(
        f"The density of Brownian motion at ε = {eps}: scaled as printed it is {printed:.3f} times itself, scaled by "
        f"(ε²t, εx) it is {right:.3f} times: the powers are swapped.",
        printed=(equal("density scaled by (εt, ε²x) over the density", printed, 1.0, TOL),),
        corrected=(equal("density scaled by (ε²t, εx) over the density", right, 1.0, TOL),),
    )


@claim(
    "c5.scaled-positions",
    "Scaled positions need not fulfil the constraints that the positions fulfil.",
    source="section 1",
    quote="if x is subject to constraints, this scaling is ill-posed since ε²x might not satisfy the … constraints",
    chosen="εx, too, which c5.diffusive-scaling puts in the place of ε²x",
)
def _scaled_positions() -> Evidence:
    at, eps = general_instant(), 0.1
    level = at.system.g(at.X, at.y)
    small, large = (float(np.abs(at.system.g(s * at.X, at.y) - level).min(axis=0).max()) for s in (eps**2, eps))
    return Evidence(
        f"Four particles, nx = 2, ny = 3, ε = {eps}: with εX_i in the place of X_i the constraint functions are off "
        f"the values that they have to keep by at least {large:.2f}, with ε²X_i, as printed, by {small:.2f}.",
        printed=(
            at_least("what g(εX_i, y) is off its value", large, WRONG),
            at_least("what g(ε²X_i, y) is off its value", small, WRONG),
        ),
    )


def distance(first: Floats, second: Floats) -> float:
    """W1 of two sets of as many points on a line."""
    return float(np.abs(np.sort(first) - np.sort(second)).mean())


@claim(
    "c5.inverse-mass",
    "The inverse mean-field mass changes by no more than a constant times the distance of two measures.",
    source="section 1",
    quote="μ ↦ (∫ m_eff⁽¹⁾(x, y) dμ(x))⁻¹ is bounded and Lipschitz continuous",
    recorded=Kind.PROVED,
)
def _inverse_mass() -> Evidence:
    """a = |A^-1|, b = |B^-1| for the masses of two measures, r = |A - B| at most L W by Lemma 5.15."""
    return proved(
        inverses(),
        implication(
            "so with |A⁻¹|, |B⁻¹| ≤ 1, m_eff⁽¹⁾ ≥ I, |A⁻¹ − B⁻¹| ≤ Lip(m_eff⁽¹⁾) W₁(μ₁, μ₂)",
            lambda s, a, b, r, L, W, n: (
                [a >= 0, a <= 1, b >= 0, b <= 1, L >= 0, W >= 0, r >= 0, r <= L * W, n <= a * r * b],
                s * n <= L * W,
            ),
            "1.1|A⁻¹ − B⁻¹| ≤ Lip(m_eff⁽¹⁾) W₁(μ₁, μ₂)",
            1.1,
        ),
    )


@claim(
    "c5.abstract-estimate",
    "The main estimate: two solutions stay close to each other if they are so at first.",
    source="section 1",
    quote="W₁(μ₁ᵗ, μ₂ᵗ) + ‖y₁ + y₂‖ + ‖ẏ₁ + ẏ₂‖ ≤ C e^{Lt} (…)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "W₁(μ₁ᵗ, μ₂ᵗ) + ‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖ ≤ C e^{Lt} (…), as in (5.60)",
        Effect.CONCLUSION,
        "the main result as the introduction states it; Theorem 5.16 has the right signs",
        why=("for two equal solutions the right side is 0, the printed sums are not; (5.60) has differences"),
        place=3131,
    ),
    tried_on="two equal solutions",
)
def _estimate() -> Evidence:
    """Two equal solutions."""
    y, v = Y, YDOT
    printed, right = (float(np.linalg.norm(y + s * y) + np.linalg.norm(v + s * v)) for s in (1.0, -1.0))
    return Evidence(
        f"For two equal solutions the right side is 0, the left {printed:.2f}; with ‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖, as in "
        f"(5.60), it is {right:g}.",
        printed=(at_most("‖y₁ + y₂‖ + ‖ẏ₁ + ẏ₂‖ of equal solutions", printed, 0.0),),
        corrected=(at_most("‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖ of equal solutions", right, 0.0),),
    )


@claim(
    "c5.generalises",
    "The results contain those for linear constraints and forces.",
    source="section 1",
    quote=(
        "This article generalises … Instead of assuming that the constraints and forces are linear, we allow nonlinear"
    ),
    recorded=Kind.CORRECTED,
    correction=Correction(
        "linear forces are excluded by (A1b), (A1d); with a constant Φ the bounds can be dropped, and then the "
        "linear case is included",
        Effect.CONCLUSION,
        "Theorems 5.9, 5.12 and 5.16 do not apply to the linear case of the previous work as they stand",
        why=(
            "(A1b) and (A1d) ask for bounded forces, and a linear force is not bounded unless it is 0; the "
            "bounds are needed only where Φ changes"
        ),
        place=3135,
    ),
    tried_on="one spring, g = X − y",
)
def _generalises() -> Evidence:
    """Linear forces and g = X - y: the size of F1, and difference quotients of the force on y, near and far."""
    system = with_springs(shifted().system.g)
    sizes = [float(np.abs(force1(system, np.array([[x]]))).max()) for x in (1.0, 1e6)]

    def quotient(x: float) -> float:
        X = (np.array([[x + s]]) for s in (0.5, -0.5))
        there, back = (effective_force(system, one, np.ones(1), np.ones(1)).item() for one in X)
        return abs(there - back)

    near, far = quotient(1.0), quotient(1e6)
    return Evidence(
        f"Linear forces are not bounded ({sizes[0]:.1f} at |X| = 1, {sizes[1]:.0e} at 10⁶), so (A1b), (A1d) leave the "
        f"linear case out. With a constant Φ they need no bound: F_eff has the slope {near:.2f} near, {far:.2f} far.",
        printed=(at_most("‖F₁‖ of a linear force at 10⁶ over that at 1", sizes[1] / sizes[0], 1.0, TOL),),
        corrected=(
            at_least("‖F₁‖ of a linear force at 10⁶", sizes[1], 1 / WRONG),
            equal("slope of F_eff, far over near", far / near, 1.0, TOL),
        ),
    )


@claim(
    "c5.changing-mass",
    "With nonlinear constraints the effective mass changes during the motion.",
    source="section 1",
    quote="the mean-field mass is non-constant in contrast to the linear case",
)
def _changing_mass() -> Evidence:
    """The rate of the effective mass along the motion, for the examples and for a fibre with g = X + sin(X)/2 - y."""

    def rate(at: Instant) -> float:
        there, back = (effective_mass(at.system, at.X + s * at.U, at.y + s * at.v) for s in (STEP, -STEP))
        return float(np.abs(there - back).max() / (2 * STEP))

    examples, wavy = max(rate(at) for at in (fibre(), shifted(), tissue())), rate(instant(wavy_system(M), X0, *ONE))
    return Evidence(
        f"With g = X + sin(X)/2 − y it changes at a rate of {wavy:.2f}; along the motions of Examples 5.2, 5.3 and "
        f"5.4, however, it is constant (rate {examples:.0e}), since X = F(y)ξ makes Φ[v] = F(v)ξ with a constant ξ.",
        printed=(
            at_least("rate of the mean-field mass of a nonlinear fibre", wavy, WRONG),
            at_most("rate in Example 5.3, which is linear", rate(shifted()), TOL),
        ),
    )
