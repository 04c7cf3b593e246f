"""Chapter 5, section 2.2: the reduced equations, their effective mass and force."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

import numpy as np

from verification.claims import Evidence, Verdict, at_most, proved, put_right
from verification.formal.algebra import identity, library, matrices
from verification.thesis.chapter5.general import eliminated, even, multiplier, particle
from verification.thesis.chapter5.instant import (
    general_instant,
    phi,
    pulls,
)
from verification.thesis.text.quoted import claim

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8


@claim(
    "c5.reduced-model",
    "The equation of the macroscopic component once the multipliers are eliminated.",
    "section 1",
    Verdict.PROVED,
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
            "= 0, any "
            "nx, ny, N",
            residual,
            "−K_eff for K_eff",
        )
    )


@claim(
    "c5.velocity",
    "The constraints turn the velocity of the macroscopic component into that of each particle.",
    "(5.9)",
    Verdict.PROVED,
)
def _velocity() -> Evidence:
    """(5.9) in both directions."""
    p, (U,) = particle(), matrices("U,")
    return proved(
        identity(
            "dg/dt = ∂_X g U + ∂_y g ẏ = ∂_X g (U − Φ[ẏ]), which vanishes if and only if U = Φ[ẏ], for any nx, ny",
            lambda s: p.G * U + p.B * p.v - p.G * (U - s * p.phi * p.v),
            "−Φ for Φ",
        )
    )


@claim(
    "c5.acceleration",
    "The acceleration of a particle by that of the macroscopic component.",
    "(5.10)",
    Verdict.CORRECTED,
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
    "Effective mass and force of the macroscopic component.",
    "(5.11a), (5.13), (5.14)",
    Verdict.PROVED,
)
def _effective() -> Evidence:
    return proved(
        identity("(5.6a), (5.6b) without λ_j are (5.11a) with (5.13), (5.14), any nx, ny, N", eliminated, "−Ω for Ω")
    )


@claim(
    "c5.means",
    "Effective mass and force are means over single particles, and over pairs for the interaction.",
    "(5.15), (5.16)",
    Verdict.PROVED,
)
def _means() -> Evidence:
    """K(X, X) for an even potential, in one coordinate; the terms of one particle and one other."""
    sp = library()
    (x, z, q), V, p = sp.symbols("x z q"), even("w"), particle()
    n, (own, pull) = sp.Symbol("N", positive=True), matrices("F1 K")
    return proved(
        identity(
            "K(X, X) = 0 for every even 𝒱", lambda s: V(x - z, s * q - q).diff(z).subs(z, x), "other coordinates apart"
        ),
        identity(
            "Φᵀ(F₁ + 1/N Σ_k K) is the sum of the single and the pair terms of (5.16), for any nx, ny",
            lambda s: (
                p.phiT * (own + pull / n - p.m * p.curved) - p.phiT * (own - p.m * p.curved) - s * p.phiT * pull / n
            ),
            "−K for K",
        ),
    )


@claim(
    "c5.effective-interaction",
    "The interaction of particles acts on the macroscopic component only through the change of Φ.",
    "after (5.17)",
    Verdict.PROVED,
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


@claim(
    "c5.kernel-order",
    "The effective interaction, by its two positions.",
    "proof of Lemma 5.6",
    Verdict.CORRECTED,
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _order_of_arguments() -> Evidence:
    """K_eff of (5.17) at (X_k, X_j) and that of Lemma 5.6 at the same arguments."""
    at = general_instant()
    moved, pull = phi(at.system, at.X, at.y), pulls(at.system, at.X)
    first = np.einsum("jab,kja->kjb", moved, pull)
    lemma = np.einsum("kab,jka->kjb", moved, pull)
    swapped = float(np.abs(first - lemma.transpose(1, 0, 2)).max())
    apart, sums = float(np.abs(first - lemma).max()), float(np.abs((first - lemma).sum(axis=(0, 1))).max())
    return Evidence(
        f"At the same arguments it differs from (5.17) by up to {apart:.2f}, with the arguments of K_eff swapped by "
        f"{swapped:.0e}. The double sums agree ({sums:.0e}), so nothing else changes.",
        printed=(at_most("K_eff of Lemma 5.6 against (5.17)", apart, 0.0, TOL),),
        corrected=(
            at_most("K_eff of Lemma 5.6 with swapped arguments against (5.17)", swapped, 0.0, TOL),
            at_most("their double sums apart", sums, 0.0, TOL),
        ),
    )
