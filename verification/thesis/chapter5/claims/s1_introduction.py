"""Chapter 5, section 1: what the introduction says."""

from __future__ import annotations

from typing import Any

import numpy as np

from verification.claims import (
    Correction,
    Effect,
    Evidence,
    FormalProof,
    Verdict,
    at_least,
    at_most,
    claim,
    equal,
    proved,
    put_right,
)
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter5.instant import TOL, WRONG, effective_force, force1, with_springs
from verification.thesis.chapter5.lemmas import inverses
from verification.thesis.chapter5.wavy import symbolic_soft


@claim(
    "c5.diffusive-scaling",
    "Diffusion looks the same under (t, x) ↦ (εt, ε²x).",
    source="section 1",
    quote="the diffusive scaling limit requires (t, x) ↦ (εt, ε²x)",
    correction=Correction(
        "(t, x) ↦ (ε²t, εx)",
        Effect.NUMBER,
        "the next sentence, which has ε²x for εx; that scaled positions leave the constraints stands",
        why="diffusion keeps x²/t: if lengths are multiplied by ε, times are by ε²",
        place=3099,
    ),
)
def _diffusive() -> Evidence:
    """The density of Brownian motion; a scaled one keeps its integral by the factor of x."""
    sp = library()
    x, t, e = sp.symbols("x t epsilon", positive=True)

    def density(at: Any, time: Any) -> Any:
        return sp.exp(-(at**2) / (4 * time)) / sp.sqrt(time)

    return put_right(
        identity(
            "Brownian motion keeps its density under (t, x) ↦ (ε²t, εx), for every ε",
            lambda s: density(e ** (2 - s) * x, e ** (1 + s) * t) * e ** (2 - s) - density(x, t),
            "under (εt, ε²x)",
            0,
        )
    )


@claim(
    "c5.scaled-positions",
    "Scaled positions need not fulfil the constraints that the positions fulfil.",
    source="section 1",
    quote=("if x is subject to constraints, this scaling is ill-posed since ε²x might not satisfy the … constraints"),
    recorded=Verdict.PROVED,
    rests_on=("c5.diffusive-scaling",),
    chosen="εx, too, which c5.diffusive-scaling puts in the place of ε²x",
)
def _scaled_positions() -> Evidence:
    """The straight fibre, g = X/y; e is the factor of X, epsilon or epsilon^2."""
    return proved(
        implication(
            "for g = X/y and X ≠ 0 g(eX, y) ≠ g(X, y) for every factor 0 < e < 1, ε and ε² among them",
            lambda s, x, y, e, g, other: ([x > 0, y > 0, e > 0, e < s, g * y == x, other * y == e * x], other < g),
            "for e = 1",
            2,
        )
    )


@claim(
    "c5.inverse-mass",
    "The inverse mean-field mass changes by at most a constant times the distance of two measures.",
    source="section 1",
    quote="μ ↦ (∫ m_eff⁽¹⁾(x, y) dμ(x))⁻¹ is bounded and Lipschitz continuous",
    recorded=Verdict.PROVED,
    rests_on=(
        "c5.inverse",
        "c5.elliptic",
        "c5.dual",
    ),
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
    "Two solutions that start close to each other stay close: W₁, ‖y₁ + y₂‖ and ‖ẏ₁ + ẏ₂‖ are bounded.",
    source="section 1",
    quote="W₁(μ₁ᵗ, μ₂ᵗ) + ‖y₁ + y₂‖ + ‖ẏ₁ + ẏ₂‖ ≤ C e^{Lt} (…)",
    correction=Correction(
        "W₁(μ₁ᵗ, μ₂ᵗ) + ‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖ ≤ C e^{Lt} (…), as in (5.60)",
        Effect.CONCLUSION,
        "the main result as the introduction states it; Theorem 5.16 has the right signs",
        why="for two equal solutions the right side is 0, the printed sums are not; (5.60) has differences",
        place=3131,
    ),
    rests_on=("c5.same-estimate",),
)
def _estimate() -> Evidence:
    """Equal solutions, one coordinate."""
    return put_right(
        implication(
            "equal solutions have ‖y₁ − y₂‖ = 0, as the right side asks",
            lambda s, y, z, n: ([y == z, n == y - s * z], n == 0),
            "‖y₁ + y₂‖ = 0",
        )
    )


@claim(
    "c5.generalises",
    "The results contain those for linear constraints and forces.",
    source="section 1",
    quote=(
        "This article generalises … Instead of assuming that the constraints and forces are linear, we allow nonlinear"
    ),
    correction=Correction(
        (
            "linear forces are excluded by (A1b), (A1d); with a constant Φ the bounds can be dropped, and then "
            "the linear case is included"
        ),
        Effect.CONCLUSION,
        "Theorems 5.9, 5.12 and 5.16 do not apply to the linear case of the previous work as they stand",
        why=(
            "(A1b) and (A1d) ask for bounded forces, and a linear force is not bounded unless it is 0; the bounds"
            " are needed only where Φ changes"
        ),
        place=3135,
    ),
    rests_on=("c5.effective",),
    tried_on="one spring, g = X − y",
)
def _generalises() -> Evidence:
    """Linear forces and g = X - y: the size of F1, and difference quotients of the force on y, near and far."""
    system = with_springs(lambda X, y: X - y)
    near, far = (float(np.abs(force1(system, np.array([[x]]))).max()) for x in (1.0, 1e6))

    def slope(x: float) -> float:
        there, back = (effective_force(system, np.array([[x + s]]), np.ones(1), np.ones(1)).item() for s in (0.5, -0.5))
        return abs(there - back)

    return Evidence(
        printed=(at_most("‖F₁‖ of a linear force at |X| = 10⁶ over ‖F₁‖ at |X| = 1", far / near, 1.0, TOL),),
        corrected=(
            at_least("‖F₁‖ of a linear force at |X| = 10⁶", far, 1 / WRONG),
            equal("slope of F_eff at X = 10⁶ over the slope at X = 1, for a constant Φ", slope(1e6) / slope(1), 1, TOL),
        ),
    )


def mass_rates() -> FormalProof:
    """Prove the rate of the effective mass of g = X + sin(X)/2 - y and of g = X - y, one particle, X' = Phi(X) y'."""
    sp = library()
    x, m, v = sp.symbols("X m v")
    phi = symbolic_soft(x)
    return identity(
        "d/dt(1 + mΦ²) is mΦ⁴ sin(X) ẏ for g = X + sin(X)/2 − y, not 0 where sin X and ẏ are not, and 0 for g = X − y",
        lambda s: [
            (m * phi**2).diff(x) * phi * v - s * m * phi**4 * sp.sin(x) * v,
            (1 + m * sp.Integer(1) ** 2).diff(x),
        ],
        "0 for both",
        0,
    )


@claim(
    "c5.changing-mass",
    "With nonlinear constraints the effective mass changes during the motion.",
    source="section 1; introduction, Part III",
    also=("c0.mean-field-mass",),
    quote="the mean-field mass is non-constant in contrast to the linear case",
    recorded=Verdict.PROVED,
    rests_on=("c5.effective",),
)
def _changing_mass() -> Evidence:
    return proved(mass_rates())
