"""Chapter 5, section 3.3: the equations as an ODE in the space Z of flows, (5.54) to (5.58)."""

from __future__ import annotations

import numpy as np

from verification.claims import Evidence, Verdict, claim, equal, proved
from verification.formal.reals import implication
from verification.thesis.chapter5.instant import TOL, Floats, System, phi
from verification.thesis.chapter5.lemmas import products, weighted
from verification.thesis.chapter5.wavy import runge_kutta

M = 0.7
# The largest value of 1/(1 + cos(x)/2).
DISTANCE = 0.01
# Half the step of central differences of the flow.
SIDE = 1e-4
LINE = np.linspace(-20.0, 20.0, 401)
# Point masses of mu, at points of LINE.
ATOMS, SHARES = np.array([120, 190, 215, 260]), np.array([0.1, 0.4, 0.3, 0.2])


def moved(system: System, X: Floats) -> Floats:
    """Return X (N, 2) at the time 1 for starts X: X' = Phi(X, y)[y'] along a given path y(t) in R^3."""

    def rate(z: Floats) -> Floats:
        t = z[0]
        y, v = np.array([0.4 * np.sin(t), 0.3 * t - 0.3, 0.6 * np.cos(t)]), [0.4 * np.cos(t), 0.3, -0.6 * np.sin(t)]
        return np.concatenate([[1.0], (phi(system, z[1:].reshape(-1, 2), y) @ np.array(v)).ravel()])

    return np.asarray(runge_kutta(rate, np.concatenate([[0.0], X.ravel()]), 1.0, 50))[-1, 1:].reshape(-1, 2)


def norm(values: Floats) -> float:
    """Return the norm of Y for a function given on LINE."""
    return float((np.abs(values) / (1 + np.abs(LINE))).max())


@claim(
    "c5.weighted-difference",
    ("The mean distance of two flows is at most C_μ times their distance in 𝒴, and C_μ is the least such constant."),
    source="proof of Lemma 5.13",
    quote="∫‖φ(x) − ψ(x)‖ dμ(x) ≤ C_μ‖φ − ψ‖_Y",
    recorded=Verdict.HOLDS,
)
def _difference() -> Evidence:
    """The estimate is proved; flows that differ by h(1 + |x|) attain it."""
    apart = DISTANCE * (1 + np.abs(LINE))
    mean, moment = float(SHARES @ apart[ATOMS]), float(SHARES @ (1 + np.abs(LINE[ATOMS])))
    reached = mean / (moment * norm(apart))
    return Evidence(
        "Proved for any measure; flows that differ by h(1 + |x|) attain the bound.",
        printed=(weighted(), equal("mean of |φ − ψ| over C_μ‖φ − ψ‖_Y where φ − ψ = h(1 + |x|)", reached, 1.0, TOL)),
    )


@claim(
    "c5.right-side",
    "The right side of the mean-field equations is Lipschitz continuous on Z at bounded speed.",
    source="proof of Theorem 5.12",
    quote="(φ, y, y) ↦ h(φ, y, ẏ; μⁱⁿⁱᵗ) is Lipschitz continuous provided ‖v‖ ≤ M_v … depends on M_v and C_μ",
    recorded=Verdict.PROVED,
    rests_on=(
        "c5.any-number",
        "c5.inverse",
        "c5.product",
    ),
    chosen="the notation of c5.right-side-letters",
)
def _right_side() -> Evidence:
    """The part of the flow at one point: n = |phi - phi'|_Y, e = |y - y'|, u = |v - v'|, k = L_Phi M_v, r = |x|."""
    return proved(
        weighted(),
        *products("m_eff⁻¹ and F_eff"),
        implication(
            "|Φ[v] − Φ′[v′]| ≤ (L_Φ M_v (‖φ − φ′‖_𝒴 + ‖y − y′‖) + M_Φ‖v − v′‖)(1 + ‖x‖)",
            lambda s, d, n, e, u, k, M, r: (
                [n >= 0, e >= 0, u >= 0, k > 0, M >= 0, r >= 0, d <= k * (n * (1 + r) + e) + M * u],
                d <= (k * (n + s * e) + M * u) * (1 + r),
            ),
            "−‖y − y′‖",
        ),
    )
