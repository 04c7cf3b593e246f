"""Chapter 1, section 4.6.1: the tools of the proof of existence."""

from __future__ import annotations

import math

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.thesis.chapter1.sets import ROUNDING, SAMPLES, SEED, Floats

T, A, B, N = 1.0, 0.01, 0.01, 50


def sequences(size: float) -> Floats:
    """Return sequences a_0, ..., a_n of (1.43) in the plane, (n + 1, K, 2), |a_0| = size; the first grows fastest."""
    rng, a = np.random.default_rng(SEED), np.zeros((SAMPLES, 2))
    a[:, 0] = size
    path = [a]
    for _ in range(N):
        direction = a + rng.normal(size=a.shape) * np.where(np.arange(SAMPLES) == 0, 0.0, 5.0)[:, None]
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        a = a + T / N * (A + B * np.linalg.norm(a, axis=1, keepdims=True)) * direction
        path.append(a)
    return np.array(path)


def discrete_bound(first: float) -> float:
    """Return the middle of (1.44) with a factor in its first term."""
    grown = (1 + B * T / N) ** N
    return first * grown + A / B * (grown - 1)


@claim(
    "c1.gronwall-discrete",
    "Sequences with (1.43) are bounded by (1 + BT/n)^n + A/B ((1 + BT/n)^n - 1), whatever their first element.",
    source="Theorem 1.36, (1.43)",
    also=("c1.gronwall-range",),
    quote="a_k ≤ (1 + BT/n)^n + 1/B ((1 + BT/n)^n - 1) A ≤ exp(BT) + A (exp(BT) - 1)/B",
    correction=Correction(
        "‖a_k‖ ≤ (1 + BT/n)^n ‖a₀‖ + 1/B ((1 + BT/n)^n - 1) A ≤ exp(BT) ‖a₀‖ + A (exp(BT) - 1)/B",
        Effect.CONCLUSION,
        "(1.52) and the constants C₁, C₂, C₃; the proof of existence stands with the factor",
        why="‖a_{k+1}‖ ≤ (1 + BT/n)‖a_k‖ + AT/n, so (1 + BT/n)^k multiplies ‖a₀‖; a_k is a vector, its norm is bounded",
        place=942,
    ),
    tried_on="300 sequences in the plane, n = 50",
)
def _gronwall_discrete() -> Evidence:
    start = 10.0
    largest = float(np.linalg.norm(sequences(start), axis=2).max())
    top = start * math.exp(B * T) + A * (math.exp(B * T) - 1) / B
    return Evidence(
        printed=(at_most(f"‖a₀‖ = {start:g}: largest ‖a_k‖ over (1.44)", largest / discrete_bound(1.0), 1.0),),
        corrected=(
            at_most("largest ‖a_k‖ over (1.44) with ‖a₀‖", largest / discrete_bound(start), 1.0, ROUNDING),
            at_most("largest ‖a_k‖ over (1.45) with ‖a₀‖", largest / top, 1.0, ROUNDING),
        ),
        seed=SEED,
    )
