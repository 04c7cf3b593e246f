"""Chapter 5, sections 2.5 and 3.3: what the energy says about the speed of the macroscopic component."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, proved, put_right
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter5.instant import STEP, TOL, general_instant, kinetic, phi, potential
from verification.thesis.chapter5.wavy import runge_kutta, symbolic_soft

# What the integration of the pendulum leaves, and far above it.
SLACK = 1e-6
M, ENERGY = 0.1, 0.1


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
            "for potentials that are bounded below, which (A1a) to (A5b) do not ask for; else up to a time T, "
            "with a bound that depends on T"
        ),
        Effect.PROOF,
        "the constants of Theorems 5.9, 5.12 and 5.16; existence and uniqueness up to T stand",
        why=(
            "a constant force fulfils (A1a), (A1b) and accelerates without end; the energy bounds the speed only "
            "if the potential energy is bounded below"
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


@claim(
    "c5.speed-bound",
    "The energy E bounds the speed of the macroscopic component: ‖ẏ‖² ≤ 2E.",
    source="(5.38)",
    quote="‖ẏ(t)‖² ≤ 2E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ)",
    correction=Correction(
        "‖ẏ(t)‖² ≤ 2(E − the infimum of the potential energy), or 2E if no potential is negative",
        Effect.CONCLUSION,
        "M_v of Theorems 5.9, 5.12 and 5.16, which need potentials that are bounded below",
        why="‖ẏ‖²/2 is E less all other energy, and the potential energy may be negative",
        place=3472,
    ),
    rests_on=("c5.energy",),
)
def _bound() -> Evidence:
    """E = |y'|^2/2 + k + W, the kinetic energy k >= 0 of the particles, W >= w all potential energy."""
    return put_right(
        implication(
            "‖ẏ‖² ≤ 2(E − inf W)",
            lambda s, v2, k, W, w, E: ([v2 >= 0, k >= 0, w <= W, v2 / 2 + k + W == E], v2 <= 2 * (E - s * w)),
            "‖ẏ‖² ≤ 2E for potentials of any sign",
            0,
        )
    )


@claim(
    "c5.well-posed",
    "Solutions exist for all times and are unique, though a term grows with the square of the speed.",
    source="Theorem 5.9",
    quote="For T > 0 … the ODE model has a unique solution",
    recorded=Verdict.PROVED_INSTANCE,
    rests_on=("c5.acceleration-lipschitz", "c5.speed-all-times", "c5.speed-constant"),
    tried_on="g = X + sin(X)/2 − y without forces, every mass and start",
    chosen="particles without forces on g = X + sin(X)/2 − y",
)
def _well_posed() -> Evidence:
    """v = y' by (5.11a) without forces, X' = Phi v: E is constant, so v follows from X, and X' = h(X) has one solution.

    h = Phi (2E/(1 + m Phi^2))^(1/2) with 2/3 <= Phi <= 2 is smooth, of period 2 pi, and never 0.
    """
    sp = library()
    x, v, m = sp.symbols("X v m", positive=True)
    phi = symbolic_soft(x)
    acceleration = -m * phi * sp.sin(x) / 2 * phi**3 * v**2 / (1 + m * phi**2)
    energy = (1 + m * phi**2) * v**2 / 2
    return proved(
        identity(
            "E = (1 + mΦ²)ẏ²/2 is constant although mΦᵀΩ[ẏ, ẏ] grows with ẏ²",
            lambda s: energy.diff(x) * phi * v + s * energy.diff(v) * acceleration,
            "with +mΦᵀΩ",
        ),
        implication(
            "so ẏ² = 2E/(1 + mΦ²) lies between 2E/(1 + 4m) > 0 and 2E for all times",
            lambda s, v2, E, m, p: (
                [E > 0, m > 0, p >= 0, p <= 4, (1 + m * p) * v2 == 2 * E],
                [v2 > 0, v2 <= s * 2 * E, (1 + 4 * m) * v2 >= 2 * E],
            ),
            "at most E",
            0.5,
        ),
        implication(
            "as ⅔ ≤ Φ = 1/(1 + cos(X)/2) ≤ 2",
            lambda s, c, phi: ([c >= -1, c <= 1, phi * (2 + c) == 2], [3 * phi >= 2, phi <= s * 2]),
            "Φ ≤ 1",
            0.5,
        ),
    )


