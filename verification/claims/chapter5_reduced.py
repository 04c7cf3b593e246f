"""Chapter 5, section 2.2: the reduced equations, their effective mass and force."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.instant import (
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
WRONG = 1e-2


def _velocity(_: Tables) -> Verdict:
    at = general_instant()

    def rate(U: Floats) -> Floats:
        gX, gy = jacobians(at.system, at.X, at.y)
        return np.abs((gX @ U[..., None])[..., 0] + gy @ at.v)

    U = phi(at.system, at.X, at.y) @ at.v
    right, other = rate(U).max(), rate(U + 0.1).min()
    return holds_if(
        right < TOL < other, f"dg/dt is {right:.0e} for Ẋ_i = Φ_i[ẏ], and at least {other:.2f} if each is off by 0.1"
    )


def _acceleration(_: Tables) -> Verdict:
    at = general_instant()
    curved = omega(at.system, at.X, at.y, at.v, at.v)
    printed, right = (float(np.abs(at.A - phi(at.system, at.X, at.y) @ rate - curved).max()) for rate in (at.v, at.a))
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"Φ_i[ẏ] + Ω_i[ẏ, ẏ] misses Ẍ_i by up to {printed:.2f}, Φ_i[ÿ] + Ω_i[ẏ, ẏ], as in (A.10), by {right:.0e}",
    )


def _effective(_: Tables) -> Verdict:
    at = general_instant()
    off = np.abs(effective_mass(at.system, at.X, at.y) @ at.a - effective_force(at.system, at.X, at.y, at.v)).max()
    return holds_if(
        off < TOL, f"ÿ of the constrained system fulfils (5.11a) with (5.13) and (5.14) to {off:.0e} (nx = 2, ny = 3)"
    )


def _means(_: Tables) -> Verdict:
    at = general_instant()
    alone = [x[None] for x in at.X]
    pairs = pushed(phi(at.system, at.X, at.y), pulls(at.system, at.X).mean(axis=0)).mean(axis=0)
    mass = np.mean([effective_mass(at.system, x, at.y) for x in alone], axis=0)
    force = np.mean([effective_force(at.system, x, at.y, at.v) for x in alone], axis=0) + pairs
    off = max(
        np.abs(mass - effective_mass(at.system, at.X, at.y)).max(),
        np.abs(force - effective_force(at.system, at.X, at.y, at.v)).max(),
    )
    own = np.abs(kernel(at.system, at.X, at.X)).max()
    return holds_if(off < TOL and own < TOL, f"both sides agree to {off:.0e}, K(X, X) = {own:g}")


def _interaction(_: Tables) -> Verdict:
    """K_eff for Phi of the general system and for a constant one."""
    at = general_instant()

    def pairs(moved: Floats) -> Floats:
        return np.einsum("jab,kja->kjb", moved, pulls(at.system, at.X))

    found, constant = pairs(phi(at.system, at.X, at.y)), pairs(np.broadcast_to(np.ones((2, 3)), (len(at.X), 2, 3)))
    lack, total = np.abs(found + found.transpose(1, 0, 2)).max(), np.abs(found.sum(axis=(0, 1))).max()
    none = np.abs(constant.sum(axis=(0, 1))).max()
    return holds_if(
        lack > WRONG and total > WRONG and none < TOL,
        f"in general |K_eff(X_k, X_j) + K_eff(X_j, X_k)| is up to {lack:.2f} and the double sum {total:.2f}; for a "
        f"constant Φ, as in Example 5.3, it vanishes ({none:.0e}): there the interaction cancels",
    )


def _order_of_arguments(_: Tables) -> Verdict:
    """K_eff of (5.17) at (X_k, X_j) and that of Lemma 5.6 at the same arguments."""
    at = general_instant()
    moved, pull = phi(at.system, at.X, at.y), pulls(at.system, at.X)
    first = np.einsum("jab,kja->kjb", moved, pull)
    lemma = np.einsum("kab,jka->kjb", moved, pull)
    apart, sums = np.abs(first - lemma).max(), np.abs((first - lemma).sum(axis=(0, 1))).max()
    return corrected_if(
        apart < TOL,
        sums < TOL,
        f"at the same arguments it differs from (5.17) by up to {apart:.2f}: (5.17) needs K_eff(Z, X, y) on the left. "
        f"The double sums agree ({sums:.0e}), so nothing else changes",
    )


CLAIMS = (
    Claim("c5.velocity", "(5.9)", "g = const. ⇔ dg/dt = 0 ⇔ Ẋ_i = Φ_i[ẏ], Φ = −(∂_X g)⁻¹ ∂_y g", _velocity),
    Claim("c5.acceleration", "(5.10)", "Ẍ_i = Φ_i[ẏ] + Ω_i[ẏ, ẏ]", _acceleration),
    Claim(
        "c5.effective",
        "(5.11a), (5.13), (5.14)",
        "m_eff = I + m/N Σ_j Φ_jᵀΦ_j, F_eff = F₀ + 1/N Σ_j Φ_jᵀ(F₁(X_j) + 1/N Σ_k K(X_k, X_j) − mΩ_j[ẏ, ẏ])",
        _effective,
    ),
    Claim("c5.means", "(5.15), (5.16)", "The last equation holds because K(X, X) = 0", _means),
    Claim(
        "c5.effective-interaction",
        "after (5.17)",
        "K_eff might not be anti-symmetric. When K_eff is anti-symmetric, the double sum in (5.16) would vanish",
        _interaction,
    ),
    Claim("c5.kernel-order", "Lemma 5.6", "K_eff(X, Z, y) = Φ(X, y)ᵀ K(Z, X)", _order_of_arguments),
)
