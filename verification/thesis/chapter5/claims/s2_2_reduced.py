"""Chapter 5, section 2.2: the reduced equations, their effective mass and force."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter5.general import BT, B, G, a, curved, dB, dG, even, f, m, multiplier, phi, phiT, v
from verification.thesis.chapter5.lemmas import REDUCED

# The force of a particle alone, that of the others, K(X, X), and Phi^T of another particle.
own, others, itself, PT = matrices("F1 K K0 PT")
n, x, z, q = library().symbols("N x z q")
even_potential = even("w")

SINGLE = a + m * phiT * phi * a - phiT * (own - m * curved) - a - (BT * multiplier).subs(f, own + others)

_reduced = argument(
    "c5.reduced-model",
    "section 1; (5.11a), (5.13), (5.14)",
    "(1/N Σ_j m_eff⁽¹⁾(X_j, y)) ÿ = 1/N Σ_j (F_eff⁽¹⁾(X_j, y, ẏ) + 1/N Σ_k K_eff(X_k, X_j))",
    "Eliminating the multipliers leaves one equation for the macroscopic component, with means over particles.",
    REDUCED,
    vanishes(
        SINGLE - phiT * others,
        SINGLE + phiT * others,
        "which is the mean of m_eff⁽¹⁾ÿ − F_eff⁽¹⁾ − 1/N Σ_k K_eff(X_k, X_j) = 0",
        "−K_eff for K_eff",
    ),
    also=("c5.effective",),
    rests_on=("c5.equations", "c5.acceleration"),
)

# d^2 g/dt^2.
BENT = B * a + (dG * phi + dB) * v

_acceleration = identity(
    "c5.acceleration",
    "(5.10); appendix 2, (A.8) to (A.10)",
    "Ẍ_i = Φ_i[ẏ] + Ω_i[ẏ, ẏ]",
    "The acceleration of a particle is Φ_i[ẏ] + Ω_i[ẏ, ẏ].",
    right=G * (phi * a + curved) + BENT,
    wrong=G * (phi * v + curved) + BENT,
    also=("c5.derivation-rate",),
    correction=Correction(
        "Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
        Effect.MODEL,
        "the elimination of Ẍ_i; (5.14), (5.51) and (A.10) are right",
        why="the derivative of Φ_i[ẏ] in time is Φ_i[ÿ] + Ω_i[ẏ, ẏ]; (A.10) has it",
        place=3217,
    ),
    rests_on=("c5.derivation-constraint",),
)

# (5.16) with F_eff^(1) by (5.14) for N = 1, which has K(X, X); then K(X, X) of an even potential.
LEFT = phiT * (own + others / n - m * curved) - phiT * (own + itself - m * curved) - phiT * others / n

_means = argument(
    "c5.means",
    "(5.15), (5.16)",
    "The last equation holds because K(X, X) = 0",
    "The effective force is a mean over single particles and over pairs, because K(X, X) = 0.",
    vanishes(
        LEFT + phiT * itself,
        LEFT,
        "the left side of (5.16) less the right one is −1/N Σ_j Φ_jᵀK(X_j, X_j), for any nx, ny, N",
        "0, whatever K(X, X) is",
    ),
    vanishes(
        even_potential(x - z, q - q).diff(z).subs(z, x),
        even_potential(x - z, q).diff(z).subs(z, x),
        "K(X, X) = 0 for every even 𝒱",
        "other coordinates apart",
    ),
    rests_on=("c5.reduced-model", "c5.even-potential"),
)

_interaction = identity(
    "c5.effective-interaction",
    "after (5.17)",
    "K_eff might not be anti-symmetric. When K_eff is anti-symmetric, the double sum in (5.16) would vanish",
    "K_eff(X_k, X_j) + K_eff(X_j, X_k) = 0 for one and the same Φ: pairs act only through the change of Φ.",
    right=phiT * others + phiT * -others,
    wrong=phiT * others + PT * -others,
    rests_on=("c5.means",),
)
