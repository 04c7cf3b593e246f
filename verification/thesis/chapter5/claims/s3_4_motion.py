"""Chapter 5, sections 2.2, 2.5 and 3.4: what is proved, seen on motions that the solvers of ``meanfield`` find."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from verification.claims import Evidence, Verdict, proved
from verification.formal.algebra import identity
from verification.thesis.chapter5.claims.s2_5_energy import conserved
from verification.thesis.chapter5.claims.s3_4_estimate import estimate
from verification.thesis.chapter5.general import eliminated, multiplier, particle
from verification.thesis.text.quoted import claim


@claim(
    "c5.same-motion",
    "Constrained and reduced equations have the same motions, and the multipliers can be recovered.",
    "before Proposition 5.1",
    Verdict.PROVED,
    chosen="the multipliers by (A.12) with K(X_k, X_i), see c5.derivation-multipliers",
)
def _same_motion() -> Evidence:
    """Both directions: elimination of lambda, and lambda of (A.12) put back."""
    p = particle()
    return proved(
        identity("(5.6a), (5.6b) without λ_j are (5.11a), any nx, ny, N", eliminated, "−Ω for Ω"),
        identity(
            "along (5.11a), (5.11b) λ_i of (A.12) fulfils (5.6a)",
            lambda s: p.m * (p.phi * p.a + s * p.curved) - p.f + p.GT * multiplier(p),
            "−Ω in Ẍ_i",
        ),
    )


@claim(
    "c5.energy-in-time",
    "The energy is the same at all times of a motion.",
    "Lemma 5.5",
    Verdict.PROVED,
    chosen="an even 𝒱, as (A2a) needs it",
)
def _energy() -> Evidence:
    """E' = 0 at each time, see c5.energy, so E is constant where the motion exists."""
    return proved(conserved())


@claim(
    "c5.limit-in-time",
    "More and more particles that stand for a density move y as the mean-field equations do.",
    "section 3.4",
    Verdict.PROVED,
    chosen="an even 𝒱, as (A2a) needs it",
)
def _limit() -> Evidence:
    """The particles are the empirical measure (c5.consistency); its distance from the limit is estimated by (5.60)."""
    return proved(*estimate())
