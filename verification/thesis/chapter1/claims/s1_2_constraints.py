"""Chapter 1, sections 1.2 and 1.3: discs with multipliers, energies, and the two forms of the model."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument, implication
from verification.thesis.chapter1.lemmas import CONES
from verification.thesis.chapter1.sets import ROUNDING, Floats

z3 = solver_library()

# Outside of S grad dist(x, S) = e, the unit vector from the nearest point to x; f = e.F, q = e.e = 1, v = e.x'.
f, n, q, v = reals("f n q v")
BOTH = [z3.Implies(f < n, v < 0), z3.Implies(f > n, v > 0)]

_penalty = implication(
    "c1.penalty-force",
    "(1.7), (1.8)",
    "but if F is large enough, it could push x into the unfeasible region.",
    "A force that is large enough pushes a point out of S against the energy n dist(x, S).",
    given=[n > 0, q == 1, v == f - n * q],
    then=BOTH,
    wrong=([n > 0, q == 1, v == f + n * q], BOTH),
    chosen="a closed S, outside where the nearest point is unique; “large enough” is e·F > n, e away from that point",
)

# d = dist(x, S), which is positive outside of the closed S; K is any bound.
d, K, least = reals("d K least")
OUTSIDE = [d > 0, K > 0, least * d == K]

_indicator = argument(
    "c1.indicator",
    "section 1.3",
    "W(x) := lim sup W_n(x) = I_S(x) = ∞ if x ∉ S, 0 if x ∈ S",
    "As n grows, n dist(x, S) tends to the indicator function of S.",
    follows([d == 0], n * d == 0, n * d + 1 == 0, "n dist(x, S) = 0 for x ∈ S", "positive in S"),
    follows(
        [*OUTSIDE, n >= least],
        n * d >= K,
        ([*OUTSIDE, n >= 0.5 * least], n * d >= K),
        "n dist(x, S) ≥ K for x ∉ S and all n ≥ K/dist(x, S)",
        "all n ≥ K/(2 dist(x, S))",
    ),
)

# v is a slope at x if W(y) - W(x) >= v (y - x) for all y, where W is 0 in [0, 1] and infinite outside.
x, y, W = reals("x y W")
SLOPES = [z3.Implies(x == 0, v <= 0), z3.Implies(x == 1, v >= 0), z3.Implies(z3.And(x > 0, x < 1), v == 0)]

_subdifferential = argument(
    "c1.subdifferential",
    "after (1.9)",
    "∂W(x) = {0} if x ∈ (0, 1), ∅ if x < 0 or x > 1, (-∞, 0] if x = 0, [0, ∞) if x = 1",
    "∂I_[0, 1] is {0} inside, a half-line at each end, ∅ outside.",
    follows(
        [y >= 0, y <= 1],
        [z3.Implies(v <= 0, v * y <= 0), z3.Implies(v >= 0, v * (y - 1) <= 0)],
        [z3.Implies(-v <= 0, v * y <= 0), z3.Implies(-v >= 0, v * (y - 1) <= 0)],
        "v ≤ 0 has v(y − 0) ≤ 0 for all y ∈ [0, 1], and v ≥ 0 has v(y − 1) ≤ 0",
        "−v",
    ),
    follows(
        [x >= 0, x <= 1, v * x >= 0, v * (1 - x) <= 0],
        SLOPES,
        ([x >= 0, x <= 1, -v * x >= 0, v * (1 - x) <= 0], SLOPES),
        "v(y − x) ≤ 0 at y = 0 and y = 1 gives v ≤ 0 at x = 0, v ≥ 0 at x = 1, and v = 0 between",
        "≥ 0 at y = 0",
    ),
    follows(
        [v * x < W],
        v * (0 - x) > 0 - W,
        ([-v * x < W], v * (0 - x) > 0 - W),
        "W(0) − W(x) < v(0 − x) if W(x) > vx, so no v is a slope where W(x) = ∞",
        "W(x) > −vx",
    ),
)


def inside(y: Floats) -> Floats:
    """Return the projection onto the unit disc."""
    return np.asarray(y / max(float(np.linalg.norm(y)), 1.0))


def proximal(v: Floats, x: Floats) -> bool:
    """Whether x = P_S(x + v/2)."""
    return bool(np.abs(inside(x + v / 2) - x).max() <= ROUNDING)


_outward = implication(
    "c1.outward-normals",
    "before Model 1.3",
    "∂W(x) is the set of all outward pointing normal vectors of S, e.g. ∂W(x) = ∂I_S(x) = N(S, x)",
    "The subdifferential of the indicator function of a set is its normal cone.",
    given=[v > 0, y * y >= 1],
    then=-v * (y - 1) <= v / 2 * (y - 1) * (y - 1),
    wrong=-v * (y - 1) <= 0,
    correction=Correction(
        "for convex S; otherwise ∂ is the proximal subdifferential, which (1.9) is not",
        Effect.PROOF,
        "the step to Model 1.3, which stands with N(S, x) of Definition 1.23",
        why=(
            "(1.9) bounds W from below at all y, and behind a touching disc there are feasible y again: at two "
            "touching discs (1.9) gives {0}, the cone has a normal"
        ),
        place=359,
    ),
    chosen="two discs on a line at the distance y, which may pass each other: S = {y² ≥ 1}, and the normal −a at y = 1",
)

_equivalent = argument(
    "c1.equivalent",
    "section 1.3; Theorem 1.25; Corollary 1.30, (1.35); (1.4), (1.5)",
    "we will see that this model is equivalent to (1.4) and (1.5).",
    "The inclusion with the normal cone and the equations with multipliers have the same solutions.",
    *CONES,
    also=("c1.cones", "c1.sum-of-all", "c1.sum-limit", "c1.multipliers"),
    tried_on="states whose contacts have independent gradients",
)
