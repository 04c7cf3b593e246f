"""Chapter 5, section 2.1: the particle model and its Lagrangian."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.instant import (
    Floats,
    System,
    force0,
    force1,
    general_instant,
    instant,
    jacobians,
    potential,
    pulls,
    pushed,
    slope,
)

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-2


def odd(r: Floats) -> Floats:
    """A potential that fulfils all that is printed after (5.4)."""
    return np.asarray((r**3).sum(axis=-1))


def _layout(_: Tables) -> Verdict:
    """Whether -(dg/dX)^{-1} dg/dy and (dg/dy)^T lambda are products of matrices that fit."""
    at = general_instant()
    gX, gy = (part[0] for part in jacobians(at.system, at.X, at.y))

    def fits(layout: tuple[int, ...]) -> bool:
        return gX.shape[1] == layout[0] and layout[0] == at.multipliers.shape[1]

    return corrected_if(
        fits(gy.T.shape),
        fits(gy.shape),
        f"with nx = {gX.shape[0]}, ny = {at.y.size} neither (∂_X g)⁻¹∂_y g nor (∂_y g)ᵀλ exists for a ∂_y g of shape "
        f"{gy.T.shape}; they ask for ℝ^(nx×ny), here {gy.shape}, as Φ has it",
    )


def _non_interacting(_: Tables) -> Verdict:
    at = general_instant()
    without = instant(at.system._replace(V=lambda r: 0.0 * r[..., 0]), at.X, at.y, at.v)
    change, same = np.abs(at.a - without.a).max(), np.abs(at.U - without.U).max()
    pull = np.abs(pulls(at.system, at.X)).max()
    return corrected_if(
        pull < TOL,
        pull > WRONG and change > WRONG and same < TOL,
        f"by (5.4) and (5.6a) they pull at each other, here with up to {pull:.2f}, which changes ÿ by {change:.2f} "
        f"(the conclusion too asks to add such forces). Only (5.11b) is without: the velocities change by {same:g}",
    )


def _even(_: Tables) -> Verdict:
    at = general_instant()

    def lack(system: System) -> float:
        found = pulls(system, at.X)
        return float(np.abs(found + found.transpose(1, 0, 2)).max())

    printed, right = lack(at.system._replace(V=odd)), lack(at.system)
    pairs = at.X[:, None] - at.X[None]
    energy = abs(odd(pairs).sum())
    even = abs(at.system.V(pairs) - at.system.V(-pairs)).max()
    return corrected_if(
        printed < TOL,
        right < TOL and even < TOL,
        f"V(r) = Σr³ fulfils all three: then |K(X, X′) + K(X′, X)| is up to {printed:.1f} against (A2a), and the "
        f"energy of all pairs is {energy:.0e} wherever they are. With V(−X) = V(X) the sum is {right:.0e}",
    )


def _pair_force(_: Tables) -> Verdict:
    """The force on each particle by the energy of all pairs, N times its slope."""
    at = general_instant()
    bare = at.system._replace(W0=lambda y: 0.0 * y[0], W1=lambda X: 0.0 * X[..., 0])
    directions = np.eye(at.X.size).reshape(-1, *at.X.shape)
    force = [-len(at.X) * slope(lambda X: potential(bare, X, at.y), at.X, d) for d in directions]
    off = np.abs(np.reshape(force, at.X.shape) - pulls(bare, at.X).mean(axis=0)).max()
    return holds_if(
        off < TOL,
        f"read as K(X_j, X_i) = −∇_{{X_i}} V(X_j − X_i) = ∇V(X_j − X_i), the mean of K over k differs from the slope "
        f"of the energy in (5.8) by {off:.0e}: both particles of a pair count, which cancels the ½ of β",
    )


def _lagrangian(_: Tables) -> Verdict:
    """The derivative by lambda along a motion of a time 1e-4, whose terms of third order are 1e-12."""
    at, h = general_instant(), 1e-4
    X, y = at.X + h * at.U + h**2 / 2 * at.A, at.y + h * at.v + h**2 / 2 * at.a
    level = at.system.g(at.X, at.y)
    printed, right = (float(np.abs(at.system.g(X, y) - c).max()) for c in (0.0, level))
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"on a motion of (5.6) |g(X_j, y)| is {printed:.2f}, but ∂L/∂λ_j = 0 of the printed L asks for g = 0; with "
        f"λ_j·(g(X_j, y) − g(X_jⁱⁿⁱᵗ, yⁱⁿⁱᵗ)), which leaves {right:.0e}, (5.6c) follows",
    )


def _equations(_: Tables) -> Verdict:
    at = general_instant()
    gX, gy = jacobians(at.system, at.X, at.y)
    held = force1(at.system, at.X) + pulls(at.system, at.X).mean(axis=0) - pushed(gX, at.multipliers)
    off = max(
        np.abs(at.system.m * at.A - held).max(),
        np.abs(at.a - force0(at.system, at.y) + pushed(gy, at.multipliers).mean(axis=0)).max(),
    )
    return holds_if(
        off < TOL,
        f"four particles, nx = 2, ny = 3: with accelerations and multipliers from the slopes of L (V even, see above) "
        f"(5.6a) and (5.6b) are fulfilled to {off:.0e}",
    )


def _scaling(_: Tables) -> Verdict:
    """Each particle twice."""
    at = general_instant()
    twice = instant(at.system, np.repeat(at.X, 2, axis=0), at.y, at.v)
    acceleration = np.abs(twice.a - at.a).max()
    multiplier = np.abs(twice.multipliers - np.repeat(at.multipliers, 2, axis=0)).max()
    return holds_if(
        max(acceleration, multiplier) < TOL,
        f"with twice as many particles in the same places ÿ changes by {acceleration:.0e}, λ_i by {multiplier:.0e}",
    )


CLAIMS = (
    Claim("c5.layout", "5, 2, Notation", "∂_y g(X, y) ∈ ℝ^ny × ℝ^nx", _layout),
    Claim("c5.non-interacting", "5, 2.1", "N identical, non-interacting, microscopic particles", _non_interacting),
    Claim("c5.pair-force", "(5.4)", "K(X_j, X_i) = ∇_{X_i} − V(X_j − X_i)", _pair_force),
    Claim("c5.even-potential", "after (5.4)", "V(−X) = −V(X), ∇V(0) = 0 and V(0) = 0", _even),
    Claim("c5.lagrangian", "(5.8)", "L = … − γ Σ_j g(X_j, y) λ_j", _lagrangian),
    Claim(
        "c5.equations",
        "after (5.8)",
        "(5.6a) to (5.6c) consists out of the Euler-Lagrange equations for the choice α = β = γ = 1/N",
        _equations,
    ),
    Claim(
        "c5.scaling",
        "5, 2.1",
        "With the choice α ~ 1/N the influence of the particles remains of order 1; … γ ~ 1/N ensures it of λ_i",
        _scaling,
    ),
)
