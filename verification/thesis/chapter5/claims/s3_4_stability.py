"""Chapter 5, section 3.4: the distance of measures and the proof of the stability estimate."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import reals
from verification.claims.formal.stated import argument, implication
from verification.thesis.chapter5.lemmas import GRONWALL, MEANS_APART

w, x, shift = library().symbols("w x a", positive=True)

_dual = argument(
    "c5.dual",
    "(5.59); Lemma 5.15",
    "W₁(ν, μ) = sup |∫ϕ dν − ∫ϕ dμ| over ϕ ∈ C(ℝⁿˣ, ℝⁿˣ), Lip(ϕ) ≤ 1",
    "The distance of two measures is the largest difference of the means of a function.",
    MEANS_APART,
    vanishes(
        w * (x + shift) - w * x - w * shift,
        w * (x + shift) - w * x - 2 * w * shift,
        "ϕ(x) = x, with Lip(ϕ) = 1, attains the cost of moving all mass by a",
        "the cost of moving it by 2a",
    ),
    also=("c5.integrals",),
    tried_on="a measure on a line and its shift",
    chosen="ϕ with values in ℝ, see c5.dual-values, and as printed in ℝⁿˣ with a norm for |·|",
)

_fundamental = argument(
    "c5.fundamental",
    "Lemma 5.17; (5.64)",
    "‖z₁(t) − z₂(t)‖ ≤ ϱ e^{Lt} + ε/L (e^{Lt} − 1)",
    "Solutions of two equations move apart by at most ϱe^{Lt} + ε/L (e^{Lt} − 1).",
    *GRONWALL,
    also=("c5.flow-estimate",),
    chosen="z, z′ ∈ A, see c5.fundamental-set",
)


# One piece of a transport plan from x to z, r = |x - z|: a = |X1(x) - X2(x)|, b = |X2(x) - X2(z)|, L = Lip(X2).
n, a, b, r, L = reals("n a b r L")

_stability_step = implication(
    "c5.stability-step",
    "(5.65)",
    "W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖_X + W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
    "Two measures are at most C_μ‖X₁ᵗ − X₂ᵗ‖ farther apart than at the start.",
    given=[r > 0, a >= 0, b >= 0, L > 0, n <= a + b, b <= L * r],
    then=n <= a + L * r,
    wrong=n <= a + r,
    correction=Correction(
        "W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖ + Lip(X₂ᵗ) W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
        Effect.PROOF,
        "Theorem 5.16 stands with larger C and L, since Lip(X₂ᵗ) ≤ exp(L_Φ M_v t); it is 1 if all are shifted",
        why=(
            "the function that is integrated over both initial measures is ϕ∘X₂ᵗ, with a Lipschitz constant up to "
            "Lip(ϕ) Lip(X₂ᵗ), and flows stretch"
        ),
        place=3924,
    ),
    rests_on=("c5.dual",),
)
