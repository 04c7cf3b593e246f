"""Chapter 5, section 2.1: the particle model and its Lagrangian."""

from __future__ import annotations

from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim
from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter5 import general as of
from verification.thesis.chapter5.instant import TOL, WRONG, Floats, general_instant, instant, pulls

sp = library()
t, n, m, level, p, q = sp.symbols("t N m lambda p q")
x, z, y = (sp.Function(name)(t) for name in "xzy")
w, even = sp.Function("w"), of.even("w")


def odd(r: Floats) -> Floats:
    """Return a potential that fulfils all that is printed after (5.4)."""
    return np.asarray((r**3).sum(axis=-1))


@claim(
    "c5.non-interacting",
    "The particles exert no forces on each other.",
    source="section 2.1",
    quote="N identical, non-interacting, microscopic particles",
    correction=Correction(
        "the particles interact by K of (5.4); only their velocities (5.11b) do not depend on each other",
        Effect.MODEL,
        "(5.6a), (5.14), (5.41b), and the conclusion, which lists such forces as a further extension",
        why="(5.4) and (5.6a), which follow, have a force K between each two particles",
        place=3155,
    ),
    rests_on=("c5.equations",),
)
def _non_interacting() -> Evidence:
    at = general_instant()
    without = instant(at.system._replace(V=lambda r: 0.0 * r[..., 0]), at.X, at.y, at.v)
    change, same = float(np.abs(at.a - without.a).max()), float(np.abs(at.U - without.U).max())
    pull = float(np.abs(pulls(at.system, at.X)).max())
    return Evidence(
        printed=(at_most("largest force K between two particles, (5.4)", pull, 0.0, TOL),),
        corrected=(
            at_least("largest force K between two particles, (5.4)", pull, WRONG),
            at_least("change of ÿ by these forces, (5.6a)", change, WRONG),
            at_most("change of Ẋ_i by these forces, (5.11b)", same, 0.0, TOL),
        ),
    )


def sum_of_pulls(V: Any) -> Any:
    """Return K(X, X') + K(X', X) of (5.4), one coordinate."""
    return -V(z - x).diff(x) - V(x - z).diff(z)


_even = identity(
    "c5.even-potential",
    "after (5.4)",
    "V(−X) = −V(X), ∇V(0) = 0 and V(0) = 0",
    "The potential energy of a pair is odd: V(−X) = −V(X).",
    right=sum_of_pulls(even),
    wrong=sum_of_pulls(lambda r: w(r) - w(-r)),
    correction=Correction(
        "V(−X) = V(X)",
        Effect.MODEL,
        "(A2a), (5.52), conservation of energy: with an odd V all pairs cancel",
        why=(
            "the gradient of an odd function is even, so K would be symmetric, against (A2a); that of an even one is "
            "odd"
        ),
        place=3163,
    ),
)

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
    rests_on=("c5.even-potential",),
    chosen="an even 𝒱, as (A2a) needs it; for (5.6c) see c5.lagrangian",
)

a, b = sp.symbols("a b", real=True)
# exp(X) in the complex plane: det of the derivative is exp(2 X1) > 0.
plane = sp.Matrix([sp.exp(a) * sp.cos(b), sp.exp(a) * sp.sin(b)])

_locally = identity(
    "c5.locally",
    "after (5.5)",
    "This implies that the state of the macroscopic component determines locally the position of all particles",
    "With full rank, y determines each particle along a motion, not among all positions: X and X + (0, 2π) have one "
    "level.",
    right=[plane.jacobian([a, b]).det() - sp.exp(2 * a), *(plane.subs(b, b + 2 * sp.pi) - plane)],
    wrong=[*(plane.subs(b, b + 3 * sp.pi) - plane)],
    tried_on="g = exp(X) − y in the complex plane",
)

# A solution of the homogeneous equations for X'', y'' and lambda_i, tested with itself.
A, AT, aT, push = matrices("A AT aT lambda")
TESTED = AT * (of.m * A + of.GT * push) - of.m * AT * A - (AT * of.GT + aT * of.BT) * push
mass, A2, a2 = reals("m A2 a2")

_initial_multipliers = argument(
    "c5.initial-multipliers",
    "after (5.7)",
    "the Lagrangian multipliers for (5.6c), and their initial value is determined implicitly by the system",
    "Positions and the velocity of the macroscopic component fix the multipliers at the start.",
    vanishes(
        TESTED + aT * (of.a + of.BT * push) - aT * of.a,
        TESTED + aT * (of.a - of.BT * push) - aT * of.a,
        "of a solution of the homogeneous equations for Ẍ_i, ÿ, λ_i the sum m|Ẍ_i|² + |ÿ|² is −λ_i·(∂_X g Ẍ_i + ∂_y g "
        "ÿ)",
        "−λ_i in the equation of y",
    ),
    follows(
        [mass > 0, A2 >= 0, a2 >= 0, mass * A2 + a2 == 0],
        [A2 == 0, a2 == 0],
        ([mass > 0, A2 >= 0, a2 >= 0, mass * A2 - a2 == 0], A2 == 0),
        "as that is 0, Ẍ_i = 0, ÿ = 0 and, ∂_X g having full rank, λ_i = 0: there is one solution",
        "m|Ẍ_i|² − |ÿ|² = 0",
    ),
    rests_on=("c5.equations",),
)
