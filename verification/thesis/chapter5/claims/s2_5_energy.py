"""Chapter 5, sections 2.5 and 3.3: the energy is conserved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, claim, proved, put_right
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.general import even
from verification.thesis.chapter5.instant import (
    Floats,
    Instant,
    slope,
)
from verification.thesis.chapter5.lemmas import conserved

WEIGHTS = np.array([0.4, 0.3, 0.2, 0.1])
# A rate of a sum over a square is known to rounding of the sum.
SIDE = np.linspace(-2.0, 2.0, 41)
SQUARE = np.stack(np.meshgrid(SIDE, SIDE, indexing="ij"), axis=-1).reshape(-1, 2)


def along(at: Instant, f: Callable[[Floats, Floats], Floats]) -> float:
    """Return the rate of f(X, y) along the motion."""
    return float(slope(lambda s: f(at.X + s * at.U, at.y + s * at.v), np.zeros(()), np.ones(())))


@claim(
    "c5.energy",
    "The reduced equations keep the total energy.",
    source="Lemma 5.5, (5.37)",
    also=("c5.energy-in-time",),
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


@claim(
    "c5.interaction-power",
    "The energy of a pair, and of all pairs, changes by the power of the interaction.",
    source="(5.52), (5.53)",
    quote="d/dt 𝒱(Xᵗ(x′) − Xᵗ(x)) = −Ẋᵗ(x′)K(Xᵗ(x), Xᵗ(x′)) − Ẋᵗ(x)K(Xᵗ(x′), Xᵗ(x))",
    recorded=Verdict.PROVED,
    rests_on=("c5.even-potential",),
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
