"""Chapter 1, section 4.4: support functions, scalar semicontinuity of normals, and cones of discs."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from verification.claims import (
    Correction,
    Effect,
    Evidence,
    FormalProof,
    Verdict,
    at_least,
    at_most,
    claim,
    equal,
    proved,
)
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter1.sets import ROUNDING, SAMPLES, SEED, Floats, contact_gradients, support_of_cone

DIRECTIONS = np.stack([f(np.linspace(0, 2 * np.pi, 720, endpoint=False)) for f in (np.cos, np.sin)], axis=1)
SHAPE, CENTRE = np.array([[1.0, 0.4], [-0.3, 0.6]]), np.array([0.5, -0.2])
# Places that come to 0 from both sides.
NEAR = np.array([-1e-9, -1e-10, 1e-10, 1e-9])
FUNCTIONS: tuple[Callable[[Floats], Floats], ...] = (
    np.abs,
    lambda x: np.where(x == 0, 1.0, 0.0),
    lambda x: np.where(x == 0, -1.0, 0.0),
    lambda x: np.where(x >= 0, 1.0, 0.0),
    lambda x: np.where(x > 0, 1.0, 0.0),
)
# Wider than what continuous functions change between the places of NEAR, narrower than the jumps.
EPSILON = 0.1


def support(points: Floats, w: Floats) -> Floats:
    """Return sigma of a finite set or the hull of it, for directions (K, 2)."""
    return np.asarray((points @ w.T).max(axis=0))


def ellipse_support(w: Floats) -> Floats:
    """Return sigma of an ellipse, the image M B_1 + c of the unit disc: |M^T w| + c . w, for directions (K, 2)."""
    return np.asarray(np.linalg.norm(w @ SHAPE, axis=1) + w @ CENTRE)


@claim(
    "c1.support",
    "A set A lies in B if and only if σ(A, ·) ≤ σ(B, ·).",
    source="(1.30)",
    quote="A ⊆ B ⟺ σ(A, v) ≤ σ(B, v) for all v",
    correction=Correction(
        "“⇐” holds if B is closed and convex",
        Effect.PROOF,
        "(1.73), where B is closed and convex",
        why="support functions do not tell a set from its closed convex hull: {0, 1} and [0, 1] have the same one",
        place=759,
    ),
    tried_on="an ellipse and 300 points",
)
def _support() -> Evidence:
    """A = {1/2} and B = {0, 1} on an axis; then B an ellipse and A a point, in it or not."""
    ends, middle = np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[0.5, 0.0]])
    ordered = bool((support(middle, DIRECTIONS) <= support(ends, DIRECTIONS) + ROUNDING).all())
    strangers = int(ordered and not (ends == middle).all(axis=1).any())
    points = 1.5 * np.random.default_rng(SEED).normal(size=(SAMPLES, 2))
    below = (points @ DIRECTIONS.T <= ellipse_support(DIRECTIONS)).all(axis=1)
    inside = np.linalg.norm(np.linalg.solve(SHAPE, (points - CENTRE).T), axis=0) <= 1
    wrong = int((below != inside).sum())
    return Evidence(
        printed=(equal("A ⊄ B with σ(A, ·) ≤ σ(B, ·), A = {1/2}, B = {0, 1}", strangers, 0),),
        corrected=(
            equal(f"disagreements, B an ellipse, A one of {SAMPLES} points", wrong, 0),
            at_least("points inside and outside the ellipse, the fewer", min(inside.sum(), (~inside).sum()), 1),
        ),
        seed=SEED,
    )


@claim(
    "c1.additive",
    "The support function of a sum of sets is the sum of theirs.",
    source="(1.31)",
    quote="σ(A + B, v) = σ(A, v) + σ(B, v)",
    recorded=Verdict.PROVED,
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


def by_limsup(f: Callable[[Floats], Floats]) -> bool:
    """Say whether lim sup f(x) <= f(0) as x -> 0, up to EPSILON."""
    return bool(f(NEAR).max() <= f(np.zeros(1))[0] + EPSILON)


def by_singletons(f: Callable[[Floats], Floats]) -> bool:
    """Say whether x -> {f(x)} fulfils Definition 1.10 at 0."""
    return bool((np.abs(f(NEAR) - f(np.zeros(1))) < EPSILON).all())


def by_half_lines(f: Callable[[Floats], Floats]) -> bool:
    """Say whether x -> (-inf, f(x)] fulfils Definition 1.10 at 0, by points of the half-lines."""
    depths = np.linspace(-100.0, 0.0, 1001)
    return bool((f(NEAR)[:, None] + depths < f(np.zeros(1))[0] + EPSILON).all())


@claim(
    "c1.single-valued",
    "For a single-valued function Definition 1.10 is lim sup f(x) ≤ f(x₀).",
    source="after Definition 1.27",
    quote=("f is upper semicontinuous at x₀ if it satisfies Definition 1.10, which simplifies to lim sup f(x) ≤ f(x₀)"),
    correction=Correction(
        "for {f(x)} Definition 1.10 is continuity; upper semicontinuity is Definition 1.10 for (-∞, f(x)]",
        Effect.PROOF,
        "nothing else: (1.33) is stated explicitly",
        why="for F(x) = {f(x)} Definition 1.10 asks for |f(y) − f(x)| < ε, which is continuity",
        place=782,
    ),
    tried_on="five functions on the line",
)
def _single_valued() -> Evidence:
    """|x|, +1 and -1 at 0 alone, and two steps, at 0."""
    plain = sum(by_singletons(f) != by_limsup(f) for f in FUNCTIONS)
    lines = sum(by_half_lines(f) != by_limsup(f) for f in FUNCTIONS)
    name = f"functions, of {len(FUNCTIONS)}, on which lim sup f ≤ f(0) and Definition 1.10 for {{}} disagree"
    return Evidence(
        printed=(equal(name.format("{f(x)}"), plain, 0),), corrected=(equal(name.format("(-∞, f(x)]"), lines, 0),)
    )


def closed_graph() -> FormalProof:
    """Prove that the inequality of proximal normals of a prox-regular set holds in the limit.

    v_n.(y - x_n) and |v_n||y - x_n|^2/(2 eta) come within any e > 0 of p and K of the limit; e = (p - K)/3 is tried.
    """
    z3 = solver_library()
    return implication(
        "v_n·(y − x_n) ≤ ‖v_n‖‖y − x_n‖²/(2η) for all y ∈ S holds in the limit: v ∈ N(S, x), and ‖v‖ ≤ 1, so no "
        "sequence has a larger σ in the limit, for any uniformly prox-regular S",
        lambda s, p, K, e: ([3 * e == s * (p - K), z3.Implies(e > 0, p <= K + 2 * e)], p <= K),
        "e = (K − p)/3",
    )


@claim(
    "c1.scalarly-upper",
    "The normals of length at most 1 of the set of discs are scalarly upper semicontinuous.",
    source="Proposition 1.28",
    quote="lim sup σ(-N(S, x_n) ∩ B₁(0), w) ≤ σ(-N(S, x) ∩ B₁(0), w)",
    recorded=Verdict.PROVED,
    rests_on=("c1.hypomonotone",),
)
def _scalarly_upper() -> Evidence:
    """v_n in N(S, x_n), |v_n| <= 1, tend to v (a subsequence, the ball being compact) and x_n to x: p, K of the limit.

    p = v.(y - x) and K = |v||y - x|^2/(2 eta) for a point y of S; both are continuous in v and x.
    """
    return proved(closed_graph())


@claim(
    "c1.distance",
    "The normals of length at most 1 are the subdifferential of the distance.",
    source="Remark 1.29",
    quote="N(S, x) ∩ B₁(0) = ∂dist(x, S)",
    recorded=Verdict.PROVED_INSTANCE,
    tried_on="the outside of the unit disc, every point of its boundary",
    chosen="the outside of the unit disc, x on its boundary; the ball is closed (see the errata)",
)
def _distance() -> Evidence:
    """v = -s x for a boundary point x: r = |y|, D = |y - x|^2, x.(y - x) = (r^2 - 1 - D)/2; k is any constant."""
    z3 = solver_library()
    return proved(
        implication(
            "dist(y) ≥ v·(y − x) − |y − x|² for v = −ax with 0 ≤ a ≤ 1: short normals are proximal subgradients",
            lambda s, r, D, a, d: (
                [r >= 0, D >= 0, a >= 0, a <= s, d == z3.If(r < 1, 1 - r, 0)],
                d >= -a * (r * r - 1 - D) / 2 - D,
            ),
            "0 ≤ a ≤ 2",
            2,
        ),
        implication(
            "for a > 1 and for a < 0 no constant k serves: on the ray of x, at y = (1 − u)x and (1 + u)x",
            lambda s, a, k, u: (
                [k > 0, u > 0, u < 1, s * u * k < z3.If(a > 1, a - 1, -a), z3.Or(a > 1, a < 0)],
                z3.If(a > 1, u - a * u + k * u * u < 0, a * u + k * u * u < 0),
            ),
            "larger u",
            0.25,
        ),
        implication(
            "nor for a tangential part c: on the circle, at y = ((1 − w²)x + 2w x⊥)/(1 + w²), where v·(y − x) = "
            "2w(c + aw)/(1 + w²)",
            lambda s, a, c, k, w: (
                [k > 0, c > 0, a >= 0, w > 0, s * 2 * k * w < c],
                2 * w * (c + a * w) > k * 4 * w * w,
            ),
            "larger w",
            0.25,
        ),
    )


@claim(
    "c1.sum-of-cones",
    "The support function of a sum of cones cut by a ball is the sum of those of the cut cones.",
    source="proof of Corollary 1.30",
    quote="lim sup σ(-Σ N(S_j, p_j) ∩ B₁, w) = lim sup Σ σ(-N(S_j, p_j) ∩ B₁, w) ≤ … = σ(-Σ N(S_j, x) ∩ B₁, w)",
    correction=Correction(
        ("Σ_j (N(S_j, x) ∩ B₁) ⊆ N(S, x) ∩ B_M; the corollary itself holds if the ball cuts the sum of the cones"),
        Effect.PROOF,
        "Lemma 2.8, which needs only some radius",
        why=(
            "(1.31) is about sums of sets: if the ball cuts each cone, the last set is not N(S, x) ∩ B₁, and if "
            "it cuts the sum, the first equality is none"
        ),
        place=816,
    ),
    rests_on=("c1.additive",),
    tried_on="two pairs of touching discs",
)
def _sum_of_cones() -> Evidence:
    """Two touching pairs of discs far apart, with normals orthogonal in R^8; p_j = x, w along -(n_1 + n_2)."""
    far = np.array([[0.0, 0.0], [1.0, 0.0], [9.0, 0.0], [10.0, 0.0]])
    rows = contact_gradients(far, [(0, 1), (2, 3)]) / math.sqrt(2)
    w = rows.sum(axis=0) / math.sqrt(2)
    ratio = sum(support_of_cone(row[None], w) for row in rows) / support_of_cone(rows, w)
    directions = np.random.default_rng(SEED).normal(size=(SAMPLES, 8))
    bound = max(sum(support_of_cone(row[None], u) for row in rows) - 2 * support_of_cone(rows, u) for u in directions)
    return Evidence(
        printed=(equal("Σ σ(-N_j ∩ B₁, w) over σ((Σ -N_j) ∩ B₁, w)", ratio, 1.0, 1e-9),),
        corrected=(at_most(f"largest Σ σ(-N_j ∩ B₁, w) - σ(-N ∩ B_M, w), {SAMPLES} directions w", bound, 0.0, 1e-6),),
        seed=SEED,
    )
