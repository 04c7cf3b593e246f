"""Chapter 5, section 2.2: the reduced equations, their effective mass and force."""

from __future__ import annotations

from typing import Any

from verification.claims import Correction, Effect, Evidence, Verdict, claim, proved, put_right
from verification.formal.algebra import identity, library, matrices
from verification.thesis.chapter5.general import even, multiplier, particle
from verification.thesis.chapter5.lemmas import reduced


@claim(
    "c5.reduced-model",
    ("Eliminating the multipliers leaves one equation for the macroscopic component, with means over particles."),
    source="section 1",
    quote="(1/N Σ_j m_eff⁽¹⁾(X_j, y)) ÿ = 1/N Σ_j (F_eff⁽¹⁾(X_j, y, ẏ) + 1/N Σ_k K_eff(X_k, X_j))",
    recorded=Verdict.PROVED,
    rests_on=("c5.equations", "c5.acceleration"),
)
def _reduced() -> Evidence:
    """The terms of one particle, with the forces of the others as a sum of its own."""
    p, (own, others) = particle(), matrices("F1 K")

    def residual(s: Any) -> Any:
        single = p.a + p.m * p.phiT * p.phi * p.a - p.phiT * (own - p.m * p.curved) - s * p.phiT * others
        return (single - p.a - p.BT * multiplier(p)).subs(p.f, own + others)

    return proved(
        identity(
            "eliminating λ_j from (5.6a), (5.6b) gives the mean of m_eff⁽¹⁾ÿ − F_eff⁽¹⁾ − 1/N Σ_k K_eff(X_k, X_j) "
            "= 0, any nx, ny, N",
            residual,
            "−K_eff for K_eff",
        )
    )


@claim(
    "c5.velocity",
    "The constraint is kept exactly where each particle moves with Φ_i[ẏ].",
    source="(5.9)",
    quote="g = const. ⇔ dg/dt = 0 ⇔ Ẋ_i = Φ_i[ẏ], Φ = −(∂_X g)⁻¹ ∂_y g",
    recorded=Verdict.PROVED,
)
def _velocity() -> Evidence:
    """Both directions, the derivative of g being taken along any motion; then with matrices of any size for those."""
    sp, p, (U,) = library(), particle(), matrices("U,")
    t = sp.Symbol("t")
    X, y = (sp.Matrix([sp.Function(f"{name}{k}")(t) for k in range(2)]) for name in "Xy")
    g = sp.Matrix([sp.Function(f"g{k}")(*X, *y) for k in range(2)])
    inverse = g.jacobian(X).inv()
    phi = -inverse * g.jacobian(y)
    return proved(
        identity(
            "(∂_X g)⁻¹ dg/dt = Ẋ − Φ[ẏ] along all motions X(t), y(t) and for all g with nx = ny = 2",
            lambda s: inverse * g.diff(t) - X.diff(t) + s * phi * y.diff(t),
            "Ẋ + Φ[ẏ]",
        ),
        identity(
            "∂_X g U + ∂_y g ẏ = ∂_X g (U − Φ[ẏ]), which vanishes if and only if U = Φ[ẏ], for any nx, ny",
            lambda s: p.G * U + p.B * p.v - p.G * (U - s * p.phi * p.v),
            "−Φ for Φ",
        ),
    )


@claim(
    "c5.acceleration",
    "The acceleration of a particle is Φ_i[ẏ] + Ω_i[ẏ, ẏ].",
    source="(5.10)",
    quote="Ẍ_i = Φ_i[ẏ] + Ω_i[ẏ, ẏ]",
    correction=Correction(
        "Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
        Effect.MODEL,
        "the elimination of Ẍ_i; (5.14), (5.51) and (A.10) are right",
        why="the derivative of Φ_i[ẏ] in time is Φ_i[ÿ] + Ω_i[ẏ, ẏ]; (A.10) has it",
        place=3217,
    ),
    rests_on=("c5.velocity",),
)
def _acceleration() -> Evidence:
    p = particle()
    return put_right(
        identity(
            "d²g/dt² = 0 for Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ], any nx, ny",
            lambda s: p.G * (p.phi * (p.a if s == 1 else p.v) + p.curved) + p.B * p.a + (p.dG * p.phi + p.dB) * p.v,
            "for Ẍ_i = Φ_i[ẏ] + Ω_i[ẏ, ẏ]",
        )
    )


@claim(
    "c5.effective",
    "The macroscopic component moves by Newton's law with an effective mass and an effective force.",
    source="(5.11a), (5.13), (5.14)",
    quote="m_eff = I + m/N Σ_j Φ_jᵀΦ_j, F_eff = F₀ + 1/N Σ_j Φ_jᵀ(F₁(X_j) + 1/N Σ_k K(X_k, X_j) − mΩ_j[ẏ, ẏ])",
    recorded=Verdict.PROVED,
    rests_on=("c5.equations", "c5.acceleration"),
)
def _effective() -> Evidence:
    return proved(reduced())


@claim(
    "c5.means",
    "The effective force is a mean over single particles and over pairs, because K(X, X) = 0.",
    source="(5.15), (5.16)",
    quote="The last equation holds because K(X, X) = 0",
    recorded=Verdict.PROVED,
    rests_on=("c5.effective", "c5.even-potential"),
)
def _means() -> Evidence:
    """(5.16) with F_eff^(1) by (5.14) for N = 1, which has K(X, X); then K(X, X) of an even potential."""
    sp = library()
    (x, z, q), V, p = sp.symbols("x z q"), even("w"), particle()
    n, (own, pull, itself) = sp.Symbol("N", positive=True), matrices("F1 K K0")

    def residual(s: Any) -> Any:
        all_of_them = p.phiT * (own + pull / n - p.m * p.curved)
        single, pairs = p.phiT * (own + itself - p.m * p.curved), p.phiT * pull / n
        return all_of_them - single - pairs + s * p.phiT * itself

    return proved(
        identity(
            "the left side of (5.16) less the right one is −1/N Σ_j Φ_jᵀK(X_j, X_j), for any nx, ny, N",
            residual,
            "0, whatever K(X, X) is",
            0,
        ),
        identity(
            "K(X, X) = 0 for every even 𝒱", lambda s: V(x - z, s * q - q).diff(z).subs(z, x), "other coordinates apart"
        ),
    )


@claim(
    "c5.effective-interaction",
    "The interaction of particles acts on the macroscopic component only through the change of Φ.",
    source="after (5.17)",
    quote=("K_eff might not be anti-symmetric. When K_eff is anti-symmetric, the double sum in (5.16) would vanish"),
    recorded=Verdict.PROVED,
    rests_on=("c5.means",),
)
def _interaction() -> Evidence:
    """K_eff(X_k, X_j) + K_eff(X_j, X_k) with K(X_j, X_k) = -K(X_k, X_j)."""
    pT, other, pull = matrices("PT QT K")
    return proved(
        identity(
            "for one and the same Φ K_eff(X_k, X_j) + K_eff(X_j, X_k) = 0 and the double sum vanishes",
            lambda s: pT * pull - (pT if s == 1 else other) * pull,
            "K_eff is antisymmetric for Φ that differ",
        )
    )
