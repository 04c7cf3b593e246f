"""Chapter 5, section 2.1: the factors of the Lagrangian (5.8)."""

from __future__ import annotations

from typing import Any

import numpy as np

from verification.claims import Evidence, Verdict, at_least, claim, equal, proved
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.general import multiplier, particle
from verification.thesis.chapter5.instant import TOL, Floats, System, force1, general_instant, instant, kernel

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


@claim(
    "c5.scaling",
    "With 1/N before the particles' part of the Lagrangian their influence and multipliers stay bounded.",
    source="section 2.1",
    quote=(
        "With the choice α ~ 1/N the influence of the particles on the macroscopic component remains of order"
        " 1 in the limit … to ensure that also λ₁, …, λ_N are of order 1. Therefore, we pick γ ~ 1/N"
    ),
    recorded=Verdict.PROVED,
    rests_on=("c5.equations", "c5.acceleration"),
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


def inertia(count: int) -> float:
    """Return the mass that particles on g = X - y add to y: the force 1 on y over its acceleration, less 1."""
    system = System(0.7, lambda X, y: X - y, lambda y: -y.sum(), lambda X: 0 * X[..., 0], lambda r: 0 * r[..., 0])
    at = instant(system, np.linspace(-1.0, 2.0, count)[:, None], np.array([0.3]), np.array([0.2]))
    return 1 / at.a.item() - 1


@claim(
    "c5.total-mass",
    "With α = 1/N all particles together weigh m, however many they are.",
    source="section 2.1",
    quote="A side effect of this scaling is that the total mass of the particles is constant in the limit",
    rests_on=("c5.equations",),
    tried_on="1, 8 and 64 particles that move as y does, g = X − y",
)
def _total_mass() -> Evidence:
    """The mass is measured: a force on y and the acceleration that follows from the Lagrangian."""
    return Evidence(
        printed=tuple(
            equal(f"mass that {count} particles of m = 0.7 add to y", inertia(count), 0.7, TOL) for count in (1, 8, 64)
        )
    )


@claim(
    "c5.gamma",
    "The factor before the constraints changes only the multipliers.",
    source="section 2.1",
    quote=("the choice of the factor γ is physically irrelevant, since the Lagrangian multipliers … would just scale"),
    recorded=Verdict.PROVED,
    rests_on=("c5.equations",),
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
