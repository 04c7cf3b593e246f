"""Chapter 5, section 2.1: the factors of the Lagrangian (5.8)."""

from __future__ import annotations

import numpy as np

from verification.claims import Evidence, at_least, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.stated import argument
from verification.thesis.chapter5.general import BT, GT, multiplier
from verification.thesis.chapter5.instant import Floats, force1, general_instant, kernel

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
c, n, share, gamma = library().symbols("c N alpha gamma", positive=True)

_alpha = argument(
    "c5.scaling",
    "section 2.1",
    "With the choice α ~ 1/N the influence of the particles on the macroscopic component remains of order 1 in the "
    "limit … to ensure that also λ₁, …, λ_N are of order 1. Therefore, we pick γ ~ 1/N",
    "With 1/N before the particles' part of the Lagrangian their influence and multipliers stay bounded.",
    vanishes(
        (1 / (c * n)) / (1 / (c * n)) * multiplier - (1 / n) / (1 / n) * multiplier,
        1 / (c * n) * multiplier - 1 / n * multiplier,
        "with α = γ = 1/N the multipliers λ_i = (α/γ)(∂_X g)⁻ᵀ(f_i − mẌ_i) are the same for cN particles",
        "γ = 1",
    ),
    vanishes(
        (c * n / (c * n) - n / n) * BT * multiplier,
        (c * n - n) * BT * multiplier,
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
