"""Chapter 5, section 3.3: the equations as an ODE in the space Z of flows, (5.54) to (5.58)."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, equal, proved
from verification.formal.reals import implication
from verification.thesis.chapter5.instant import TOL, Floats, System, general_system, phi, wavy_system, with_springs
from verification.thesis.chapter5.lemmas import products, weighted
from verification.thesis.chapter5.wavy import runge_kutta

M = 0.7
# The largest value of 1/(1 + cos(x)/2).
M_PHI = 2.0
DISTANCE = 0.01
# Half the step of central differences of the flow.
SIDE = 1e-4
LINE = np.linspace(-20.0, 20.0, 401)
# Point masses of mu, at points of LINE.
ATOMS, SHARES = np.array([120, 190, 215, 260]), np.array([0.1, 0.4, 0.3, 0.2])


@claim(
    "c5.linear-growth",
    "The flow stays in the space Y in which its equation is solved.",
    source="section 3.3",
    quote="We pick the function space of continuous and at most linearly growing functions",
    recorded=Verdict.PROVED,
    rests_on=("c5.speed-constant-limit",),
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
    "(A5b) makes the velocity field an element of 𝒴.",
    source="section 3.3",
    quote="(A5b) implies ‖Φ(φ(·), y)[v]‖_Y ≤ M_Φ M_v",
    correction=Correction(
        "(A4b) implies it",
        Effect.NOTATION,
        "nothing: (A4b) is among the assumptions",
        why="(A5b) bounds Ω; (A4b) bounds Φ by M_Φ",
        place=3760,
    ),
    tried_on="g = X + sin(X)/2 − y",
)
def _bounded_flow() -> Evidence:
    """The norm of x -> Phi(x, y)[1] in Y: for g = X/y, whose Omega is 0, and for g = X + sin(X)/2 - y."""

    def size(y: float) -> float:
        return norm(phi(with_springs(lambda X, z: X / z), LINE[:, None], np.array([y]))[:, 0, 0])

    near, far = size(0.01), size(1.0)
    wavy = norm(phi(wavy_system(M), LINE[:, None], np.zeros(1))[:, 0, 0])
    return Evidence(
        printed=(
            at_most("‖Φ(·, y)[1]‖_Y of g = X/y, where Ω = 0, at y = 0.01 over the same at y = 1", near / far, 1.0, TOL),
        ),
        corrected=(at_most("‖Φ(·, y)[1]‖_Y of g = X + sin(X)/2 − y, bound M_Φ of (A4b)", wavy, M_PHI, TOL),),
    )


@claim(
    "c5.lipschitz-constants",
    "Integrals are Lipschitz continuous in the flow with constants that contain ‖φ − ψ‖_Y.",
    source="Lemma 5.13",
    quote="Lipschitz continuous with constants Lip(ϕ)C_μ‖φ − ψ‖_Y and 2Lip(η)C_μ‖φ − ψ‖_Y",
    correction=Correction(
        "with constants Lip(ϕ)C_μ and 2Lip(η)C_μ",
        Effect.NOTATION,
        "nothing: the proof bounds the differences",
        why="‖φ − ψ‖_Y is the distance by which a Lipschitz constant is multiplied, not a part of it",
        place=3774,
    ),
    rests_on=("c5.weighted-difference",),
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
        printed=(
            at_most(
                "difference quotient of (5.57), φ − ψ = h(1 + |x|), bound C_μ h with h = 0.01", single, moment * h, TOL
            ),
            at_most("difference quotient of (5.58), bound 2C_μ h", double, 2 * moment * h, TOL),
        ),
        corrected=(
            at_most("difference quotient of (5.57), bound C_μ", single, moment, TOL),
            at_most("difference quotient of (5.58), bound 2C_μ", double, 2 * moment, TOL),
        ),
    )


def moved(system: System, X: Floats) -> Floats:
    """Return X (N, 2) at the time 1 for starts X: X' = Phi(X, y)[y'] along a given path y(t) in R^3."""

    def rate(z: Floats) -> Floats:
        t = z[0]
        y, v = np.array([0.4 * np.sin(t), 0.3 * t - 0.3, 0.6 * np.cos(t)]), [0.4 * np.cos(t), 0.3, -0.6 * np.sin(t)]
        return np.concatenate([[1.0], (phi(system, z[1:].reshape(-1, 2), y) @ np.array(v)).ravel()])

    return np.asarray(runge_kutta(rate, np.concatenate([[0.0], X.ravel()]), 1.0, 50))[-1, 1:].reshape(-1, 2)


def slope_change(apart: float) -> float:
    """Return the largest change of the slope of the flow between two starts on a line that are so far apart."""
    s = np.linspace(-1.0, 1.0, round(2 / apart) + 1)
    X, system = np.stack([s, 0.5 - 0.3 * s], axis=-1), general_system()
    slopes = [(moved(system, X + side) - moved(system, X - side)) / (2 * SIDE) for side in SIDE * np.eye(2)]
    return float(np.abs(np.diff(slopes, axis=1)).max())


@claim(
    "c5.differentiable-flow",
    "The flow has a continuous slope in the initial position.",
    source="Theorem 5.12",
    quote="(y, X) ∈ C²([0, T], ℝⁿʸ) × C¹([0, T] × ℝⁿˣ, ℝⁿˣ)",
    rests_on=("c5.right-side",),
    tried_on="one constraint with nx = 2, ny = 3, one path y(t), starts on a line",
)
def _differentiable() -> Evidence:
    """Where the slope is continuous, and here Lipschitz continuous, it changes half as much over half the distance."""
    changes = [slope_change(apart) for apart in (0.1, 0.05, 0.025)]
    return Evidence(
        printed=tuple(
            at_most(
                f"change of the slope between starts {where} apart over the change at twice this distance", a / b, 0.6
            )
            for where, b, a in zip((0.05, 0.025), changes, changes[1:], strict=False)
        )
    )


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
    rests_on=("c5.any-number", "c5.inverse", "c5.product", "c5.lipschitz-constants"),
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
