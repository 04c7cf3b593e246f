"""Chapter 5, section 3.3: the equations as an ODE in the space Z of flows, (5.54) to (5.58)."""

from __future__ import annotations

from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter5.lemmas import PRODUCTS, WEIGHTED

# The part of the flow at one point: n = |phi - phi'|_Y, e = |y - y'|, u = |v - v'|, k = L_Phi M_v, r = |x|. Then the
# rule for products with the constants of Lemma 5.7: i = |m_eff^-1|, lip its Lipschitz constant.
d, n, e, u, k, M, s, MF, LF, Lm, i, lip = reals("d n e u k M r MF LF Lm i l")
FLOW = [n >= 0, e >= 0, u >= 0, k > 0, M >= 0, s >= 0, d <= k * (n * (1 + s) + e) + M * u]
INVERSE = [d > 0, MF > 0, LF >= 0, Lm > 0, i >= 0, lip >= 0, i * d <= 1, lip * d * d <= Lm]

_right_side = argument(
    "c5.right-side",
    "proof of Theorem 5.12; section 2.5; Lemma 5.8",
    "(φ, y, y) ↦ h(φ, y, ẏ; μⁱⁿⁱᵗ) is Lipschitz continuous provided ‖v‖ ≤ M_v … depends on M_v and C_μ",
    "The right side of the mean-field equations is Lipschitz continuous on Z at bounded speed.",
    WEIGHTED,
    *PRODUCTS,
    follows(
        INVERSE,
        (i * LF + lip * MF) * d * d <= d * LF + Lm * MF,
        (i * LF + lip * MF) * d * d <= d * LF - Lm * MF,
        "with |m_eff⁻¹| ≤ 1/δ and Lip(m_eff⁻¹) ≤ Lip(m_eff)/δ² m_eff⁻¹F_eff has the constant L_F/δ + M_F Lip(m_eff)/δ²",
        "L_F/δ − M_F Lip(m_eff)/δ²",
    ),
    follows(
        FLOW,
        d <= (k * (n + e) + M * u) * (1 + s),
        d <= (k * (n - e) + M * u) * (1 + s),
        "|Φ[v] − Φ′[v′]| ≤ (L_Φ M_v (‖φ − φ′‖_𝒴 + ‖y − y′‖) + M_Φ‖v − v′‖)(1 + ‖x‖)",
        "−‖y − y′‖",
    ),
    also=("c5.globally-lipschitz", "c5.acceleration-lipschitz"),
    rests_on=("c5.any-number", "c5.inverse", "c5.product"),
    chosen="the notation of c5.right-side-letters",
)
