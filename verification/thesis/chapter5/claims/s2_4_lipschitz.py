"""Chapter 5, sections 2.4 and 2.5: boundedness and Lipschitz constants of the terms of the equations."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Evidence, FormalProof, Verdict, at_most, proved, put_right
from verification.formal.algebra import identity, library, sum_of_squares
from verification.formal.enclosures import not_negative
from verification.formal.reals import implication
from verification.thesis.chapter5.bounded import FlowState, constants
from verification.thesis.chapter5.general import multiplier, particle
from verification.thesis.chapter5.instant import (
    Floats,
    kernel,
    wavy_system,
)
from verification.thesis.text.quoted import claim

# What rounding leaves.
ROUNDING = 1e-12
SEED, SAMPLES = 57, 200
M, SPEED = 0.7, 3.0


def pair(rng: np.random.Generator, count: int, apart: float) -> tuple[FlowState, FlowState]:
    """Two states of ``count`` particles at a distance of about ``apart``, with |v| <= SPEED."""
    X, y, v = rng.normal(0.0, 2.0, count), rng.normal(), SPEED * rng.uniform(-1, 1)
    w = np.full(count, 1 / count)
    moved = FlowState(X + apart * rng.uniform(-1, 1, count), w, y + apart * rng.uniform(-1, 1), v)
    return FlowState(X, w, y, v), moved._replace(v=float(np.clip(v + apart * rng.uniform(-1, 1), -SPEED, SPEED)))


def steepest(f: Callable[[FlowState], float], count: int) -> float:
    """The largest |f(a) - f(b)| over max_i |X_i - X_i'| + |y - y'| + |v - v'| of random pairs."""
    rng, found = np.random.default_rng(SEED), 0.0
    for apart in np.repeat([1e-3, 0.1, 2.0], SAMPLES // 3):
        a, b = pair(rng, count, float(apart))
        found = max(found, abs(f(a) - f(b)) / (np.abs(a.X - b.X).max() + abs(a.y - b.y) + abs(a.v - b.v)))
    return found


@claim(
    "c5.globally-lipschitz",
    "The right side of the reduced equations is Lipschitz continuous for all positions.",
    "section 2.5",
    Verdict.PROVED_INSTANCE,
    chosen="read with the sentences after it, for ‖v‖ ≤ M_v: Φ[v] and Ω[v, v] have no constant for all v",
    tried_on="Φ of g = X + sin(X)/2 − y",
)
def _global() -> Evidence:
    """The slope of Phi = 1/(1 + cos(X)/2), of period 2 pi, over one period."""
    steepest = constants(1.0).l_phi
    return proved(
        not_negative(
            f"|∂_X Φ[v]| ≤ {steepest:.5f} ‖v‖ for all X, Φ = 1/(1 + cos(X)/2)",
            lambda s, x: s * steepest * (2 + x.cos()) ** 2 - 2 * abs(x.sin()),
            [(-3.1416, 3.1416)],
            f"|∂_X Φ[v]| ≤ {0.99 * steepest:.5f} ‖v‖",
            0.99,
        )
    )


@claim(
    "c5.any-number",
    "Effective mass and force have bounds and Lipschitz constants that do not depend on N.",
    "Lemma 5.6",
    Verdict.PROVED,
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
    "The effective force of one particle.",
    "proof of Lemma 5.6",
    Verdict.CORRECTED,
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


def products(what: str) -> tuple[FormalProof, FormalProof]:
    """Prove the rule for products of matrices and vectors of any size, by their norms.

    a = |h1|, b = |h2 - h2'|, c = |h1 - h1'|, d = |h2'|, r = |z - z'|, n the norm of the difference.
    """
    return (
        identity(
            f"h₁h₂ − h₁′h₂′ = h₁(h₂ − h₂′) + (h₁ − h₁′)h₂′ for {what}",
            lambda s, A, B, C, D: A * B - C * D - A * (B - D) - s * (A - C) * D,
            "−(h₁ − h₁′)h₂′",
            words=True,
        ),
        implication(
            "so |h₁h₂ − h₁′h₂′| ≤ (M₁L₂ + M₂L₁)|z − z′|",
            lambda s, a, b, c, d, r, n, M1, M2, L1, L2: (
                [
                    a >= 0,
                    b >= 0,
                    c >= 0,
                    d >= 0,
                    r >= 0,
                    M1 >= 0,
                    M2 >= 0,
                    L1 >= 0,
                    L2 >= 0,
                    a <= M1,
                    d <= M2,
                    b <= L2 * r,
                    c <= L1 * r,
                    n <= a * b + c * d,
                ],
                n <= (M1 * L2 + s * M2 * L1) * r,
            ),
            "(M₁L₂ − M₂L₁)|z − z′|",
        ),
    )


@claim(
    "c5.product",
    "Products of bounded Lipschitz continuous functions are such functions.",
    "proof of Lemma 5.6",
    Verdict.PROVED,
)
def _product() -> Evidence:
    return proved(*products("values of any functions"))


@claim(
    "c5.kernel-lipschitz",
    "The interaction is Lipschitz continuous in both positions.",
    "proof of Lemma 5.6",
    Verdict.CORRECTED,
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
        f"sin(X)cos(Z²) has (A2b), (A2c), but its slopes in Z reach {near:.0f} for |Z| ≤ 10, {far:.0f} for |Z| ≤ 100. "
        f"With (A2a) as well, 𝒱(r) = √(1 + |r|²), L_K = M_K = 1, {SAMPLES} pairs in the plane have quotients of up to "
        f"{first:.2f} in the first position, {second:.2f} in the second, |K| ≤ {size:.2f}.",
        printed=(at_most("slope in Z without (A2a), |Z| ≤ 100 over |Z| ≤ 10", far / near, 1.0, ROUNDING),),
        corrected=(
            at_most("slope in the first position", first, 1.0, ROUNDING),
            at_most("slope in the second position", second, 1.0, ROUNDING),
            at_most("|K|", size, 1.0, ROUNDING),
        ),
        seed=SEED,
    )


@claim(
    "c5.acceleration-lipschitz",
    "The acceleration of the macroscopic component is Lipschitz continuous at bounded speed.",
    "Lemma 5.8",
    Verdict.PROVED,
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
    "proof of Lemma 5.8",
    Verdict.PROVED,
)
def _elliptic() -> Evidence:
    """Phi of one row and three columns; more rows and more particles add more squares of the same kind."""
    sp = library()
    phi, w, m = (
        sp.Matrix([sp.symbols("p:3", real=True)]),
        sp.Matrix(sp.symbols("w:3", real=True)),
        sp.Symbol("m", positive=True),
    )
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
