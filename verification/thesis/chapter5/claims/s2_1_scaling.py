"""Chapter 5, section 2.1: the factors of the Lagrangian (5.8), and what the constraints determine."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

from verification.claims import Evidence, Verdict, proved
from verification.formal.algebra import identity, library, matrices
from verification.formal.reals import implication
from verification.thesis.chapter5.general import multiplier, particle
from verification.thesis.text.quoted import claim


@claim(
    "c5.locally",
    "With full rank, y fixes each particle as long as it is followed, not among all positions.",
    "after (5.5)",
    Verdict.PROVED_INSTANCE,
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
    "after (5.7)",
    Verdict.PROVED,
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


@claim(
    "c5.interaction-scaling",
    "With 1/N before the sum over pairs their influence does not grow with the number of particles.",
    "section 2.1",
    Verdict.PROVED,
)
def _beta() -> Evidence:
    """c particles for each of N at the same places; K is the sum of the forces of N particles on one."""
    sp = library()
    c, n, K = sp.symbols("c N K", positive=True)
    return proved(
        identity(
            "with β = 1/N the force β Σ_k K(X_k, X_i) on a particle is the same for cN particles at the places of N",
            lambda s: c * K * (c * n) ** -s - K * n**-s,
            "β = 1",
            0,
        )
    )


@claim(
    "c5.scaling",
    "With 1/N before the particles' part of the Lagrangian their influence and multipliers stay bounded.",
    "section 2.1",
    Verdict.PROVED,
)
def _alpha() -> Evidence:
    """c particles at each of N places: alpha m A = alpha f - gamma G^T lambda, and y feels gamma sum B^T lambda."""
    sp = library()
    p, (c, n) = particle(), sp.symbols("c N", positive=True)

    def multipliers(count: Any, power: Any) -> Any:
        return (1 / count) / count**-power * multiplier(p)

    return proved(
        identity(
            "with α = γ = 1/N the multipliers λ_i = (α/γ)(∂_X g)⁻ᵀ(f_i − mẌ_i) are the same for cN particles",
            lambda s: multipliers(c * n, s) - multipliers(n, s),
            "γ = 1",
            0,
        ),
        identity(
            "and so is what y feels of them, α Σ (∂_y g)ᵀ(∂_X g)⁻ᵀ(f_i − mẌ_i)",
            lambda s: (c * n * (c * n) ** -s - n * n**-s) * p.BT * multiplier(p),
            "α = 1",
            0,
        ),
    )


@claim(
    "c5.total-mass",
    "With α = 1/N all particles together have the mass m.",
    "section 2.1",
    Verdict.PROVED,
)
def _total_mass() -> Evidence:
    n, m = library().symbols("N m", positive=True)
    return proved(identity("N particles of mass αm = m/N have the mass m", lambda s: n * m * n**-s - m, "α = 1", 0))


@claim(
    "c5.gamma",
    "The factor before the constraints changes only the multipliers.",
    "section 2.1",
    Verdict.PROVED,
)
def _gamma() -> Evidence:
    """The equations of motion contain gamma lambda only."""
    p, (share, gamma) = particle(), library().symbols("alpha gamma", positive=True)
    level = share / gamma * multiplier(p)
    return proved(
        identity(
            "λ_i = (α/γ)(∂_X g)⁻ᵀ(f_i − mẌ_i): the constraint forces γ(∂_X g)ᵀλ_i, γ(∂_y g)ᵀλ_i do not depend on γ",
            lambda s: [(gamma * part * level.subs(gamma, gamma**s)).diff(gamma) for part in (p.GT, p.BT)],
            "λ_i ~ γ",
        )
    )
