"""Chapter 5, sections 2.4 and 2.5: boundedness and Lipschitz constants of the terms of the equations."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, proved, put_right
from verification.formal.algebra import identity, library, sum_of_squares
from verification.formal.reals import implication
from verification.thesis.chapter5.bounded import FlowState, constants, force, mass
from verification.thesis.chapter5.general import multiplier, particle
from verification.thesis.chapter5.instant import Floats, kernel, wavy_system
from verification.thesis.chapter5.lemmas import products
from verification.thesis.chapter5.wavy import soft

# What rounding leaves.
ROUNDING = 1e-12
SEED, SAMPLES = 57, 200
M, SPEED, FAR = 0.7, 3.0, 200.0


def pair(rng: np.random.Generator, count: int, apart: float) -> tuple[FlowState, FlowState]:
    """Return two states of ``count`` particles far from 0, about ``apart`` from each other, with |v| <= SPEED."""
    X, y, v = rng.normal(0.0, FAR, count), rng.normal(), SPEED * rng.uniform(-1, 1)
    w = np.full(count, 1 / count)
    moved = FlowState(X + apart * rng.uniform(-1, 1, count), w, y + apart * rng.uniform(-1, 1), v)
    return FlowState(X, w, y, v), moved._replace(v=float(np.clip(v + apart * rng.uniform(-1, 1), -SPEED, SPEED)))


def steepest(count: int) -> float:
    """Return the largest quotient |h(a) - h(b)| / |a - b| of the right side h over random pairs of states.

    The distance is max_i |X_i - X_i'| + |y - y'| + |v - v'| on both sides, h = (Phi(X_i)[v], v, F_eff/m_eff).
    """
    rng, found = np.random.default_rng(SEED), 0.0
    for apart in np.repeat([1e-3, 0.1, 2.0], SAMPLES // 3):
        a, b = pair(rng, count, float(apart))
        far = np.abs(soft(a.X) * a.v - soft(b.X) * b.v).max() + abs(a.v - b.v)
        far += abs(force(a) / mass(a) - force(b) / mass(b))
        found = max(found, float(far / (np.abs(a.X - b.X).max() + abs(a.y - b.y) + abs(a.v - b.v))))
    return found


@claim(
    "c5.globally-lipschitz",
    "At bounded speed the right side of the reduced equations is Lipschitz continuous for all positions.",
    source="section 2.5",
    quote="(A1a) to (A5b) are chosen such that the ODE model is globally Lipschitz",
    rests_on=("c5.acceleration-lipschitz",),
    tried_on="g = X + sin(X)/2 − y with forces and interaction, 1, 8 and 64 particles, |X| of about 200, |v| ≤ 3",
    chosen="read with the sentences after it, for ‖v‖ ≤ M_v: Φ[v] and Ω[v, v] have no constant for all v",
)
def _global() -> Evidence:
    """The bound: v and Phi[v] by the rule for products, F_eff/m_eff with m_eff >= 1."""
    c = constants(SPEED)
    bound = max(1 + c.m_phi, c.l_phi * SPEED) + c.l_force + c.m_force * c.l_mass
    return Evidence(
        printed=tuple(
            at_most(
                f"difference quotient of (Φ[v], v, F_eff/m_eff), N = {count}, bound by (A1) to (A5)",
                steepest(count),
                bound,
            )
            for count in (1, 8, 64)
        ),
        seed=SEED,
    )


@claim(
    "c5.any-number",
    "Effective mass and force have bounds and Lipschitz constants that do not depend on N.",
    source="Lemma 5.6",
    quote="m_eff and F_eff are bounded and Lipschitz continuous … The derived bounds do not depend on N",
    recorded=Verdict.PROVED,
    rests_on=(
        "c5.product",
        "c5.one-particle",
        "c5.kernel-lipschitz",
    ),
    chosen="distance of positions: the largest over the particles",
)
def _any_number() -> Evidence:
    """Means of N numbers below a bound stay below it, by induction; what is averaged are products, see c5.product."""
    return proved(
        implication(
            "if n terms, or their differences, are at most M and a sum of them at most nM, the next sum is at most "
            "(n + 1)M: bounds and Lipschitz constants of means over particles do not depend on N",
            lambda s, S, n, M, h: (
                [n >= 1, M >= 0, n * M >= S, -n * M <= S, h <= M, h >= -M],
                [S + h <= (n + s) * M, S + h >= -(n + s) * M],
            ),
            "at most nM",
            0,
        ),
        *products("the terms"),
    )


@claim(
    "c5.one-particle",
    "The effective force of one particle is F₀ + ΦᵀF₁ + mΩ[v, v].",
    source="proof of Lemma 5.6",
    quote="F_eff⁽¹⁾ = F₀(y) + Φ(X, y)ᵀF₁(X) + mΩ(X_i, y)[v, v]",
    correction=Correction(
        "F_eff⁽¹⁾ = F₀(y) + Φ(X, y)ᵀ(F₁(X) − mΩ(X, y)[v, v])",
        Effect.MODEL,
        "the force in (5.41b), to which this definition belongs; (5.14) is right, the lemma stands",
        why=("(5.14) has −mΦᵀΩ: mΩ[v, v] is in ℝ^nx and cannot be added to F₀ in ℝ^ny, and its sign is the other one"),
        place=3492,
    ),
    rests_on=("c5.effective",),
)
def _one_particle() -> Evidence:
    """The terms of one particle, with Phi^T Omega as in (5.14) or with Omega alone."""
    p = particle()
    return put_right(
        identity(
            "(5.6b) without λ is (5.11a) with F_eff⁽¹⁾ = F₀ + Φᵀ(F₁ − mΩ[v, v]), any nx, ny",
            lambda s: (
                p.BT * multiplier(p)
                + p.phiT * p.f
                - p.m * p.phiT * p.phi * p.a
                - (p.m * p.phiT * p.curved if s == 1 else -p.m * p.curved)
            ),
            "with F_eff⁽¹⁾ = F₀ + ΦᵀF₁ + mΩ[v, v]",
        )
    )


@claim(
    "c5.product",
    "Products of bounded Lipschitz continuous functions are bounded and Lipschitz continuous.",
    source="proof of Lemma 5.6",
    quote=("if h₁, h₂ are both bounded and Lipschitz continuous, then the product h₁h₂ is also bounded and Lipschitz"),
    recorded=Verdict.PROVED,
)
def _product() -> Evidence:
    return proved(*products("values of any functions"))


@claim(
    "c5.kernel-lipschitz",
    "By (A2b) and (A2c) the interaction is Lipschitz continuous in both positions.",
    source="proof of Lemma 5.6",
    quote="K is bounded and Lipschitz by (A2b) and (A2c)",
    correction=Correction(
        "K is bounded and Lipschitz by (A2a) to (A2c)",
        Effect.PROOF,
        "nothing: (A2a) is among the assumptions",
        why="(A2b) is about the first position only; (A2a) carries it over to the second one",
        place=3500,
    ),
    tried_on="𝒱(r) = √(1 + |r|²), 200 pairs in the plane",
)
def _kernel() -> Evidence:
    """K of V = sqrt(1 + r^2): differences in both positions; and sin(X) cos(Z^2), which has (A2b), (A2c) only."""
    system = wavy_system(M)._replace(V=lambda r: np.sqrt(1 + (r**2).sum(axis=-1)))
    X, other, Z = 2 * np.random.default_rng(SEED).normal(size=(3, SAMPLES, 2))
    apart = np.linalg.norm(X - other, axis=-1)

    def slope(there: Floats, back: Floats) -> float:
        return float((np.linalg.norm(there - back, axis=-1) / apart).max())

    first = slope(kernel(system, X, Z), kernel(system, other, Z))
    second = slope(kernel(system, Z, X), kernel(system, Z, other))
    size = float(np.linalg.norm(kernel(system, X, Z), axis=-1).max())
    line = np.linspace(0.0, 1.0, 100001)
    near, far = (float((np.abs(np.diff(np.cos((s * line) ** 2))) / np.diff(s * line)).max()) for s in (10, 100))
    return Evidence(
        printed=(
            at_most("slope in Z of sin(X)cos(Z²), |Z| ≤ 100 over |Z| ≤ 10, without (A2a)", far / near, 1.0, ROUNDING),
        ),
        corrected=(
            at_most("slope of K in the first position, bound L_K", first, 1.0, ROUNDING),
            at_most("slope of K in the second position, bound L_K", second, 1.0, ROUNDING),
            at_most("|K|, bound M_K", size, 1.0, ROUNDING),
        ),
        seed=SEED,
    )


@claim(
    "c5.acceleration-lipschitz",
    "The acceleration of the macroscopic component is Lipschitz continuous at bounded speed.",
    source="Lemma 5.8",
    quote="(X⁽ᴺ⁾, y, v) ↦ (m_eff⁽ᴺ⁾)⁻¹ F_eff⁽ᴺ⁾ is Lipschitz continuous … with ‖v‖ ≤ M_v",
    recorded=Verdict.PROVED,
    rests_on=("c5.any-number", "c5.inverse", "c5.elliptic"),
)
def _acceleration() -> Evidence:
    """The rule for products with the constants of Lemma 5.7 for m_eff^-1: i = |m_eff^-1|, k its Lipschitz constant."""
    return proved(
        *products("m_eff⁻¹ and F_eff"),
        implication(
            "with |m_eff⁻¹| ≤ 1/δ and Lip(m_eff⁻¹) ≤ Lip(m_eff)/δ² m_eff⁻¹F_eff has the constant L_F/δ + M_F "
            "Lip(m_eff)/δ²",
            lambda s, d, MF, LF, Lm, i, k: (
                [d > 0, MF > 0, LF >= 0, Lm > 0, i >= 0, k >= 0, i * d <= 1, k * d * d <= Lm],
                (i * LF + k * MF) * d * d <= d * LF + s * Lm * MF,
            ),
            "L_F/δ − M_F Lip(m_eff)/δ²",
        ),
    )


@claim(
    "c5.elliptic",
    "The effective mass is symmetric and at least the mass of the macroscopic component.",
    source="proof of Lemma 5.8",
    quote="m_eff is symmetric, wᵀ m_eff w ≥ ‖w‖² for all w ∈ ℝ^ny",
    recorded=Verdict.PROVED,
    rests_on=("c5.effective",),
)
def _elliptic() -> Evidence:
    """Phi of one row and three columns; more rows and more particles add more squares of the same kind."""
    sp = library()
    phi, w = sp.Matrix([sp.symbols("p:3", real=True)]), sp.Matrix(sp.symbols("w:3", real=True))
    m = sp.Symbol("m", positive=True)
    mass = sp.eye(3) + m * phi.T * phi
    return proved(
        identity("I + mΦᵀΦ is symmetric", lambda s: mass.T - s * mass, "skew"),
        sum_of_squares(
            "wᵀ m_eff w − ‖w‖² = m Σ (Φw)² for each row of Φ and each particle",
            lambda s: sp.expand((w.T * mass * w)[0] - s * w.dot(w)),
            [(m, (phi * w)[0])],
            "wᵀ m_eff w ≥ 2‖w‖²",
            2,
        ),
    )