@claim(
    "c5.speed-constant",
    "M_v = 2E² bounds the speed in the proof.",
    source="proof of Theorem 5.9",
    quote="M_v := 2(E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ))²",
    correction=Correction(
        "M_v := (2E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ))^½ for potentials ≥ 0",
        Effect.NUMBER,
        "the set on which the right side is Lipschitz",
        why="(5.38) bounds the square of the speed by 2E, so the speed by a root, not by a square",
        place=3558,
    ),
    rests_on=("c5.speed-bound",),
)
def _constant() -> Evidence:
    """v = |y'|, M = M_v >= 0."""
    return put_right(
        implication(
            "‖ẏ‖² ≤ 2E gives ‖ẏ‖ ≤ M_v with M_v² = 2E",
            lambda s, v, E, M: (
                [v >= 0, M >= 0, E > 0, v * v <= 2 * E, M * M == 2 * E if s == 1 else M == 2 * E * E],
                v <= M,
            ),
            "with M_v = 2E²",
        )
    )


def energy_rate(moving: float) -> float:
    """Return the rate of E(y, ẏ, μ) on a motion whose points move (1) or stay where they were at first (0)."""
    at = general_instant()

    def energy(s: float) -> float:
        X, y, v = at.X + moving * s * at.U, at.y + s * at.v, at.v + s * at.a
        return float(kinetic(at.system, phi(at.system, X, y) @ v, v) + potential(at.system, X, y))

    return abs(energy(STEP) - energy(-STEP)) / (2 * STEP)


@claim(
    "c5.speed-constant-limit",
    "In the limit M_v = 2E(y, ẏ, μⁱⁿⁱᵗ) bounds the speed.",
    source="proof of Theorem 5.12",
    quote="M_v := 2E(y, ẏ, μⁱⁿⁱᵗ). Then every solution candidate has to satisfy ‖ẏ(t)‖ ≤ M_v",
    correction=Correction(
        "M_v := (2E(yⁱⁿⁱᵗ, vⁱⁿⁱᵗ, μⁱⁿⁱᵗ))^½ for potentials ≥ 0",
        Effect.NUMBER,
        "the set on which the right side is Lipschitz",
        why=(
            "2E bounds the square of the speed; and Lemma 5.11 keeps the energy of y(t), ẏ(t), μᵗ, not that of "
            "y(t), ẏ(t), μⁱⁿⁱᵗ"
        ),
        place=3786,
    ),
    tried_on="one free motion, and one state of four points",
)
def _constant_limit() -> Evidence:
    """A free motion with g = X - y has the energy (1 + m)|y'|^2/2."""
    speed, printed, right = float(np.sqrt(2 * ENERGY / (1 + M))), 2 * ENERGY, float(np.sqrt(2 * ENERGY))
    frozen, moved = energy_rate(0.0), energy_rate(1.0)
    return Evidence(
        printed=(
            at_most("‖ẏ‖ of a free motion of energy 0.1, bound 2E", speed, printed),
            at_most("rate of E(y, ẏ, μⁱⁿⁱᵗ) on a motion of four points", frozen, 0.0, TOL),
        ),
        corrected=(
            at_most("‖ẏ‖ of a free motion, bound √(2E)", speed, right),
            at_most("rate of E(y, ẏ, μᵗ), so it stays E(yⁱⁿⁱᵗ, vⁱⁿⁱᵗ, μⁱⁿⁱᵗ)", moved, 0.0, TOL),
        ),
    )
