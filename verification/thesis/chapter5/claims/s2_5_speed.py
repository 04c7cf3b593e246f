"""Chapter 5, sections 2.5 and 3.3: what the energy says about the speed of the macroscopic component."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, put_right
from verification.formal.reals import implication
from verification.thesis.chapter5.instant import STEP, Floats, general_instant, kinetic, phi, potential
from verification.thesis.chapter5.wavy import runge_kutta, soft

# What the integration of the pendulum leaves, and far above it.
SLACK = 1e-6
# What central differences of numbers that are right to rounding leave.
RATE_TOL = 1e-8
M, ENERGY = 0.1, 0.1


def free_speed() -> float:
    """|y'| of a free motion with g = X - y, of which the energy is (1 + m)|y'|^2/2."""
    return float(np.sqrt(2 * ENERGY / (1 + M)))


def curved_force(X: Floats, v: float, m: float) -> Floats:
    """-m Phi Omega[v, v] of (5.14) for g = X + sin(X)/2 - y."""
    return np.asarray(-m * soft(X) * np.sin(X) / 2 * soft(X) ** 3 * v**2)


def speeds(force: Callable[[float], float]) -> tuple[float, float]:
    """|y'| at t = 10 and t = 100 of y'' = force(y) from rest at 0: g = X - y, particles without forces or mass."""
    path = runge_kutta(lambda z: np.array([z[1], force(z[0])]), np.zeros(2), 100.0, 1000)
    return float(path[100, 1]), float(path[1000, 1])


@claim(
    "c5.speed-all-times",
    "The speed of the macroscopic component stays below a bound that the start gives.",
    source="section 2.5",
    quote="‖ẏ(t)‖ ≤ M_v for all t ≥ 0 where M_v > 0 is a constant depending only on the initial conditions",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "for potentials that are bounded below, which (A1a) to (A5b) do not ask for; else up to a time T, with a "
        "bound that depends on T",
        Effect.PROOF,
        "the constants of Theorems 5.9, 5.12 and 5.16; existence and uniqueness up to T stand",
        why=(
            "a constant force fulfils (A1a), (A1b) and accelerates without end; the energy bounds the speed "
            "only if the potential energy is bounded below"
        ),
        place=3458,
    ),
    chosen="W₀ = −y, and W₀ = √(1 + y²) − y, which pulls the same way but is not negative",
    tried_on="one potential ≥ 0",
)
def _all_times() -> Evidence:
    """A free fall, and a potential that is bounded below and pulls the same way."""
    fall, held = speeds(lambda _: 1.0), speeds(lambda y: float(1 - y / np.sqrt(1 + y**2)))
    bound = float(np.sqrt(2.0))
    return Evidence(
        f"W₀ = −y fulfils (A1a), (A1b); from rest at 0 ‖ẏ‖ is {fall[0]:.0f} at t = 10, {fall[1]:.0f} at t = 100. With "
        f"W₀ = √(1 + y²) − y ≥ 0, E = 1, it is {held[0]:.2f} and {held[1]:.2f}, below √(2E) = {bound:.2f}.",
        printed=(at_most("‖ẏ‖ at t = 100 over t = 10 in free fall", fall[1] / fall[0], 1.0, SLACK),),
        corrected=(at_most("‖ẏ‖ at t = 100, potential ≥ 0, bound √(2E)", held[1], bound, SLACK),),
    )


