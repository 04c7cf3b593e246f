"""Chapter 5, sections 2.5 and 3.3: what the energy says about the speed of the macroscopic component."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter5.instant import runge_kutta, symbolic_soft

# What the integration of the pendulum leaves, and far above it.
SLACK = 1e-6


def speeds(force: Callable[[float], float]) -> tuple[float, float]:
    """Return |y'| at t = 10 and 100 of y'' = force(y) from rest at 0: g = X - y, particles without forces or mass."""
    path = runge_kutta(lambda z: np.array([z[1], force(z[0])]), np.zeros(2), 100.0, 1000)
    return float(path[100, 1]), float(path[1000, 1])


@claim(
    "c5.speed-all-times",
    "The start alone bounds the speed of the macroscopic component for all times.",
    source="section 2.5",
    quote="‖ẏ(t)‖ ≤ M_v for all t ≥ 0 where M_v > 0 is a constant depending only on the initial conditions",
    correction=Correction(
        (
            "for potentials that are bounded below, which (A1a) to (A5b) do not ask for; else up to a time T, with a "
            "bound that depends on T"
        ),
        Effect.PROOF,
        "the constants of Theorems 5.9, 5.12 and 5.16; existence and uniqueness up to T stand",
        why=(
            "a constant force fulfils (A1a), (A1b) and accelerates without end; the energy bounds the speed only if "
            "the potential energy is bounded below"
        ),
        place=3458,
    ),
    rests_on=("c5.speed-bound",),
    tried_on="one potential ≥ 0",
    chosen="W₀ = −y, and W₀ = √(1 + y²) − y, which pulls the same way but is not negative",
)
def _all_times() -> Evidence:
    """A free fall, and a potential that is bounded below and pulls the same way."""
    fall, held = speeds(lambda _: 1.0), speeds(lambda y: float(1 - y / np.sqrt(1 + y**2)))
    bound = float(np.sqrt(2.0))
    return Evidence(
        printed=(at_most("‖ẏ‖ at t = 100 over ‖ẏ‖ at t = 10 in free fall, W₀ = −y", fall[1] / fall[0], 1.0, SLACK),),
        corrected=(at_most("‖ẏ‖ at t = 100 for W₀ = √(1 + y²) − y, E = 1, bound √(2E)", held[1], bound, SLACK),),
    )


# E = v2/2 + k + W: the kinetic energy k >= 0 of the particles, all potential energy W >= w; speed = |y'|.
v2, k, W, w, E, speed, M = reals("v2 k W w E v M")
ENERGY = [v2 >= 0, k >= 0, w <= W, v2 / 2 + k + W == E]
SPEED = [speed >= 0, M >= 0, E > 0, speed * speed <= 2 * E]

_bound = argument(
    "c5.speed-bound",
    "(5.38); proof of Theorem 5.9; proof of Theorem 5.12",
    "‖ẏ(t)‖² ≤ 2E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ)",
    "The energy E bounds the speed of the macroscopic component: ‖ẏ‖² ≤ 2E.",
    follows(ENERGY, v2 <= 2 * (E - w), v2 <= 2 * E, "‖ẏ‖² ≤ 2(E − inf W)", "‖ẏ‖² ≤ 2E for potentials of any sign"),
    follows(
        [*SPEED, M * M == 2 * E],
        speed <= M,
        ([*SPEED, M == 2 * E * E], speed <= M),
        "‖ẏ‖² ≤ 2E gives ‖ẏ‖ ≤ M_v with M_v² = 2E, for particles",
        "with M_v = 2E²",
    ),
    follows(
        [*SPEED, M * M == 2 * E],
        speed <= M,
        ([*SPEED, M == 2 * E], speed <= M),
        "and in the limit",
        "with M_v = 2E",
    ),
    also=("c5.speed-constant", "c5.speed-constant-limit"),
    correction=Correction(
        "‖ẏ(t)‖² ≤ 2(E − the infimum of the potential energy), or 2E if no potential is negative",
        Effect.CONCLUSION,
        "M_v of Theorems 5.9, 5.12 and 5.16, which need potentials that are bounded below",
        why="‖ẏ‖²/2 is E less all other energy, and the potential energy may be negative",
        place=3472,
    ),
    rests_on=("c5.energy",),
)

# v = y' by (5.11a) without forces, X' = Phi v: E is constant, so v follows from X, and X' = h(X) has one solution, as h
# = Phi (2E/(1 + m Phi^2))^(1/2) with 2/3 <= Phi <= 2 is smooth, of period 2 pi, and never 0.
sp = library()
x, v, m = sp.symbols("X v m", positive=True)
soft = symbolic_soft(x)
ACCELERATION = -m * soft * sp.sin(x) / 2 * soft**3 * v**2 / (1 + m * soft**2)
KINETIC = (1 + m * soft**2) * v**2 / 2
mass, p, c, size = reals("m p c phi")
SQUARE = [E > 0, mass > 0, p >= 0, p <= 4, (1 + mass * p) * v2 == 2 * E]

_well_posed = argument(
    "c5.well-posed",
    "Theorem 5.9",
    "For T > 0 … the ODE model has a unique solution",
    "Solutions exist for all times and are unique, though a term grows with the square of the speed.",
    vanishes(
        KINETIC.diff(x) * soft * v + KINETIC.diff(v) * ACCELERATION,
        KINETIC.diff(x) * soft * v - KINETIC.diff(v) * ACCELERATION,
        "E = (1 + mΦ²)ẏ²/2 is constant although mΦᵀΩ[ẏ, ẏ] grows with ẏ²",
        "with +mΦᵀΩ",
    ),
    follows(
        SQUARE,
        [v2 > 0, v2 <= 2 * E, (1 + 4 * mass) * v2 >= 2 * E],
        v2 <= E,
        "so ẏ² = 2E/(1 + mΦ²) lies between 2E/(1 + 4m) > 0 and 2E for all times",
        "at most E",
    ),
    follows(
        [c >= -1, c <= 1, size * (2 + c) == 2],
        [3 * size >= 2, size <= 2],
        size <= 1,
        "as ⅔ ≤ Φ = 1/(1 + cos(X)/2) ≤ 2",
        "Φ ≤ 1",
    ),
    rests_on=("c5.right-side", "c5.speed-all-times", "c5.speed-bound"),
    tried_on="g = X + sin(X)/2 − y without forces, every mass and start",
    chosen="particles without forces on g = X + sin(X)/2 − y",
)
