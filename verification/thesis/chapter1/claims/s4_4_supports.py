"""Chapter 1, section 4.4: support functions, scalar semicontinuity of normals, and cones of discs."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument, implication

z3 = solver_library()
a, b, c, p, q, bound = reals("a b c p q bound")

_support = implication(
    "c1.support",
    "(1.30)",
    "A ⊆ B ⟺ σ(A, v) ≤ σ(B, v) for all v",
    "A set A lies in B if and only if σ(A, ·) ≤ σ(B, ·).",
    given=[a <= b, p <= b, -p <= -a],
    then=[a <= p, p <= b],
    wrong=z3.Or(p == a, p == b),
    correction=Correction(
        "“⇐” holds if B is closed and convex",
        Effect.PROOF,
        "(1.73), where B is closed and convex",
        why="support functions do not tell a set from its closed convex hull: {0, 1} and [0, 1] have the same one",
        place=759,
    ),
    chosen="sets of the line: σ(B, 1) = b and σ(B, −1) = −a for B = [a, b], and for B = {a, b}, which is not convex",
)

# Values p of A and q of B in one direction, with least upper bounds a and b; c is any upper bound of the sums.
_additive = argument(
    "c1.additive",
    "(1.31)",
    "σ(A + B, v) = σ(A, v) + σ(B, v)",
    "The support function of a sum of sets is the sum of theirs.",
    follows(
        [p <= a, q <= b],
        p + q <= a + b,
        p + q <= a - b,
        "σ(A, v) + σ(B, v) is an upper bound of the sums",
        "σ(A, v) − σ(B, v)",
    ),
    follows(
        [p + q <= c, bound == c - q, a <= c - q],
        [p <= bound, q <= c - a],
        ([p + q <= c, bound == c + q, a <= c - q], p <= bound),
        "of an upper bound c of the sums p ≤ c − q for all p ∈ A, so a ≤ c − q; then q ≤ c − a for all q ∈ B",
        "p ≤ c + q",
    ),
    follows(
        [b <= c - a],
        a + b <= c,
        a + 2 * b <= c,
        "so b ≤ c − a: σ(A, v) + σ(B, v) ≤ c is the least",
        "σ(A, v) + 2σ(B, v) ≤ c",
    ),
)

# f and here are the values at a place near x0 and at x0, z is a point of (-oo, f].
f, here, e, z = reals("f here e z")
NEAR = [e > 0, f < here + e]

_single_valued = implication(
    "c1.single-valued",
    "after Definition 1.27",
    "f is upper semicontinuous at x₀ if it satisfies Definition 1.10, which simplifies to lim sup f(x) ≤ f(x₀)",
    "For a single-valued function Definition 1.10 is lim sup f(x) ≤ f(x₀).",
    given=[*NEAR, z <= f],
    then=z < here + e,
    wrong=(NEAR, [f - here < e, here - f < e]),
    correction=Correction(
        "for {f(x)} Definition 1.10 is continuity; upper semicontinuity is Definition 1.10 for (-∞, f(x)]",
        Effect.PROOF,
        "nothing else: (1.33) is stated explicitly",
        why="for F(x) = {f(x)} Definition 1.10 asks for |f(y) − f(x)| < ε, which is continuity",
        place=782,
    ),
)

# v_n in N(S, x_n), |v_n| <= 1, tend to v (a subsequence, the ball being compact) and x_n to x. v_n.(y - x_n) and
# |v_n||y - x_n|^2/(2 eta) come within any e > 0 of p and K of the limit; e = (p - K)/3 is tried.
K = reals("K L")[0]
LIMIT = z3.Implies(e > 0, p <= K + 2 * e)

_scalarly_upper = argument(
    "c1.scalarly-upper",
    "Proposition 1.28",
    "lim sup σ(-N(S, x_n) ∩ B₁(0), w) ≤ σ(-N(S, x) ∩ B₁(0), w)",
    "The normals of length at most 1 of the set of discs are scalarly upper semicontinuous.",
    follows(
        [3 * e == p - K, LIMIT],
        p <= K,
        ([3 * e == K - p, LIMIT], p <= K),
        "v_n·(y − x_n) ≤ ‖v_n‖‖y − x_n‖²/(2η) for all y ∈ S holds in the limit: v ∈ N(S, x), and ‖v‖ ≤ 1, so no "
        "sequence has a larger σ in the limit, for any uniformly prox-regular S",
        "e = (K − p)/3",
    ),
    rests_on=("c1.hypomonotone",),
)

# v = -a x for a boundary point x: r = |y|, D = |y - x|^2, x.(y - x) = (r^2 - 1 - D)/2; k is any constant.
r, D, d, k, u, w = reals("r D d k u w")
OUTER = [r >= 0, D >= 0, a >= 0, d == z3.If(r < 1, 1 - r, 0)]
FAR = z3.If(a > 1, u - a * u + k * u * u < 0, a * u + k * u * u < 0)
RAY = [k > 0, u > 0, u < 1, z3.Or(a > 1, a < 0)]
SIDE = [k > 0, c > 0, a >= 0, w > 0]

_distance = argument(
    "c1.distance",
    "Remark 1.29",
    "N(S, x) ∩ B₁(0) = ∂dist(x, S)",
    "The normals of length at most 1 are the subdifferential of the distance.",
    follows(
        [*OUTER, a <= 1],
        d >= -a * (r * r - 1 - D) / 2 - D,
        ([*OUTER, a <= 2], d >= -a * (r * r - 1 - D) / 2 - D),
        "dist(y) ≥ v·(y − x) − |y − x|² for v = −ax with 0 ≤ a ≤ 1: short normals are proximal subgradients",
        "0 ≤ a ≤ 2",
    ),
    follows(
        [*RAY, u * k < z3.If(a > 1, a - 1, -a)],
        FAR,
        ([*RAY, 0.25 * u * k < z3.If(a > 1, a - 1, -a)], FAR),
        "for a > 1 and for a < 0 no constant k serves: on the ray of x, at y = (1 − u)x and (1 + u)x",
        "larger u",
    ),
    follows(
        [*SIDE, 2 * k * w < c],
        2 * w * (c + a * w) > k * 4 * w * w,
        ([*SIDE, 0.5 * k * w < c], 2 * w * (c + a * w) > k * 4 * w * w),
        "nor for a tangential part c: on the circle, at y = ((1 − w²)x + 2w x⊥)/(1 + w²), where v·(y − x) = 2w(c + "
        "aw)/(1 + w²)",
        "larger w",
    ),
    tried_on="the outside of the unit disc, every point of its boundary",
    chosen="the outside of the unit disc, x on its boundary; the ball is closed (see the errata)",
)

_sum_of_cones = implication(
    "c1.sum-of-cones",
    "proof of Corollary 1.30",
    "lim sup σ(-Σ N(S_j, p_j) ∩ B₁, w) = lim sup Σ σ(-N(S_j, p_j) ∩ B₁, w) ≤ … = σ(-Σ N(S_j, x) ∩ B₁, w)",
    "The support function of a sum of cones cut by a ball is the sum of those of the cut cones.",
    given=[a >= 0, a <= 1, b >= 0, b <= 1],
    then=a * a + b * b <= 2,
    wrong=a * a + b * b <= 1,
    correction=Correction(
        "Σ_j (N(S_j, x) ∩ B₁) ⊆ N(S, x) ∩ B_M; the corollary itself holds if the ball cuts the sum of the cones",
        Effect.PROOF,
        "Lemma 2.8, which needs only some radius",
        why=(
            "(1.31) is about sums of sets: if the ball cuts each cone, the last set is not N(S, x) ∩ B₁, and if it "
            "cuts the sum, the first equality is none"
        ),
        place=816,
    ),
    rests_on=("c1.additive",),
    chosen="two pairs of touching discs far apart, with orthogonal normals of length a and b; M² = 2",
)
