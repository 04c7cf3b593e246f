"""Chapter 5, section 2.1: the particle model and its Lagrangian."""

from __future__ import annotations

from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_least, at_most, claim, proved
from verification.formal.algebra import identity, library, matrices
from verification.formal.reals import implication
from verification.thesis.chapter5.general import even, particle
from verification.thesis.chapter5.instant import TOL, WRONG, Floats, System, general_instant, instant, pulls


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


@claim(
    "c5.even-potential",
    "The potential energy of a pair is odd: V(−X) = −V(X).",
    source="after (5.4)",
    quote="V(−X) = −V(X), ∇V(0) = 0 and V(0) = 0",
    correction=Correction(
        "V(−X) = V(X)",
        Effect.MODEL,
        "(A2a), (5.52), conservation of energy: with an odd V all pairs cancel",
        why=(
            "the gradient of an odd function is even, so K would be symmetric, against (A2a); that of an even one"
            " is odd"
        ),
        place=3163,
    ),
    tried_on="one even potential",
)
def _even() -> Evidence:
    """V(r) = sum of r^3 fulfils all that is printed, but K is not antisymmetric, against (A2a)."""
    at = general_instant()

    def lack(system: System) -> float:
        found = pulls(system, at.X)
        return float(np.abs(found + found.transpose(1, 0, 2)).max())

    pairs = at.X[:, None] - at.X[None]
    even = float(abs(at.system.V(pairs) - at.system.V(-pairs)).max())
    return Evidence(
        printed=(at_most("|K(X, X′) + K(X′, X)| for the odd V(r) = Σr³", lack(at.system._replace(V=odd)), 0.0, TOL),),
        corrected=(
            at_most("|K(X, X′) + K(X′, X)| for an even V", lack(at.system), 0.0, TOL),
            at_most("|V(r) − V(−r)| of this V", even, 0.0, TOL),
        ),
    )


@claim(
    "c5.equations",
    "The equations for the accelerations are those of the Lagrangian.",
    source="(5.6a), (5.6b)",
    quote=(
        "mẌ_i = F₁(X_i) + 1/N Σ_k K(X_k, X_i) − (∂_X g)ᵀλ_i, ÿ = F₀(y) − 1/N Σ_j (∂_y g)ᵀλ_j … Euler-Lagrange"
        " equations for the choice α = β = γ = 1/N"
    ),
    recorded=Verdict.PROVED,
    rests_on=("c5.even-potential",),
    chosen="an even 𝒱, as (A2a) needs it; for (5.6c) see c5.lagrangian",
)
def _equations() -> Evidence:
    """One coordinate x of X_i and one of y, the others being p and q; sums over particles and components are linear."""
    sp = library()
    t, n, m, level, p, q = sp.symbols("t N m lambda p q")
    x, z, y = (sp.Function(name)(t) for name in "xzy")
    W0, W1, g, V = sp.Function("W0"), sp.Function("W1"), sp.Function("g"), even("w")
    pairs = (V(z - x, p) + V(x - z, -p)) / (2 * n**2)
    lagrangian = y.diff(t) ** 2 / 2 - W0(y, q) - pairs
    lagrangian += (m * x.diff(t) ** 2 / 2 - W1(x, p) - level * g(x, p, y, q)) / n

    def euler(of: Any) -> Any:
        return lagrangian.diff(of.diff(t)).diff(t) - lagrangian.diff(of)

    def residuals(s: Any) -> Any:
        K = -V(z - x, p).diff(x) / n
        first = m * x.diff(t, 2) + W1(x, p).diff(x) - K + s * level * g(x, p, y, q).diff(x)
        return [
            n * euler(x) - first,
            euler(y) - y.diff(t, 2) - W0(y, q).diff(y) - s * level * g(x, p, y, q).diff(y) / n,
        ]

    return proved(
        identity(
            "the Euler-Lagrange equations of (5.8) with α = β = γ = 1/N are (5.6a) and (5.6b), each coordinate, any 𝒱 "
            "that is even",
            residuals,
            "−λ for λ",
        )
    )


@claim(
    "c5.locally",
    "With full rank, y determines each particle locally: along a motion, not among all positions.",
    source="after (5.5)",
    quote=("This implies that the state of the macroscopic component determines locally the position of all particles"),
    recorded=Verdict.PROVED_INSTANCE,
    tried_on="g = exp(X) − y in the complex plane",
)
def _locally() -> Evidence:
    """Full rank everywhere, and two positions of one level."""
    sp = library()
    a, b = sp.symbols("a b", real=True)
    g = sp.Matrix([sp.exp(a) * sp.cos(b), sp.exp(a) * sp.sin(b)])
    return proved(
        identity(
            "g = exp(X₁)(cos X₂, sin X₂) − y has det ∂_X g = exp(2X₁) > 0, so X follows y; X and X + (0, 2π) have "
            "one level",
            lambda s: [g.jacobian([a, b]).det() - sp.exp(2 * a), *(g.subs(b, b + (1 + s) * sp.pi) - g)],
            "X and X + (0, 3π)",
            2,
        )
    )


@claim(
    "c5.initial-multipliers",
    "Positions and the velocity of the macroscopic component fix the multipliers at the start.",
    source="after (5.7)",
    quote=("the Lagrangian multipliers for (5.6c), and their initial value is determined implicitly by the system"),
    recorded=Verdict.PROVED,
    rests_on=("c5.equations",),
)
def _initial_multipliers() -> Evidence:
    """The homogeneous equations of accelerations and multipliers, tested with their own solution."""
    p, (A, AT, aT, level) = particle(), matrices("A AT aT lambda")

    def tested(s: Any) -> Any:
        first, second = p.m * A + p.GT * level, p.a + s * p.BT * level
        return AT * first + aT * second - (p.m * AT * A + aT * p.a) - (AT * p.GT + aT * p.BT) * level

    return proved(
        identity(
            "of a solution of the homogeneous equations for Ẍ_i, ÿ, λ_i the sum m|Ẍ_i|² + |ÿ|² is −λ_i·(∂_X g Ẍ_i "
            "+ ∂_y g ÿ)",
            tested,
            "−λ_i in the equation of y",
        ),
        implication(
            "as that is 0, Ẍ_i = 0, ÿ = 0 and, ∂_X g having full rank, λ_i = 0: there is one solution",
            lambda s, m, A2, a2: ([m > 0, A2 >= 0, a2 >= 0, m * A2 + s * a2 == 0], [A2 == 0, a2 == 0]),
            "m|Ẍ_i|² − |ÿ|² = 0",
        ),
    )
