"""Chapter 1, section 4.6.1: the tools of the proof of existence."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.thesis.chapter1.sets import ROUNDING, SAMPLES, SEED, Floats

T, A, B, N = 1.0, 0.01, 0.01, 50


def sup_norm(x: Floats) -> Floats:
    """Return the norm of L^∞ of step functions on [0, T], over the last axis."""
    return np.asarray(np.abs(x).max(axis=-1))


def mean_norm(x: Floats) -> Floats:
    """Return the norm of L^1 of step functions with equal steps on [0, T]."""
    return np.asarray(np.abs(x).mean(axis=-1) * T)


def hlawka(norm: Callable[[Floats], Floats], x: Floats, y: Floats, z: Floats) -> Floats:
    """Return |x + y| + |y + z| + |z + x| - |x| - |y| - |z| - |x + y + z|, which is never above 0 in L^1."""
    pairs = norm(x + y) + norm(y + z) + norm(z + x)
    return np.asarray(pairs - norm(x) - norm(y) - norm(z) - norm(x + y + z))


@claim(
    "c1.isometry",
    "There is an isometry of L^∞ into L¹.",
    source="section 4.6.1",
    quote="there exists an isometry L^∞([0, T], ℝ^d) → L¹([0, T], ℝ^d).",
    correction=Correction(
        "an isometry onto the dual space of L¹; into L¹ a continuous embedding, ‖x‖₁ ≤ T ‖x‖_∞",
        Effect.PROOF,
        "(1.58), which uses the embedding",
        why=(
            "L^∞ is not separable and L¹ is, so that no isometry leads into L¹; what is isometric to L^∞ is the dual "
            "space of L¹, named just before"
        ),
        place=912,
    ),
    tried_on="step functions, random ones in L¹",
    chosen="linear maps; no other isometry exists either, as L^∞ is not separable",
)
def _isometry() -> Evidence:
    """Hlawka's inequality is about norms of sums, so an isometric linear map would carry it over from L^1."""
    x, y, z = np.array([[1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]])
    sup = float(hlawka(sup_norm, x, y, z))
    samples = np.random.default_rng(SEED).normal(size=(3, SAMPLES, 9))
    mean, ratio = float(hlawka(mean_norm, *samples).max()), float((mean_norm(samples) / sup_norm(samples)).max()) / T
    return Evidence(
        printed=(at_most("excess of three step functions in L^∞ over Hlawka's inequality, which L¹ obeys", sup, 0.0),),
        corrected=(
            at_most("largest ‖x‖₁ over T‖x‖_∞", ratio, 1.0),
            at_most(f"largest excess over Hlawka's inequality of {SAMPLES} triples in L¹", mean, 0.0, ROUNDING),
        ),
        seed=SEED,
    )


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
