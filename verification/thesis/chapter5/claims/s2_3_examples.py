"""Chapter 5, section 2.3: the straight fibre (Example 5.2) and the tissue element (Example 5.4)."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most
from verification.thesis.chapter5.instant import (
    Floats,
    Instant,
    System,
    effective_mass,
    force0,
    force1,
    instant,
    jacobians,
    omega,
    phi,
)
from verification.thesis.chapter5.measure import tested

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-4
M = 0.7
X0 = np.array([[0.5], [1.2], [-0.8]])
ONE = np.array([1.4]), np.array([0.6])
PLANE = np.array([1.2, 0.9, 0.3]), np.array([0.5, -0.4, 0.8])
NO_INTERACTION = "no interaction between the particles, as in all examples"


def deformation(y: Floats) -> Floats:
    """F(y) of Example 5.4."""
    return np.array([[y[0], y[2]], [y[2], y[1]]])


def undeformed(X: Floats, y: Floats) -> Floats:
    """F(y)^-1 X of Example 5.4; complex where a derivative is taken by a complex step."""
    return cast("Floats", np.linalg.solve(deformation(y), X.T).T)


def with_springs(g: Callable[[Floats, Floats], Floats]) -> System:
    """A constraint with linear forces F0 = 1 - y, F1 = -0.6 X and no interaction."""
    return System(M, g, lambda y: ((y - 1.0) ** 2).sum() / 2, lambda X: 0.3 * (X**2).sum(-1), lambda r: 0 * r[..., 0])


def fibre() -> Instant:
    """Example 5.2."""
    return instant(with_springs(lambda X, y: X / y), X0, *ONE)


def shifted() -> Instant:
    """Example 5.3, (5.25)."""
    return instant(with_springs(lambda X, y: X - y), X0, *ONE)


def tissue() -> Instant:
    """Example 5.4."""
    system = with_springs(undeformed)
    return instant(system, np.array([[0.5, 0.4], [1.2, -0.3], [-0.8, 0.9]]), *PLANE)


@claim(
    "c5.initial-level",
    "The cross-bridges keep their place in the undeformed tissue.",
    source="(5.19)",
    quote="F(y)⁻¹ X_i = F(yⁱⁿⁱᵗ) X_iⁱⁿⁱᵗ",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "F(y)⁻¹ X_i = F(yⁱⁿⁱᵗ)⁻¹ X_iⁱⁿⁱᵗ",
        Effect.MODEL,
        "(5.20) and (5.32), which have it right",
        why="at t = 0 both sides must agree for all X_iⁱⁿⁱᵗ; (5.32) has the inverse",
        place=3294,
    ),
    tried_on="one tissue element",
)
def _level() -> Evidence:
    """Both sides at t = 0."""
    at = tissue()
    F = deformation(at.y)
    left = np.linalg.solve(F, at.X.T)
    printed, right = (float(np.abs(left - side @ at.X.T).max()) for side in (F, np.linalg.inv(F)))
    return Evidence(
        f"At t = 0 the two sides differ by {printed:.2f}, with F(yⁱⁿⁱᵗ)⁻¹, as in (5.32), by {right:.0e}.",
        printed=(at_most("sides of (5.19) apart at t = 0", printed, 0.0, TOL),),
        corrected=(at_most("the same with F(yⁱⁿⁱᵗ)⁻¹", right, 0.0, TOL),),
    )


@claim(
    "c5.straight-slopes",
    "The derivatives of the constraint of a straight fibre.",
    source="(5.20)",
    quote="g(X_i, y) = X_i/y, ∂_X g = 1/y and ∂_y g = −X_i/y²",
    recorded=Kind.NOT_REFUTED,
    tried_on="one state of three particles",
)
def _straight_slopes() -> Evidence:
    at = fibre()
    gX, gy = jacobians(at.system, at.X, at.y)
    first, second = float(np.abs(gX - 1 / at.y).max()), float(np.abs(gy[..., 0] + at.X / at.y**2).max())
    return Evidence(
        f"The derivatives of X/y differ from 1/y by {first:.0e} and from −X/y² by {second:.0e}.",
        printed=(at_most("|∂_X g − 1/y|", first, 0.0, TOL), at_most("|∂_y g + X/y²|", second, 0.0, TOL)),
    )


@claim(
    "c5.straight-flow",
    "Velocities and curvature of the motion of a straight fibre.",
    source="(5.21)",
    quote="Φ(X_i, y) = X_i/y and Ω(X_i, y) = X_i/y² + −X_i/y² = 0",
    recorded=Kind.NOT_REFUTED,
    tried_on="one state of three particles",
)
def _straight_flow() -> Evidence:
    at = fibre()
    off = float(np.abs(phi(at.system, at.X, at.y)[:, :, 0] - at.X / at.y).max())
    curved = float(np.abs(omega(at.system, at.X, at.y, at.v, at.v)).max())
    return Evidence(
        f"Φ differs from X/y by {off:.0e}, Ω[ẏ, ẏ] from 0 by {curved:.0e}.",
        printed=(at_most("|Φ − X/y|", off, 0.0, TOL), at_most("|Ω[ẏ, ẏ]|", curved, 0.0, TOL)),
    )


@claim(
    "c5.straight-mass",
    "The effective mass of a straight fibre.",
    source="(5.22)",
    quote="m_eff = m I + 1/N Σ_j X_j²/y²",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "m_eff = 1 + m/N Σ_j X_j²/y²",
        Effect.MODEL,
        "the motion of Example 5.2",
        why="(5.13) with Φ = X/y: the mass of the macroscopic component is 1, and m multiplies Φ²",
        place=3310,
    ),
    chosen=NO_INTERACTION,
    tried_on="one state of three particles",
)
def _straight_mass() -> Evidence:
    at = fibre()
    mean = (at.X**2).mean() / at.y[0] ** 2
    force = force0(at.system, at.y) + (at.X / at.y * force1(at.system, at.X)).mean()
    printed, right = (float(np.abs(mass * at.a - force).max()) for mass in (M + mean, 1 + M * mean))
    return Evidence(
        f"With m + ⟨X²⟩/y² = {M + mean:.3f} m_eff ÿ misses F_eff by {printed:.2f}, with 1 + m⟨X²⟩/y² = "
        f"{1 + M * mean:.3f}, as (5.13) gives, by {right:.0e}: m stands in the wrong place.",
        printed=(at_most("|m_eff ÿ − F_eff|, m_eff = m + ⟨X²⟩/y²", printed, 0.0, TOL),),
        corrected=(at_most("|m_eff ÿ − F_eff|, m_eff = 1 + m⟨X²⟩/y²", right, 0.0, TOL),),
    )


@claim(
    "c5.straight-force",
    "The effective force of a straight fibre.",
    source="(5.23)",
    quote="F_eff = F₀(y) + 1/N Σ_j X_j/y F₁(X_j)",
    recorded=Kind.NOT_REFUTED,
    chosen=NO_INTERACTION,
    tried_on="one state of three particles",
)
def _straight_force() -> Evidence:
    at = fibre()
    printed = force0(at.system, at.y) + (at.X / at.y * force1(at.system, at.X)).mean()
    off = float(np.abs(effective_mass(at.system, at.X, at.y) @ at.a - printed).max())
    return Evidence(
        f"It differs from m_eff ÿ of the constrained system by {off:.0e}.",
        printed=(at_most("|m_eff ÿ − F_eff|", off, 0.0, TOL),),
    )


@claim(
    "c5.shear-flow",
    "The velocity of a cross-bridge in a deforming tissue element, in two forms.",
    source="(5.33), (5.34)",
    quote="Ẋ_i = F(ẏ)F(y)⁻¹X_i = F(ẏ)F(yⁱⁿⁱᵗ)⁻¹X_iⁱⁿⁱᵗ",
    recorded=Kind.NOT_REFUTED,
    tried_on="one state of three cross-bridges",
)
def _shear_flow() -> Evidence:
    at = tissue()
    flow = (deformation(at.v) @ np.linalg.solve(deformation(at.y), at.X.T)).T
    reference = at.system.g(at.X, at.y)
    first = float(np.abs(flow - at.U).max())
    second = float(np.abs((deformation(at.v) @ reference.T).T - at.U).max())
    return Evidence(
        f"(5.33) agrees with −(∂_X g)⁻¹∂_y g[ẏ] to {first:.0e}, (5.34) to {second:.0e}.",
        printed=(
            at_most("(5.33) against the constrained system", first, 0.0, TOL),
            at_most("(5.34) against the constrained system", second, 0.0, TOL),
        ),
    )


def shear_rate(x: Floats, f: Floats, A: Floats) -> Floats:
    """(5.36) for the bell f = exp(-|x - 0.3|^2/2) and A = F(y')F(y)^{-1}."""
    return np.asarray(-f * np.trace(A) + ((x - 0.3) * (x @ A.T)).sum(-1) * f)


@claim(
    "c5.shear-transport",
    "How the density of cross-bridges in a tissue element changes.",
    source="(5.35), (5.36)",
    quote="∂_t f = −div_x(f F(ẏ)F(y)⁻¹x) = −f tr(F(ẏ)F(y)⁻¹) − ∂_x f F(ẏ)F(y)⁻¹x",
    recorded=Kind.NOT_REFUTED,
    chosen="f(x, t) on the right side, too, see c5.density-time",
    tried_on="one bell-shaped density",
)
def _shear_transport() -> Evidence:
    y, v = PLANE
    A = deformation(v) @ np.linalg.inv(deformation(y))

    by_flow, by_formula = tested(lambda x: x @ A.T, lambda x, f: shear_rate(x, f, A), 2)
    off = abs(by_flow - by_formula)
    return Evidence(
        f"∫ξf dx of a smooth ξ changes at a rate of {by_flow:.2f}, by (5.36) as by moving the particles, to {off:.0e}.",
        printed=(
            at_most("rates apart", off, 0.0, TOL),
            at_least("size of the rate", abs(by_flow), WRONG),
        ),
    )