@claim(
    "c5.speed-bound",
    "The energy bounds the speed of the macroscopic component.",
    source="(5.38)",
    quote="‖ẏ(t)‖² ≤ 2E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "‖ẏ(t)‖² ≤ 2(E − the infimum of the potential energy), or 2E if no potential is negative",
        Effect.CONCLUSION,
        "M_v of Theorems 5.9, 5.12 and 5.16, which need potentials that are bounded below",
        why="‖ẏ‖²/2 is E less all other energy, and the potential energy may be negative",
        place=3472,
    ),
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
    recorded=Kind.NOT_REFUTED,
    chosen="a heavy, fast particle without forces on g = X + sin(X)/2 − y, T = 10",
    tried_on="one motion, g = X + sin(X)/2 − y without forces",
)
def _well_posed() -> Evidence:
    """A fast and heavy particle on g = X + sin(X)/2 - y, to T = 10 and back: X passes many bends."""
    m, start = 5.0, np.array([0.0, 10.0, 0.3])

    def rate(z: Floats) -> Floats:
        acceleration = curved_force(z[2], z[1], m) / (1 + m * soft(z[2]) ** 2)
        return np.array([z[1], acceleration, soft(z[2]) * z[1]])

    path = runge_kutta(rate, start, 10.0, 3000)
    back = runge_kutta(lambda z: -rate(z), path[-1], 10.0, 3000)[-1]
    energy = (1 + m * soft(path[:, 2]) ** 2) * path[:, 1] ** 2 / 2
    fastest, bound = float(np.abs(path[:, 1]).max()), float(np.sqrt(2 * energy[0]))
    off = float(np.abs(back - start).max())
    return Evidence(
        f"m = {m:g}, ẏ(0) = 10, no forces: although mΦᵀΩ[ẏ, ẏ] grows with ẏ², ‖ẏ‖ stays at or below {fastest:.1f} ≤ "
        f"√(2E) = {bound:.1f} up to T = 10, and the way back in time leads to the start, to {off:.0e}.",
        printed=(
            at_most("largest ‖ẏ‖", fastest, bound),
            at_most("start against start after going there and back", off, 0.0, SLACK),
            at_least("how often X passes a bend", float(path[-1, 2] - path[0, 2]) / (2 * np.pi), 1.0),
        ),
    )


@claim(
    "c5.speed-constant",
    "The bound of the speed that the proof uses.",
    source="proof of Theorem 5.9",
    quote="M_v := 2(E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ))²",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "M_v := (2E(Xⁱⁿⁱᵗ, yⁱⁿⁱᵗ, vⁱⁿⁱᵗ))^½ for potentials ≥ 0",
        Effect.NUMBER,
        "the set on which the right side is Lipschitz",
        why="(5.38) bounds the square of the speed by 2E, so the speed by a root, not by a square",
        place=3558,
    ),
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
    """The rate of E(y, ẏ, μ) on a motion whose points move (1), or are taken where they were at first (0)."""
    at = general_instant()

    def energy(s: float) -> float:
        X, y, v = at.X + moving * s * at.U, at.y + s * at.v, at.v + s * at.a
        return float(kinetic(at.system, phi(at.system, X, y) @ v, v) + potential(at.system, X, y))

    return abs(energy(STEP) - energy(-STEP)) / (2 * STEP)


@claim(
    "c5.speed-constant-limit",
    "The bound of the speed that the proof uses, in the limit.",
    source="proof of Theorem 5.12",
    quote="M_v := 2E(y, ẏ, μⁱⁿⁱᵗ). Then every solution candidate has to satisfy ‖ẏ(t)‖ ≤ M_v",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "M_v := (2E(yⁱⁿⁱᵗ, vⁱⁿⁱᵗ, μⁱⁿⁱᵗ))^½ for potentials ≥ 0",
        Effect.NUMBER,
        "the set on which the right side is Lipschitz",
        why=(
            "2E bounds the square of the speed; and Lemma 5.11 keeps the energy of y(t), ẏ(t), μᵗ, not that "
            "of y(t), ẏ(t), μⁱⁿⁱᵗ"
        ),
        place=3786,
    ),
    tried_on="one free motion, and one state of four points",
)
def _constant_limit() -> Evidence:
    printed, (speed, right) = 2 * ENERGY, (free_speed(), float(np.sqrt(2 * ENERGY)))
    frozen, moved = energy_rate(0.0), energy_rate(1.0)
    return Evidence(
        f"A free motion of energy {ENERGY:g} has ‖ẏ‖ = {speed:.3f} > 2E = {printed:.3g}, below √(2E) = {right:.3f}; 2E "
        f"is too small for E < ½. E(y, ẏ, μⁱⁿⁱᵗ) is no constant: on a motion of four points it changes at a rate of "
        f"{frozen:.2f}, E(y, ẏ, μᵗ) at {moved:.0e}.",
        printed=(
            at_most("‖ẏ‖ of a free motion, bound 2E", speed, printed),
            at_most("rate of E(y, ẏ, μⁱⁿⁱᵗ)", frozen, 0.0, RATE_TOL),
        ),
        corrected=(
            at_most("‖ẏ‖ of a free motion, bound √(2E)", speed, right),
            at_most("rate of E(y, ẏ, μᵗ), so it stays E(yⁱⁿⁱᵗ, vⁱⁿⁱᵗ, μⁱⁿⁱᵗ)", moved, 0.0, RATE_TOL),
        ),
    )
