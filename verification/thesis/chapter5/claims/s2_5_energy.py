"""Chapter 5, sections 2.5 and 3.3: the energy is conserved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_least, at_most, claim, proved, put_right
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.general import even
from verification.thesis.chapter5.instant import (
    STEP,
    TOL,
    WRONG,
    Floats,
    Instant,
    effective_force,
    effective_mass,
    force0,
    force1,
    general_instant,
    kinetic,
    omega,
    phi,
    potential,
    pulls,
    pushed,
    slope,
)
from verification.thesis.chapter5.lemmas import conserved

WEIGHTS = np.array([0.4, 0.3, 0.2, 0.1])
# A rate of a sum over a square is known to rounding of the sum.
SMALL_RATE = 1e-6
SIDE = np.linspace(-2.0, 2.0, 41)
SQUARE = np.stack(np.meshgrid(SIDE, SIDE, indexing="ij"), axis=-1).reshape(-1, 2)
# Some acceleration that no force causes.
ANY = np.array([0.9, -1.3, 0.4])


def along(at: Instant, f: Callable[[Floats, Floats], Floats]) -> float:
    """Return the rate of f(X, y) along the motion."""
    return float(slope(lambda s: f(at.X + s * at.U, at.y + s * at.v), np.zeros(()), np.ones(())))


@claim(
    "c5.energy",
    "The reduced equations keep the total energy.",
    source="Lemma 5.5, (5.37)",
    quote="E = … + 1/(2N) Σ_k 𝒱(X_k, X_i)) is a conserved quantity",
    recorded=Verdict.PROVED,
    rests_on=("c5.effective", "c5.acceleration", "c5.interaction-power"),
    chosen="𝒱(X_k − X_i), see c5.pair-energy; an even 𝒱, as (A2a) needs it",
)
def _energy() -> Evidence:
    return proved(conserved())


@claim(
    "c5.energy-lagrangian",
    "Lagrangian and energy are related by L = ‖ẏ‖² − E.",
    source="proof of Lemma 5.5",
    quote="the Lagrangian L = ‖ẏ‖² − E",
    correction=Correction(
        "L = ‖ẏ‖² + m/N Σ_i ‖Ẋ_i‖² − E",
        Effect.PROOF,
        "nothing: with L of (5.8) Lemma 5.5 follows as said",
        why="L is twice the kinetic energy less E, and the particles have a part of the kinetic energy",
        place=3474,
    ),
    rests_on=("c5.lagrangian",),
)
def _lagrangian() -> Evidence:
    """T is the kinetic energy of y (n = |y'|^2) and of the particles (q, the mean of m |X'|^2), W the other energy."""
    return put_right(
        identity(
            "T − W = ‖ẏ‖² + m/N Σ‖Ẋ_i‖² − E for E = T + W",
            lambda s, n, q, W: (n + q) / 2 - W - (n + s * q - ((n + q) / 2 + W)),
            "T − W = ‖ẏ‖² − E",
            0,
        )
    )


def atoms_move() -> tuple[Instant, Floats, float]:
    """Return four points with unequal weights, their ÿ by (5.40), and the rate of the whole kinetic energy."""
    at, w = general_instant(), WEIGHTS
    system, moved = at.system, phi(at.system, at.X, at.y)
    curved = omega(system, at.X, at.y, at.v, at.v)
    each = force1(system, at.X) + np.tensordot(w, pulls(system, at.X), axes=1) - system.m * curved
    mass = np.eye(3) + system.m * np.tensordot(w, moved.transpose(0, 2, 1) @ moved, axes=1)
    a = np.asarray(np.linalg.solve(mass, force0(system, at.y) + w @ pushed(moved, each)), dtype=np.float64)
    return at, a, float(at.v @ a + system.m * (w @ (at.U * (moved @ a + curved)).sum(axis=1)))


@claim(
    "c5.mean-field-energy",
    "The mean-field equations keep the total energy.",
    source="Lemma 5.11, (5.50)",
    quote="E = ½‖ẏ‖² + 𝒲₀(y) + ∫ m/2 ‖Φ(x, y)ẏ‖² + 𝒲₁(x) + ½∫ 𝒱(x′ − x) dμᵗ(x′) is conserved",
    correction=Correction(
        "E = ½‖ẏ‖² + 𝒲₀(y) + ∫(m/2 ‖Φ(x, y)ẏ‖² + 𝒲₁(x) + ½∫ 𝒱(x′ − x) dμᵗ(x′)) dμᵗ(x)",
        Effect.NOTATION,
        ("the first line of Ė in the proof, which has dμᵗ(x̃′) twice; from its second line on x has its measure"),
        why="the outer integral has no measure; the mean over the particles in (5.37) becomes an integral over μᵗ",
        place=3688,
    ),
    rests_on=("c5.limit-force", "c5.energy-proof", "c5.interaction-power"),
    tried_on="four point masses",
    chosen="an even 𝒱; for the reading with dx the square |x₁|, |x₂| ≤ 2",
)
def _mean_field() -> Evidence:
    """The rate of (5.50) by (5.40), with dμ(x), and with dx: then x stays, and only y, ẏ and the measure move."""
    at, a, gained = atoms_move()
    system, w = at.system, WEIGHTS

    def stored(X: Floats, y: Floats) -> Floats:
        return np.asarray(system.W0(y) + w @ system.W1(X) + w @ system.V(X[:, None] - X[None]) @ w / 2)

    def read_with_dx(s: float) -> float:
        X, y, v = at.X + s * at.U, at.y + s * at.v, at.v + s * a
        each = system.m / 2 * ((phi(system, SQUARE, y) @ v) ** 2).sum(axis=1) + system.W1(SQUARE)
        each = each + w @ system.V(X[:, None] - SQUARE[None]) / 2
        return float(v @ v / 2 + system.W0(y) + each.sum() * (SIDE[1] - SIDE[0]) ** 2)

    rate = abs(gained + along(at, stored))
    printed = abs(read_with_dx(STEP) - read_with_dx(-STEP)) / (2 * STEP)
    return Evidence(
        printed=(at_most("rate of (5.50) with dx, on the square |x₁|, |x₂| ≤ 2", printed, 0.0, SMALL_RATE),),
        corrected=(
            at_most("rate of (5.50) with dμᵗ(x), four points of unequal weights", rate, 0.0, TOL),
            at_least("rate of their kinetic energy", abs(gained), WRONG),
        ),
    )


@claim(
    "c5.interaction-power",
    "The energy of a pair, and of all pairs, changes by the power of the interaction.",
    source="(5.52), (5.53)",
    quote="d/dt 𝒱(Xᵗ(x′) − Xᵗ(x)) = −Ẋᵗ(x′)K(Xᵗ(x), Xᵗ(x′)) − Ẋᵗ(x)K(Xᵗ(x′), Xᵗ(x))",
    recorded=Verdict.PROVED,
    rests_on=("c5.even-potential", "c5.pair-force"),
    chosen="an even 𝒱, as (A2a) needs it; products of vectors by c5.power-transpose",
)
def _power() -> Evidence:
    """One coordinate of both points, the other coordinates being held: the chain rule sums over coordinates."""
    sp = library()
    t, p = sp.symbols("t p")
    x, z, V = sp.Function("x")(t), sp.Function("z")(t), even("w")

    def K(there: Any, here: Any, q: Any) -> Any:
        return -V(there - here, q).diff(here)

    U, there = x.diff(t), z.diff(t)
    rate = V(z - x, p).diff(t)

    def residuals(s: Any) -> Any:
        second = -there * K(x, z, -p) - U * K(z, x, p)
        both = (V(z - x, p) + V(x - z, -p)).diff(t) / 2 + there * K(x, z, -p) + U * K(z, x, p)
        return [rate - s * second, rate - there * K(z, x, p) + U * K(z, x, p), both]

    return proved(
        identity("both lines of (5.52) and, a pair counted twice, (5.53), for every even 𝒱", residuals, "+ for −")
    )


@claim(
    "c5.energy-proof",
    "The energy changes at the rate ẏᵀ(m_eff ÿ − F_eff).",
    source="proof of Lemma 5.11",
    quote="Ė = … ∫ ẏᵀΦ_xᵀ(mΦ_x[ÿ] + mΩ_x[ẏ, ẏ] − F₁(Xᵗ(x) − 𝒦(x)) dμⁱⁿⁱᵗ(x) = … = ẏᵀ(m_eff ÿ − F_eff) = 0",
    correction=Correction(
        "… − F₁(Xᵗ(x)) − 𝒦(x)) dμⁱⁿⁱᵗ(x) …",
        Effect.NOTATION,
        "the second and third line of Ė; the fourth has the bracket where it belongs",
        why="F₁ is taken at a position, and 𝒦(x) is a force; the next line but one has F₁(Xᵗ(x)) + 𝒦(x)",
        place=3726,
    ),
    rests_on=("c5.limit-force", "c5.interaction-power"),
    tried_on="one state of four particles, nx = 2, ny = 3",
    chosen="for the last line an acceleration that does not solve the equation, so that the rate is not 0",
)
def _proof() -> Evidence:
    """The third line of Ė on a motion, and the last one for an acceleration that no force causes."""
    at = general_instant()
    system, moved, pull = at.system, phi(at.system, at.X, at.y), pulls(at.system, at.X).mean(axis=0)

    def third_line(forces: Floats) -> float:
        inertia = system.m * (moved @ at.a + omega(system, at.X, at.y, at.v, at.v))
        return float(abs(at.v @ (at.a - force0(system, at.y)) + (pushed(moved, inertia - forces) @ at.v).mean()))

    def energy(s: float) -> float:
        X, y, v = at.X + s * at.U, at.y + s * at.v, at.v + s * ANY
        return float(kinetic(system, phi(system, X, y) @ v, v) + potential(system, X, y))

    rate = (energy(STEP) - energy(-STEP)) / (2 * STEP)
    stated = float(at.v @ (effective_mass(system, at.X, at.y) @ ANY - effective_force(system, at.X, at.y, at.v)))
    printed, right = third_line(force1(system, at.X - pull)), third_line(force1(system, at.X) + pull)
    return Evidence(
        printed=(at_most("third line of Ė with F₁(Xᵗ(x) − 𝒦(x)), on a motion", printed, 0.0, TOL),),
        corrected=(
            at_most("third line of Ė with F₁(Xᵗ(x)) − 𝒦(x), on a motion", right, 0.0, TOL),
            at_most("Ė less ẏᵀ(m_eff ÿ − F_eff) for an ÿ that does not solve (5.40a)", abs(rate - stated), 0.0, TOL),
            at_least("|Ė| for this ÿ", abs(rate), WRONG),
        ),
    )


@claim(
    "c5.energy-in-time",
    "The energy is the same at all times of a motion.",
    source="Lemma 5.5",
    quote="the total energy … is a conserved quantity",
    recorded=Verdict.PROVED,
    rests_on=("c5.energy",),
    chosen="an even 𝒱, as (A2a) needs it",
)
def _energy_in_time() -> Evidence:
    """E' = 0 at each time, see c5.energy, so E is constant where the motion exists."""
    return proved(conserved())
