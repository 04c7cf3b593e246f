"""Chapter 5, section 2.3: the straight fibre (Example 5.2) and the tissue element (Example 5.4)."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.instant import (
    Floats,
    Instant,
    System,
    effective_mass,
    force0,
    force1,
    instant,
    omega,
    phi,
)
from verification.claims.measure import tested

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-2
M = 0.7
X0 = np.array([[0.5], [1.2], [-0.8]])
ONE = np.array([1.4]), np.array([0.6])
PLANE = np.array([1.2, 0.9, 0.3]), np.array([0.5, -0.4, 0.8])


def deformation(y: Floats) -> Floats:
    """F(y) of Example 5.4."""
    return np.array([[y[0], y[2]], [y[2], y[1]]])


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
    system = with_springs(lambda X, y: np.linalg.solve(deformation(y), X.T).T)
    return instant(system, np.array([[0.5, 0.4], [1.2, -0.3], [-0.8, 0.9]]), *PLANE)


def _level(_: Tables) -> Verdict:
    """Both sides at t = 0."""
    at = tissue()
    F = deformation(at.y)
    left = np.linalg.solve(F, at.X.T)
    printed, right = (float(np.abs(left - side @ at.X.T).max()) for side in (F, np.linalg.inv(F)))
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"at t = 0 the two sides differ by {printed:.2f}, with F(yⁱⁿⁱᵗ)⁻¹, as in (5.32), by {right:.0e}",
    )


def _straight_flow(_: Tables) -> Verdict:
    at = fibre()
    off = np.abs(phi(at.system, at.X, at.y)[:, :, 0] - at.X / at.y).max()
    curved = np.abs(omega(at.system, at.X, at.y, at.v, at.v)).max()
    return holds_if(max(off, curved) < TOL, f"Φ differs from X/y by {off:.0e}, Ω[ẏ, ẏ] from 0 by {curved:.0e}")


def _straight_mass(_: Tables) -> Verdict:
    at = fibre()
    mean = (at.X**2).mean() / at.y[0] ** 2
    force = force0(at.system, at.y) + (at.X / at.y * force1(at.system, at.X)).mean()
    printed, right = (float(np.abs(mass * at.a - force).max()) for mass in (M + mean, 1 + M * mean))
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"with m + ⟨X²⟩/y² = {M + mean:.3f} m_eff ÿ misses F_eff by {printed:.2f}, with 1 + m⟨X²⟩/y² = "
        f"{1 + M * mean:.3f}, as (5.13) gives, by {right:.0e}: m stands in the wrong place",
    )


def _straight_force(_: Tables) -> Verdict:
    at = fibre()
    printed = force0(at.system, at.y) + (at.X / at.y * force1(at.system, at.X)).mean()
    off = np.abs(effective_mass(at.system, at.X, at.y) @ at.a - printed).max()
    return holds_if(off < TOL, f"it differs from m_eff ÿ of the constrained system by {off:.0e}")


def _shear_flow(_: Tables) -> Verdict:
    at = tissue()
    flow = (deformation(at.v) @ np.linalg.solve(deformation(at.y), at.X.T)).T
    reference = at.system.g(at.X, at.y)
    off = max(np.abs(flow - at.U).max(), np.abs((deformation(at.v) @ reference.T).T - at.U).max())
    return holds_if(off < TOL, f"both agree with −(∂_X g)⁻¹∂_y g[ẏ] to {off:.0e}")


def shear_rate(x: Floats, f: Floats, A: Floats) -> Floats:
    """(5.36) for the bell f = exp(-|x - 0.3|^2/2) and A = F(y')F(y)^{-1}."""
    return np.asarray(-f * np.trace(A) + ((x - 0.3) * (x @ A.T)).sum(-1) * f)


def _shear_transport(_: Tables) -> Verdict:
    y, v = PLANE
    A = deformation(v) @ np.linalg.inv(deformation(y))

    by_flow, by_formula = tested(lambda x: x @ A.T, lambda x, f: shear_rate(x, f, A), 2)
    off = abs(by_flow - by_formula)
    return holds_if(
        off < TOL < abs(by_flow), f"∫ξf dx of a smooth ξ changes by (5.36) as by moving the particles, to {off:.0e}"
    )


def _in_class(_: Tables) -> Verdict:
    """Phi and F1 of Example 5.2 on larger and larger sets, and Phi where |X| <= R and y >= y_min."""
    system = with_springs(lambda X, y: X / y)
    moved = partial(phi, system)
    far = [float(np.abs(moved(np.array([[size]]), ONE[0])).max()) for size in (1.0, 1e6)]
    force = [float(np.abs(force1(system, np.array([[size]]))).max()) for size in (1.0, 1e6)]
    radius, least = 2.0, 0.5
    bound = radius / least
    near = float(np.abs(moved(np.linspace(-radius, radius, 41)[:, None], np.array([least]))).max())
    return corrected_if(
        far[1] / far[0] < 1 + TOL,
        far[1] > 1 / WRONG and force[1] > 1 / WRONG and near <= bound + TOL,
        f"g = X/y is not defined at y = 0, against (5.5); from |X| = 1 to 10⁶ |Φ| grows from {far[0]:.2f} to "
        f"{far[1]:.0e}, against (A4b), and linear forces to {force[1]:.0e}, against (A1d). The assumptions hold as "
        f"long as |X| ≤ R, y ≥ y_min (|Φ| ≤ R/y_min = {bound:g}, found {near:g}): for compact starts until y nears 0",
    )


CLAIMS = (
    Claim("c5.in-class", "5, 2.3", "To motivate the class of systems, we give a few examples", _in_class),
    Claim("c5.initial-level", "(5.19)", "F(y)⁻¹ X_i = F(yⁱⁿⁱᵗ) X_iⁱⁿⁱᵗ", _level),
    Claim("c5.straight-flow", "(5.21)", "Φ(X_i, y) = X_i/y and Ω(X_i, y) = X_i/y² + −X_i/y² = 0", _straight_flow),
    Claim("c5.straight-mass", "(5.22)", "m_eff = m I + 1/N Σ_j X_j²/y²", _straight_mass),
    Claim("c5.straight-force", "(5.23)", "F_eff = F₀(y) + 1/N Σ_j X_j/y F₁(X_j)", _straight_force),
    Claim(
        "c5.shear-flow",
        "(5.33), (5.34)",
        "Ẋ_i = F(ẏ)F(y)⁻¹X_i = F(ẏ)F(yⁱⁿⁱᵗ)⁻¹X_iⁱⁿⁱᵗ",
        _shear_flow,
    ),
    Claim(
        "c5.shear-transport",
        "(5.35), (5.36)",
        "∂_t f = −div_x(f F(ẏ)F(y)⁻¹x) = −f tr(F(ẏ)F(y)⁻¹) − ∂_x f F(ẏ)F(y)⁻¹x",
        _shear_transport,
    ),
)
