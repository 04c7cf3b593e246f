"""Proofs that several claims of chapter 5 share."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

from verification.claims import FormalProof
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter5.general import eliminated, particle


def reduced() -> FormalProof:
    """Prove (5.11a) for one particle; the equation of y is a mean over particles."""
    return identity("(5.6a), (5.6b) without λ_j are (5.11a) with (5.13), (5.14), any nx, ny, N", eliminated, "−Ω for Ω")


def conserved() -> FormalProof:
    """Prove that (5.37) is constant: the terms of one particle, F0 by (5.11a); see c5.interaction-power."""
    p = particle()

    def rate(s: Any) -> Any:
        force0 = p.a + p.m * p.phiT * p.phi * p.a - p.phiT * (p.f - s * p.m * p.curved)
        kinetic = p.vT * p.a + p.m * p.vT * p.phiT * (p.phi * p.a + p.curved)
        return kinetic - p.vT * force0 - p.vT * p.phiT * p.f

    return identity("dE/dt = 0 along (5.11a), (5.11b), for any nx, ny, N and all forces", rate, "−Ω in F_eff")


def inverses() -> FormalProof:
    """Prove the formula for the difference of two inverses, for matrices of any size."""
    return identity(
        "A⁻¹ − B⁻¹ = A⁻¹(B − A)B⁻¹",
        lambda s, A, B: A**-1 - B**-1 - s * A**-1 * (B - A) * B**-1,
        "A⁻¹(A − B)B⁻¹",
        words=True,
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
                    *(each >= 0 for each in (a, b, c, d, r, M1, M2, L1, L2)),
                    *(a <= M1, d <= M2, b <= L2 * r, c <= L1 * r, n <= a * b + c * d),
                ],
                n <= (M1 * L2 + s * M2 * L1) * r,
            ),
            "(M₁L₂ − M₂L₁)|z − z′|",
        ),
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


def means_apart() -> FormalProof:
    """Prove Lemma 5.15 for one more piece of a plan: w over r = |x - x'|, d = phi(x) - phi(x'), S of cost C."""
    return implication(
        "each piece w(ϕ(x) − ϕ(x′)) ≤ Lip(ϕ) w‖x − x′‖ of any transport plan, so |∫ϕ dμ₁ − ∫ϕ dμ₂| ≤ Lip(ϕ) "
        "times its cost, and times the least cost W₁",
        lambda s, w, r, d, L, S, C: ([w > 0, r > 0, L >= 0, d <= s * L * r, S <= L * C], S + w * d <= L * (C + w * r)),
        "ϕ with the constant 2 Lip(ϕ)",
        2,
    )


def gronwall() -> tuple[FormalProof, FormalProof, FormalProof]:
    """Prove that a size u with u' <= L u + eps stays below b, b' = L b + eps: (u - b) exp(-L t) falls."""
    sp = library()
    t, L, eps, rho = sp.symbols("t L epsilon rho", positive=True)
    u, b = sp.Function("u")(t), rho * sp.exp(L * t) + eps / L * (sp.exp(L * t) - 1)
    return (
        identity(
            "b = ϱe^{Lt} + ε/L (e^{Lt} − 1) solves ḃ = Lb + ε, b(0) = ϱ",
            lambda s: [b.diff(t) - L * b - s * eps, b.subs(t, 0) - rho],
            "−ε",
        ),
        identity(
            "d/dt((u − b)e^{−Lt}) = (u̇ − ḃ − L(u − b))e^{−Lt}",
            lambda s: ((u - b) * sp.exp(-L * t)).diff(t) - ((u - b).diff(t) - s * L * (u - b)) * sp.exp(-L * t),
            "+L",
        ),
        implication(
            "which is ≤ 0 if u̇ ≤ Lu + ε: u stays below b",
            lambda s, du, u, b, L, e: ([L > 0, e >= 0, du <= L * u + e], du - (L * b + s * e) - L * (u - b) <= 0),
            "ḃ = Lb",
            0,
        ),
    )


def bounded_speed() -> FormalProof:
    """Prove that the speed is bounded on each [0, T], whatever the potentials: all forces are bounded.

    u^2/2 is the kinetic energy, so v = |y'| <= u; its rate is the power of F0, F1 and K, with the bounds of (A1b),
    (A1d), (A2c) and (A4b): P <= (M0 + MPhi (M1 + MK)) v.
    """
    return implication(
        "u̇ ≤ M₀ + M_Φ(M₁ + M_K) for ‖ẏ‖ ≤ u: it is bounded on each [0, T]",
        lambda s, u, du, v, P, M0, M1, MK, MP: (
            [
                *(each >= 0 for each in (v, M0, M1, MK, MP)),
                *(u > 0, v <= u, u * du == P, (M0 + MP * (M1 + MK)) * v >= P),
            ],
            du <= M0 + s * MP * (M1 + MK),
        ),
        "u̇ ≤ M₀",
        0,
    )


def estimate() -> tuple[FormalProof, ...]:
    """Prove (5.60) on each [0, T] by a bound of the speed, the rates of its parts and Lemma 5.17.

    a = |y1 - y2|, b = |v1 - v2|, c = int |X1 - X2| with an optimal coupling of the starts; k and p are the constants of
    c5.product and c5.acceleration-lipschitz at bounded speed. W1 is at most c, and equal to it at the start.
    """
    return (
        bounded_speed(),
        implication(
            "‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖ + ∫‖X₁ − X₂‖ grows at most at L times itself",
            lambda s, a, b, c, da, db, dc, kx, ky, kv, px, py, pv, L: (
                [
                    *(each >= 0 for each in (a, b, c)),
                    *(da <= b, db <= kx * c + ky * a + kv * b, dc <= px * c + py * a + pv * b),
                    *(each <= L for each in (kx + px, ky + py, s + kv + pv)),
                ],
                da + db + dc <= L * (a + b + c),
            ),
            "L without the 1 of ‖ẏ₁ − ẏ₂‖",
            0,
        ),
        *gronwall(),
    )
