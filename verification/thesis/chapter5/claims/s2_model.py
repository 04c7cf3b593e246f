"""Chapter 5, sections 2.1 to 2.3: the Lagrangian and its factors, the reduced equations, the examples."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter5 import lemmas as of
from verification.thesis.chapter5.instant import TOL, Floats, force1, general_instant, kernel, omega, with_springs
from verification.thesis.chapter5.instant import phi as map_of
from verification.thesis.chapter5.lemmas import BT, GT, REDUCED, B, G, a, curved, dB, dG, f, m, multiplier, phi, phiT, v

sp = library()
t, n, mass, level, p, q = sp.symbols("t N m lambda p q")
x, z, y = (sp.Function(name)(t) for name in "xzy")
even = of.even("w")


W0, W1, g = (sp.Function(name) for name in ("W0", "W1", "g"))
LAGRANGIAN = y.diff(t) ** 2 / 2 - W0(y, q) - (even(z - x, p) + even(x - z, -p)) / (2 * n**2)
LAGRANGIAN += (mass * x.diff(t) ** 2 / 2 - W1(x, p) - level * g(x, p, y, q)) / n


def accelerations(level: Any) -> list[Any]:
    """Return what (5.6a), (5.6b) and the Euler-Lagrange equations differ by, for one coordinate x of X_i and one of y.

    The other coordinates are p and q; sums over particles and components are linear.
    """
    of_x, of_y = (LAGRANGIAN.diff(of.diff(t)).diff(t) - LAGRANGIAN.diff(of) for of in (x, y))
    first = mass * x.diff(t, 2) + W1(x, p).diff(x) + even(z - x, p).diff(x) / n + level * g(x, p, y, q).diff(x)
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


# The limit is an integral, which sums of 16 terms find to less than this.
SUMMED = 0.01


@claim(
    "c5.interaction-scaling",
    "With β = 1/N the interaction keeps its share in the force on a particle as N grows.",
    source="section 2.1",
    quote="The choice β ~ 1/N … keeps the relative influence of the interaction forces constant",
    rests_on=("c5.equations",),
    tried_on="16 and 1024 particles spread evenly over |X| ≤ 1, 𝒱(r) = √(1 + r²), W₁ = √(1 + X²), the force at X = 2",
)
def _beta() -> Evidence:
    def root(r: Floats) -> Floats:
        return np.asarray(np.sqrt(1 + (r**2).sum(axis=-1)))

    system, here = general_instant().system._replace(W1=root, V=root), np.array([[2.0]])
    own = force1(system, here).item()

    def share(count: int) -> float:
        X = (2 * np.arange(count)[:, None] + 1) / count - 1
        return float(kernel(system, X, np.broadcast_to(here, X.shape)).sum()) / count / own

    few, many = share(16), share(1024)
    return Evidence(
        printed=(
            equal("interaction over own force at N = 1024 over the same at N = 16", many / few, 1, SUMMED),
            at_least("interaction over own force at N = 1024", many, SUMMED),
        )
    )


# c particles at each of N places: alpha m A = alpha f - gamma G^T lambda, and y feels gamma sum B^T lambda.
c, count, share, gamma = library().symbols("c N alpha gamma", positive=True)

_alpha = argument(
    "c5.scaling",
    "section 2.1",
    "With the choice α ~ 1/N the influence of the particles on the macroscopic component remains of order 1 in the "
    "limit … to ensure that also λ₁, …, λ_N are of order 1. Therefore, we pick γ ~ 1/N",
    "With 1/N before the particles' part of the Lagrangian their influence and multipliers stay bounded.",
    vanishes(
        (1 / (c * count)) / (1 / (c * count)) * multiplier - (1 / count) / (1 / count) * multiplier,
        1 / (c * count) * multiplier - 1 / count * multiplier,
        "with α = γ = 1/N the multipliers λ_i = (α/γ)(∂_X g)⁻ᵀ(f_i − mẌ_i) are the same for cN particles",
        "γ = 1",
    ),
    vanishes(
        (c * count / (c * count) - count / count) * BT * multiplier,
        (c * count - count) * BT * multiplier,
        "and so is what y feels of them, α Σ (∂_y g)ᵀ(∂_X g)⁻ᵀ(f_i − mẌ_i)",
        "α = 1",
    ),
    vanishes(
        [(gamma * part * share / gamma * multiplier).diff(gamma) for part in (GT, BT)],
        (gamma * GT * share * gamma * multiplier).diff(gamma),
        "the constraint forces γ(∂_X g)ᵀλ_i, γ(∂_y g)ᵀλ_i do not depend on γ",
        "λ_i ~ γ",
    ),
    also=("c5.total-mass", "c5.gamma"),
    rests_on=("c5.equations", "c5.acceleration"),
)


# The force of a particle alone, that of the others, K(X, X), and Phi^T of another particle.
own, others = matrices("F1 K")

SINGLE = a + m * phiT * phi * a - phiT * (own - m * curved) - a - (BT * multiplier).subs(f, own + others)

_reduced = argument(
    "c5.reduced-model",
    "section 1; (5.11a), (5.13), (5.14)",
    "(1/N Σ_j m_eff⁽¹⁾(X_j, y)) ÿ = 1/N Σ_j (F_eff⁽¹⁾(X_j, y, ẏ) + 1/N Σ_k K_eff(X_k, X_j))",
    "Eliminating the multipliers leaves one equation for the macroscopic component, with means over particles.",
    REDUCED,
    vanishes(
        SINGLE - phiT * others,
        SINGLE + phiT * others,
        "which is the mean of m_eff⁽¹⁾ÿ − F_eff⁽¹⁾ − 1/N Σ_k K_eff(X_k, X_j) = 0",
        "−K_eff for K_eff",
    ),
    also=("c5.effective",),
    rests_on=("c5.equations", "c5.acceleration"),
)

# d^2 g/dt^2.
BENT = B * a + (dG * phi + dB) * v

_acceleration = identity(
    "c5.acceleration",
    "(5.10); appendix 2, (A.8) to (A.10)",
    "Ẍ_i = Φ_i[ẏ] + Ω_i[ẏ, ẏ]",
    "The acceleration of a particle is Φ_i[ẏ] + Ω_i[ẏ, ẏ].",
    right=G * (phi * a + curved) + BENT,
    wrong=G * (phi * v + curved) + BENT,
    also=("c5.derivation-rate",),
    correction=Correction(
        "Ẍ_i = Φ_i[ÿ] + Ω_i[ẏ, ẏ]",
        Effect.MODEL,
        "the elimination of Ẍ_i; (5.14), (5.51) and (A.10) are right",
        why="the derivative of Φ_i[ẏ] in time is Φ_i[ÿ] + Ω_i[ẏ, ẏ]; (A.10) has it",
        place=3217,
    ),
    rests_on=("c5.derivation-constraint",),
)


# y and its velocity.
ONE = np.array([1.4]), np.array([0.6])
SEED = 19


@claim(
    "c5.in-class",
    "The straight fibre is an instance of the systems that the theorems are about.",
    source="section 2.3",
    quote="To motivate the class of systems, we give a few examples",
    correction=Correction(
        (
            "Examples 5.2 and 5.4 are of the class only where X and the inverse of F(y) are bounded: in Example 5.2 "
            "where |X| ≤ R and y ≥ y_min > 0"
        ),
        Effect.CONCLUSION,
        "Theorems 5.9, 5.12 and 5.16 do not apply to Examples 5.2 and 5.4 as they stand",
        why="(5.5) and (A3) to (A5) are asked for all X and y, but X/y has no value at y = 0, and Φ = X/y has no bound",
        place=3284,
    ),
    tried_on="Example 5.2, |X| ≤ 2, y ≥ 0.5",
)
def _in_class() -> Evidence:
    """Bounds and difference quotients of Phi of Example 5.2 where |X| <= R, y >= y_min, and its size beyond."""
    system, rng = with_springs(lambda X, y: X / y), np.random.default_rng(SEED)
    moved = partial(map_of, system)
    radius, least, size, steep = 2.0, 0.5, 0.0, 0.0
    for far in np.repeat([1e-3, 1.0], 100):
        X, y = radius * np.clip(2 * rng.normal(size=(2, 1, 1)), -1, 1), least + far * rng.exponential(1.0, (2, 1))
        one, other = moved(X[0], y[0]), moved(X[1], y[1])
        size = max(size, float(np.abs(one).max()), float(np.abs(other).max()))
        apart = float(np.abs(X[0] - X[1]).sum() + np.abs(y[0] - y[1]).sum())
        steep = max(steep, float(np.abs(one - other).max()) / apart)
    bent = float(np.abs(omega(system, X[0], y[0], *[ONE[1]] * 2)).max())
    near, beyond = (float(np.abs(moved(np.array([[x]]), ONE[0])).max()) for x in (radius, 1e6))
    bound, slope = radius / least, max(1 / least, radius / least**2)
    return Evidence(
        printed=(at_most("|Φ| of g = X/y at |X| = 10⁶ over |Φ| at |X| = 2", beyond / near, 1.0, TOL),),
        corrected=(
            at_most("|Φ| where |X| ≤ R = 2 and y ≥ y_min = 0.5, bound R/y_min", size, bound, TOL),
            at_most("difference quotient of Φ there, bound R/y_min²", steep, slope, TOL),
            at_most("|Ω| of g = X/y", bent, 0.0, TOL),
        ),
        seed=SEED,
    )
