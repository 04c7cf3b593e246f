"""Chapter 5, section 2.2: the reduced equations, their effective mass and force."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import matrices, vanishes
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter5.general import BT, B, G, a, curved, dB, dG, f, m, multiplier, phi, phiT, v
from verification.thesis.chapter5.lemmas import REDUCED

# The force of a particle alone, that of the others, K(X, X), and Phi^T of another particle.
own, others = matrices("F1 K")

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
