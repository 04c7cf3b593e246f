"""Chapter 5, section 2.1: the particle model and its Lagrangian."""

from __future__ import annotations

from typing import Any

from verification.claims.formal.algebra import library
from verification.claims.formal.stated import identity
from verification.thesis.chapter5 import general as of

sp = library()
t, n, m, level, p, q = sp.symbols("t N m lambda p q")
x, z, y = (sp.Function(name)(t) for name in "xzy")
even = of.even("w")


W0, W1, g = (sp.Function(name) for name in ("W0", "W1", "g"))
LAGRANGIAN = y.diff(t) ** 2 / 2 - W0(y, q) - (even(z - x, p) + even(x - z, -p)) / (2 * n**2)
LAGRANGIAN += (m * x.diff(t) ** 2 / 2 - W1(x, p) - level * g(x, p, y, q)) / n


def accelerations(level: Any) -> list[Any]:
    """Return what (5.6a), (5.6b) and the Euler-Lagrange equations differ by, for one coordinate x of X_i and one of y.

    The other coordinates are p and q; sums over particles and components are linear.
    """
    of_x, of_y = (LAGRANGIAN.diff(of.diff(t)).diff(t) - LAGRANGIAN.diff(of) for of in (x, y))
    first = m * x.diff(t, 2) + W1(x, p).diff(x) + even(z - x, p).diff(x) / n + level * g(x, p, y, q).diff(x)
    second = y.diff(t, 2) + W0(y, q).diff(y) + level * g(x, p, y, q).diff(y) / n
    return [n * of_x - first, of_y - second]


_equations = identity(
    "c5.equations",
    "(5.6a), (5.6b)",
    "mẌ_i = F₁(X_i) + 1/N Σ_k K(X_k, X_i) − (∂_X g)ᵀλ_i, ÿ = F₀(y) − 1/N Σ_j (∂_y g)ᵀλ_j … Euler-Lagrange equations "
    "for the choice α = β = γ = 1/N",
    "The equations for the accelerations are those of the Lagrangian (5.8) with α = β = γ = 1/N, for every even 𝒱.",
    right=accelerations(level),
    wrong=accelerations(-level),
    chosen="an even 𝒱, as (A2a) needs it; for (5.6c) see c5.lagrangian",
)
