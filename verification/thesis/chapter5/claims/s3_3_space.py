"""Chapter 5, section 3.3: the equations as an ODE in the space Z of flows, (5.54) to (5.58)."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

import numpy as np

from verification.claims import Evidence, FormalProof, Verdict, at_most, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter5.claims.s2_3_examples import with_springs
from verification.thesis.chapter5.claims.s2_4_lipschitz import products
from verification.thesis.chapter5.instant import Floats, phi, wavy_system
from verification.thesis.chapter5.wavy import symbolic_soft
from verification.thesis.text.quoted import claim

# What rounding leaves.
TOL = 1e-8
M = 0.7
# The largest value of 1/(1 + cos(x)/2).
M_PHI = 2.0
DISTANCE = 0.01
LINE = np.linspace(-20.0, 20.0, 401)
# Point masses of mu, at points of LINE.
ATOMS, SHARES = np.array([120, 190, 215, 260]), np.array([0.1, 0.4, 0.3, 0.2])


@claim(
    "c5.linear-growth",
    "The flow stays in the space Y in which its equation is solved.",
    "section 3.3",
    Verdict.PROVED,
    chosen="‖Xᵗ(x)‖ ≤ ‖x‖ + M_Φ M_v t, with M_v = √(2E)",
)
def _linear_growth() -> Evidence:
    """r = |X^t(x)|, x = |x| and c = M_Phi M_v t."""
    return proved(
        implication(
            "as ‖Ẋᵗ‖ ≤ M_Φ M_v, ‖Xᵗ(x)‖ ≤ ‖x‖ + M_Φ M_v t ≤ (1 + M_Φ M_v t)(1 + ‖x‖): Xᵗ is in 𝒴",
            lambda s, r, x, c: ([x >= 0, c > 0, r >= 0, r <= x + c], r <= (1 + s * c) * (1 + x)),
            "(1 + M_Φ M_v t/2)(1 + ‖x‖)",
            0.5,
        )
    )


@claim(
    "c5.bounded-flow",
    "Which assumption makes the velocity field an element of Y.",
    "section 3.3",
    Verdict.CORRECTED,
    tried_on="g = X + sin(X)/2 − y",
)
def _bounded_flow() -> Evidence:
    """The norm of x -> Phi(x, y)[1] in Y: for g = X/y, whose Omega is 0, and for g = X + sin(X)/2 - y."""

    def size(y: float) -> float:
        return norm(phi(with_springs(lambda X, z: X / z), LINE[:, None], np.array([y]))[:, 0, 0])

    near, far = size(0.01), size(1.0)
    wavy = norm(phi(wavy_system(M), LINE[:, None], np.zeros(1))[:, 0, 0])
    return Evidence(
        f"g = X/y has Ω = 0, which fulfils (A5b), but ‖Φ(·, y)[1]‖_Y is {far:.2f} at y = 1 and {near:.0f} at y = 0.01. "
        f"It is (A4b) that bounds it: {wavy:.2f} ≤ M_Φ = {M_PHI:g} for g = X + sin(X)/2 − y.",
        printed=(at_most("‖Φ(·, y)[1]‖_Y of g = X/y, y = 0.01 over y = 1", near / far, 1.0, TOL),),
        corrected=(at_most("‖Φ(·, y)[1]‖_Y of g = X + sin(X)/2 − y", wavy, M_PHI, TOL),),
    )


@claim(
    "c5.lipschitz-constants",
    "Lipschitz constants of integrals as functions of the flow.",
    "Lemma 5.13",
    Verdict.CORRECTED,
    tried_on="ϕ(a) = a and η(a, b) = a + b",
)
def _constants() -> Evidence:
    """Lemma 5.13 for phi(a) = a and eta(a, b) = a + b, Lip = 1: maps that differ by h(1 + |x|), at distance h."""
    h, x, w = DISTANCE, LINE[ATOMS], SHARES
    moment = float(w @ (1 + np.abs(x)))
    moved = x + h * (1 + np.abs(x))
    single = float(w @ moved - w @ x) / h
    double = float(w @ (moved[:, None] + moved) @ w - w @ (x[:, None] + x) @ w) / h
    return Evidence(
        f"Two maps at distance h = {h:g}: the integrals differ by {single:.3f} h and {double:.3f} h, so the constants "
        f"are Lip(ϕ)C_μ = {moment:.3f} and 2Lip(η)C_μ = {2 * moment:.3f}, without the factor ‖φ − ψ‖_Y; they are "
        "sharp.",
        printed=(
            at_most("difference quotient of (5.57), bound C_μ h", single, moment * h, TOL),
            at_most("difference quotient of (5.58), bound 2C_μ h", double, 2 * moment * h, TOL),
        ),
        corrected=(
            at_most("difference quotient of (5.57), bound C_μ", single, moment, TOL),
            at_most("difference quotient of (5.58), bound 2C_μ", double, 2 * moment, TOL),
        ),
    )


@claim(
    "c5.differentiable-flow",
    "The flow has a continuous slope in the initial position.",
    "Theorem 5.12",
    Verdict.PROVED_INSTANCE,
    chosen="g = X + sin(X)/2 − y",
    tried_on="g = X + sin(X)/2 − y",
)
def _differentiable() -> Evidence:
    """J = Phi(X)/Phi(x) along X' = Phi(X) y', and at the start; a quotient of continuous functions, Phi >= 2/3."""
    sp = library()
    t, x = sp.symbols("t x", real=True)
    X, y = sp.Function("X")(t), sp.Function("y")(t)

    J, moved = symbolic_soft(X) / symbolic_soft(x), sp.Symbol("X", real=True)
    rate = symbolic_soft(moved).diff(moved).subs(moved, X) * y.diff(t)

    def residuals(s: Any) -> Any:
        return [J.diff(t).subs(X.diff(t), symbolic_soft(X) * y.diff(t)) - s * rate * J, J.subs(X, x) - 1]

    return proved(
        identity("J = Φ(Xᵗ(x))/Φ(x), which is continuous, solves J̇ = ∂_XΦ[ẏ]J, J = 1 at first", residuals, "−∂_XΦ")
    )


def weighted() -> FormalProof:
    """Prove Lemma 5.13's first line for one more point: d = |phi - psi|, r = |x|, n = |phi - psi|_Y, weight w."""
    return implication(
        "|φ − ψ| ≤ ‖φ − ψ‖_Y (1 + ‖x‖) at each point, so Σ w|φ − ψ| ≤ ‖φ − ψ‖_Y Σ w(1 + ‖x‖), point by point",
        lambda s, d, r, n, w, S, M: (
            [r >= 0, n >= 0, w > 0, d <= n * (1 + s * r), n * M >= S],
            S + w * d <= n * (M + w * (1 + r)),
        ),
        "|φ − ψ| ≤ ‖φ − ψ‖_Y (1 + 2‖x‖)",
        2,
    )


@claim(
    "c5.weighted-difference",
    "The mean distance of two flows by their distance in Y.",
    "proof of Lemma 5.13",
    Verdict.PROVED,
)
def _difference() -> Evidence:
    return proved(weighted())


def norm(values: Floats) -> float:
    """The norm of Y for a function given on LINE."""
    return float((np.abs(values) / (1 + np.abs(LINE))).max())


@claim(
    "c5.right-side",
    "The right side of the mean-field equations is Lipschitz continuous on Z at bounded speed.",
    "proof of Theorem 5.12",
    Verdict.PROVED,
    chosen="the letters of c5.right-side-letters",
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
