"""Chapter 5, sections 2.4 and 2.5: boundedness and Lipschitz constants of the terms of the equations."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.claims.formal.algebra import library, squares, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter5.general import curved, eliminated, m, phiT
from verification.thesis.chapter5.instant import Floats, kernel, wavy_system
from verification.thesis.chapter5.lemmas import PRODUCTS

sp = library()

# What rounding leaves.
ROUNDING = 1e-12
SEED, SAMPLES = 57, 200

S, n, M, h = reals("S n M h")
TERMS = [n >= 1, M >= 0, n * M >= S, -n * M <= S, h <= M, h >= -M]

_any_number = argument(
    "c5.any-number",
    "Lemma 5.6",
    "m_eff and F_eff are bounded and Lipschitz continuous … The derived bounds do not depend on N",
    "Effective mass and force have bounds and Lipschitz constants that do not depend on N.",
    follows(
        TERMS,
        [S + h <= (n + 1) * M, S + h >= -(n + 1) * M],
        S + h <= n * M,
        "if n terms, or their differences, are at most M and a sum of them at most nM, the next sum is at most (n + "
        "1)M: bounds and Lipschitz constants of means over particles do not depend on N",
        "at most nM",
    ),
    *PRODUCTS,
    rests_on=("c5.product", "c5.one-particle", "c5.kernel-lipschitz"),
    chosen="distance of positions: the largest over the particles",
)

_one_particle = identity(
    "c5.one-particle",
    "proof of Lemma 5.6",
    "F_eff⁽¹⁾ = F₀(y) + Φ(X, y)ᵀF₁(X) + mΩ(X_i, y)[v, v]",
    "The effective force of one particle is F₀ + ΦᵀF₁ + mΩ[v, v].",
    right=eliminated(),
    wrong=eliminated() + m * phiT * curved + m * curved,
    correction=Correction(
        "F_eff⁽¹⁾ = F₀(y) + Φ(X, y)ᵀ(F₁(X) − mΩ(X, y)[v, v])",
        Effect.MODEL,
        "the force in (5.41b), to which this definition belongs; (5.14) is right, the lemma stands",
        why="(5.14) has −mΦᵀΩ: mΩ[v, v] is in ℝ^nx and cannot be added to F₀ in ℝ^ny, and its sign is the other one",
        place=3492,
    ),
    rests_on=("c5.reduced-model",),
)

_product = argument(
    "c5.product",
    "proof of Lemma 5.6",
    "if h₁, h₂ are both bounded and Lipschitz continuous, then the product h₁h₂ is also bounded and Lipschitz",
    "Products of bounded Lipschitz continuous functions are bounded and Lipschitz continuous.",
    *PRODUCTS,
)


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
    system = wavy_system(0.7)._replace(V=lambda r: np.sqrt(1 + (r**2).sum(axis=-1)))
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


# Phi of one row and three columns; more rows and more particles add more squares of the same kind.
row, w, mass = (
    sp.Matrix([sp.symbols("p:3", real=True)]),
    sp.Matrix(sp.symbols("w:3", real=True)),
    sp.Symbol("m", positive=True),
)
M_EFF = sp.eye(3) + mass * row.T * row

_elliptic = argument(
    "c5.elliptic",
    "proof of Lemma 5.8",
    "m_eff is symmetric, wᵀ m_eff w ≥ ‖w‖² for all w ∈ ℝ^ny",
    "The effective mass is symmetric and at least the mass of the macroscopic component.",
    vanishes(M_EFF.T - M_EFF, M_EFF.T + M_EFF, "I + mΦᵀΦ is symmetric", "skew"),
    squares(
        sp.expand((w.T * M_EFF * w)[0] - w.dot(w)),
        sp.expand((w.T * M_EFF * w)[0] - 2 * w.dot(w)),
        [(mass, (row * w)[0])],
        "wᵀ m_eff w − ‖w‖² = m Σ (Φw)² for each row of Φ and each particle",
        "wᵀ m_eff w ≥ 2‖w‖²",
    ),
    rests_on=("c5.reduced-model",),
)
