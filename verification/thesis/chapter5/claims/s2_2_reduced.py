"""Chapter 5, section 2.2: the reduced equations, their effective mass and force."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most
from verification.thesis.chapter5.instant import (
    Floats,
    effective_force,
    effective_mass,
    general_instant,
    jacobians,
    kernel,
    omega,
    phi,
    pulls,
    pushed,
)

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-4


@claim(
    "c5.reduced-model",
    "The equation of the macroscopic component once the multipliers are eliminated.",
    source="section 1",
    quote="(1/N Σ_j m_eff⁽¹⁾(X_j, y)) ÿ = 1/N Σ_j (F_eff⁽¹⁾(X_j, y, ẏ) + 1/N Σ_k K_eff(X_k, X_j))",
    recorded=Kind.NOT_REFUTED,
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _reduced() -> Evidence:
    """The sums over single particles and pairs, with the acceleration of the constrained system."""
    at = general_instant()
    alone = [x[None] for x in at.X]
    mass = np.mean([effective_mass(at.system, x, at.y) for x in alone], axis=0)
    each = [effective_force(at.system, x, at.y, at.v) for x in alone]
    moved = phi(at.system, at.X, at.y)
    pairs = [pushed(moved, pull).mean(axis=0) for pull in pulls(at.system, at.X)]
    off = float(np.abs(mass @ at.a - np.mean(each, axis=0) - np.mean(pairs, axis=0)).max())
    interaction = float(np.abs(np.mean(pairs, axis=0)).max())
    return Evidence(
        f"Four particles, nx = 2, ny = 3: ÿ of the constrained system fulfils it to {off:.0e}; the sum over pairs is "
        f"{interaction:.2f} of it.",
        printed=(
            at_most("residual of the reduced equation", off, 0.0, TOL),
            at_least("sum over pairs", interaction, WRONG),
        ),
    )


@claim(
    "c5.velocity",
    "The constraints turn the velocity of the macroscopic component into that of each particle.",
    source="(5.9)",
    quote="g = const. ⇔ dg/dt = 0 ⇔ Ẋ_i = Φ_i[ẏ], Φ = −(∂_X g)⁻¹ ∂_y g",
    recorded=Kind.NOT_REFUTED,
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _velocity() -> Evidence:
    at = general_instant()

    def rate(U: Floats) -> Floats:
        gX, gy = jacobians(at.system, at.X, at.y)
        return np.abs((gX @ U[..., None])[..., 0] + gy @ at.v)

    U = phi(at.system, at.X, at.y) @ at.v
    right, other = float(rate(U).max()), float(rate(U + 0.1).min())
    return Evidence(
        f"dg/dt is {right:.0e} for Ẋ_i = Φ_i[ẏ], and at least {other:.2f} if each is off by 0.1.",
        printed=(
            at_most("|dg/dt| for Ẋ_i = Φ_i[ẏ]", right, 0.0, TOL),
            at_least("|dg/dt| for Ẋ_i off by 0.1", other, WRONG),
        ),
    )


@claim(
    "c5.acceleration",
    "The acceleration of a particle by that of the macroscopic component.",
    source="(5.10)",
    quote="Ẍ_i = Φ_i[ẏ] + Ω_i[ẏ, ẏ]",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
        Effect.MODEL,
        "the elimination of Ẍ_i; (5.14), (5.51) and (A.10) are right",
        why="the derivative of Φ_i[ẏ] in time is Φ_i[ÿ] + Ω_i[ẏ, ẏ]; (A.10) has it",
        place=3217,
    ),
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _acceleration() -> Evidence:
    at = general_instant()
    curved = omega(at.system, at.X, at.y, at.v, at.v)
    printed, right = (float(np.abs(at.A - phi(at.system, at.X, at.y) @ rate - curved).max()) for rate in (at.v, at.a))
    return Evidence(
        f"Φ_i[ẏ] + Ω_i[ẏ, ẏ] misses Ẍ_i by up to {printed:.2f}, Φ_i[ÿ] + Ω_i[ẏ, ẏ], as in (A.10), by {right:.0e}.",
        printed=(at_most("|Ẍ_i − Φ_i[ẏ] − Ω_i[ẏ, ẏ]|", printed, 0.0, TOL),),
        corrected=(at_most("|Ẍ_i − Φ_i[ÿ] − Ω_i[ẏ, ẏ]|", right, 0.0, TOL),),
    )


@claim(
    "c5.effective",
    "Effective mass and force of the macroscopic component.",
    source="(5.11a), (5.13), (5.14)",
    quote="m_eff = I + m/N Σ_j Φ_jᵀΦ_j, F_eff = F₀ + 1/N Σ_j Φ_jᵀ(F₁(X_j) + 1/N Σ_k K(X_k, X_j) − mΩ_j[ẏ, ẏ])",
    recorded=Kind.NOT_REFUTED,
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _effective() -> Evidence:
    at = general_instant()
    off = np.abs(effective_mass(at.system, at.X, at.y) @ at.a - effective_force(at.system, at.X, at.y, at.v)).max()
    return Evidence(
        f"ÿ of the constrained system fulfils (5.11a) with (5.13) and (5.14) to {off:.0e} (nx = 2, ny = 3).",
        printed=(at_most("|m_eff ÿ − F_eff|", float(off), 0.0, TOL),),
    )


@claim(
    "c5.means",
    "Effective mass and force are means over single particles, and over pairs for the interaction.",
    source="(5.15), (5.16)",
    quote="The last equation holds because K(X, X) = 0",
    recorded=Kind.NOT_REFUTED,
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _means() -> Evidence:
    at = general_instant()
    alone = [x[None] for x in at.X]
    pairs = pushed(phi(at.system, at.X, at.y), pulls(at.system, at.X).mean(axis=0)).mean(axis=0)
    mass = np.mean([effective_mass(at.system, x, at.y) for x in alone], axis=0)
    force = np.mean([effective_force(at.system, x, at.y, at.v) for x in alone], axis=0) + pairs
    masses = float(np.abs(mass - effective_mass(at.system, at.X, at.y)).max())
    forces = float(np.abs(force - effective_force(at.system, at.X, at.y, at.v)).max())
    own = float(np.abs(kernel(at.system, at.X, at.X)).max())
    return Evidence(
        f"Both sides of (5.15) agree to {masses:.0e}, of (5.16) to {forces:.0e}; K(X, X) = {own:g}.",
        printed=(
            at_most("sides of (5.15) apart", masses, 0.0, TOL),
            at_most("sides of (5.16) apart", forces, 0.0, TOL),
            at_most("|K(X, X)|", own, 0.0, TOL),
        ),
    )


@claim(
    "c5.effective-interaction",
    "The interaction of particles acts on the macroscopic component only through the change of Φ.",
    source="after (5.17)",
    quote="K_eff might not be anti-symmetric. When K_eff is anti-symmetric, the double sum in (5.16) would vanish",
    recorded=Kind.NOT_REFUTED,
    tried_on="four particles, one Φ and a constant one",
)
def _interaction() -> Evidence:
    """K_eff for Phi of the general system and for a constant one."""
    at = general_instant()

    def pairs(moved: Floats) -> Floats:
        return np.asarray(np.einsum("jab,kja->kjb", moved, pulls(at.system, at.X)))

    found, constant = pairs(phi(at.system, at.X, at.y)), pairs(np.broadcast_to(np.ones((2, 3)), (len(at.X), 2, 3)))
    lack, total = float(np.abs(found + found.transpose(1, 0, 2)).max()), float(np.abs(found.sum(axis=(0, 1))).max())
    none = float(np.abs(constant.sum(axis=(0, 1))).max())
    return Evidence(
        f"In general |K_eff(X_k, X_j) + K_eff(X_j, X_k)| is up to {lack:.2f} and the double sum {total:.2f}; for a "
        f"constant Φ, as in Example 5.3, it vanishes ({none:.0e}): there the interaction cancels.",
        printed=(
            at_least("|K_eff(X_k, X_j) + K_eff(X_j, X_k)|", lack, WRONG),
            at_least("double sum", total, WRONG),
            at_most("double sum for a constant Φ", none, 0.0, TOL),
        ),
    )


@claim(
    "c5.kernel-order",
    "The effective interaction, by its two positions.",
    source="proof of Lemma 5.6",
    quote="K_eff(X, Z, y) = Φ(X, y)ᵀ K(Z, X)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "K_eff(Z, X, y) = Φ(X, y)ᵀ K(Z, X), as in (5.17)",
        Effect.NOTATION,
        "nothing: only double sums are used",
        why=(
            "in (5.17) the second argument of K_eff is the particle at which Φ is taken, in the lemma it is the first"
        ),
        place=3492,
    ),
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
