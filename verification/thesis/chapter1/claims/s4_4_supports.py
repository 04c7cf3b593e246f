"""Chapter 1, section 4.4: support functions."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Evidence, Verdict, equal, proved
from verification.formal.reals import implication
from verification.thesis.chapter1.sets import Floats
from verification.thesis.text.quoted import claim

SAMPLES, SEED = 300, 12
ROUNDING = 1e-12
DIRECTIONS = np.stack([f(np.linspace(0, 2 * np.pi, 720, endpoint=False)) for f in (np.cos, np.sin)], axis=1)
SHAPE, CENTRE = np.array([[1.0, 0.4], [-0.3, 0.6]]), np.array([0.5, -0.2])
# Places that come to 0 from both sides.
NEAR = np.array([-1e-9, -1e-10, 1e-10, 1e-9])


def support(points: Floats, w: Floats) -> Floats:
    """sigma of a finite set or the hull of it, for directions (K, 2)."""
    return np.asarray((points @ w.T).max(axis=0))


def ellipse_support(w: Floats) -> Floats:
    """sigma of an ellipse, the image M B_1 + c of the unit disc: |M^T w| + c . w, for directions (K, 2)."""
    return np.asarray(np.linalg.norm(w @ SHAPE, axis=1) + w @ CENTRE)


def in_ellipse(a: Floats) -> np.ndarray:
    """Whether points (K, 2) lie in the ellipse."""
    return np.asarray(np.linalg.norm(np.linalg.solve(SHAPE, (a - CENTRE).T), axis=0) <= 1)


@claim(
    "c1.half-spaces",
    "The support function tells which half-spaces contain a set.",
    "after (1.29)",
    Verdict.PROVED,
)
def _half_spaces() -> Evidence:
    """p = v.w of a point v of A; sigma is the least upper bound of these p, so not above alpha if alpha is one."""
    return proved(
        implication(
            "σ(A, w) ≤ α gives v·w ≤ σ(A, w) ≤ α for all v ∈ A",
            lambda s, p, sigma, alpha: ([p <= sigma, s * sigma <= s * alpha], p <= alpha),
            "σ(A, w) ≥ α",
        ),
        implication(
            "if σ(A, w) > α there is a v ∈ A with v·w > σ(A, w) − (σ(A, w) − α) = α, σ(A, w) being the least "
            "upper bound",
            lambda s, p, sigma, alpha, e: ([sigma > alpha, e == sigma - s * alpha, p > sigma - e], p > alpha),
            "v·w > −α",
        ),
    )


@claim(
    "c1.support",
    "Inclusion of sets is the order of their support functions.",
    "(1.30)",
    Verdict.CORRECTED,
    tried_on="an ellipse and 300 points",
)
def _support() -> Evidence:
    """A = {1/2} and B = {0, 1} on an axis; then B an ellipse and A a point, in it or not."""
    ends, middle = np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[0.5, 0.0]])
    ordered = bool((support(middle, DIRECTIONS) <= support(ends, DIRECTIONS) + ROUNDING).all())
    strangers = int(ordered and not (ends == middle).all(axis=1).any())
    points = 1.5 * np.random.default_rng(SEED).normal(size=(SAMPLES, 2))
    below = (points @ DIRECTIONS.T <= ellipse_support(DIRECTIONS)).all(axis=1)
    wrong = int((below != in_ellipse(points)).sum())
    return Evidence(
        "A = {1/2} and B = {0, 1} have σ(A, ·) ≤ σ(B, ·) but A ⊄ B: “⇐” needs B closed and convex. For B an ellipse "
        f"and A one of {SAMPLES} points, {int(below.sum())} of them in B, the two sides disagree for {wrong}.",
        printed=(equal("A ⊄ B with ordered support functions", strangers, 0),),
        corrected=(equal("disagreements, B closed and convex", wrong, 0),),
        seed=SEED,
    )


@claim(
    "c1.additive",
    "Support functions of sums of sets.",
    "(1.31)",
    Verdict.PROVED,
)
def _additive() -> Evidence:
    """Values p of A and q of B in one direction, with least upper bounds a and b; c is any upper bound of the sums."""
    return proved(
        implication(
            "σ(A, v) + σ(B, v) is an upper bound of the sums",
            lambda s, a, b, p, q: ([p <= a, q <= b], p + q <= a + s * b),
            "σ(A, v) − σ(B, v)",
        ),
        implication(
            "of an upper bound c of the sums p ≤ c − q for all p ∈ A, so a ≤ c − q; then q ≤ c − a for all q ∈ B",
            lambda s, a, p, q, c, bound: ([p + q <= c, bound == c - s * q, a <= c - q], [p <= bound, q <= c - a]),
            "p ≤ c + q",
        ),
        implication(
            "so b ≤ c − a: σ(A, v) + σ(B, v) ≤ c is the least",
            lambda s, a, b, c: ([b <= c - a], a + s * b <= c),
            "σ(A, v) + 2σ(B, v) ≤ c",
            2,
        ),
    )


FUNCTIONS: tuple[Callable[[Floats], Floats], ...] = (
    np.abs,
    lambda x: np.where(x == 0, 1.0, 0.0),
    lambda x: np.where(x == 0, -1.0, 0.0),
    lambda x: np.where(x >= 0, 1.0, 0.0),
    lambda x: np.where(x > 0, 1.0, 0.0),
)


# Wider than what continuous functions change between the places of NEAR, narrower than the jumps.
EPSILON = 0.1


def by_limsup(f: Callable[[Floats], Floats]) -> bool:
    """Lim sup f(x) <= f(0) as x -> 0, with EPSILON for what is left of the limit."""
    return bool(f(NEAR).max() <= f(np.zeros(1))[0] + EPSILON)


def by_singletons(f: Callable[[Floats], Floats]) -> bool:
    """Definition 1.10 at 0 for x -> {f(x)}."""
    return bool((np.abs(f(NEAR) - f(np.zeros(1))) < EPSILON).all())


def by_half_lines(f: Callable[[Floats], Floats]) -> bool:
    """Definition 1.10 at 0 for x -> (-inf, f(x)], by points of the half-lines."""
    depths = np.linspace(-100.0, 0.0, 1001)
    return bool((f(NEAR)[:, None] + depths < f(np.zeros(1))[0] + EPSILON).all())


@claim(
    "c1.single-valued",
    "Definition 1.10 for a single-valued function is its upper semicontinuity.",
    "after Definition 1.27",
    Verdict.CORRECTED,
    tried_on="five functions on the line",
)
def _single_valued() -> Evidence:
    plain = sum(by_singletons(f) != by_limsup(f) for f in FUNCTIONS)
    lines = sum(by_half_lines(f) != by_limsup(f) for f in FUNCTIONS)
    return Evidence(
        f"|x|, ±1 at 0 alone, and two steps, at 0: Definition 1.10 for {{f(x)}} and lim sup f(x) ≤ f(0) disagree for "
        f"{plain} of 5, as the first is continuity; Definition 1.10 for (-∞, f(x)] disagrees for {lines}.",
        printed=(equal("disagreements with {f(x)}", plain, 0),),
        corrected=(equal("disagreements with (-∞, f(x)]", lines, 0),),
    )
