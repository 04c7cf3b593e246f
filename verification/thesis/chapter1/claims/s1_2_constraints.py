"""Chapter 1, sections 1.2 and 1.3: discs with multipliers, energies, and the two forms of the model."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_least, claim, equal, proved
from verification.formal.algebra import library
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter1.lemmas import cones
from verification.thesis.chapter1.sets import ROUNDING, SAMPLES, Floats

SEED = 14
# Points of the edge of the unit disc, and what the largest product with them may lack.
EDGE = np.stack([f(np.linspace(0, 2 * np.pi, 720, endpoint=False)) for f in (np.cos, np.sin)], axis=1)
BLIND = 1e-4
# How far two discs are moved along a vector, in diameters.
FAR = 1e4


@claim(
    "c1.multipliers",
    "Discs in contact are pushed apart along the gradients of their distances, with multipliers ≥ 0.",
    source="(1.4), (1.5)",
    quote="Ẋ_i = F_i(X) + Σ λ_k ∇_{X_i} g_k(X), g_k ≥ 0, λ_k ≥ 0 and λ_k g_k = 0",
    recorded=Verdict.PROVED_INSTANCE,
    tried_on="three touching discs, every force",
)
def _multipliers() -> Evidence:
    """S = G G^T has 2 on its diagonal and 1/2 beside it; q = G F. For each set A of rows with a force lambda_A solves
    S_AA lambda_A = -q_A; p = (v - F).(w - v), D = |w - v|^2, n = |F - v|^2 for an admissible w.
    """
    z3, sp = solver_library(), library()
    S, q = sp.Rational(3, 2) * sp.eye(3) + sp.ones(3, 3) / 2, sp.Matrix(sp.symbols("q:3"))

    def fits(rows: tuple[int, ...], numbers: Any, s: Any) -> Any:
        level = sp.zeros(3, 1)
        for k, value in zip(rows, -s * S.extract(rows, rows).inv() * q.extract(rows, [0]), strict=True):
            level[k] = value
        found = [level[k] for k in rows] + [(q + S * level)[k] for k in range(3) if k not in rows]
        return z3.And([sp.lambdify(list(q), each * 720)(*numbers) >= 0 for each in found])

    return proved(
        implication(
            "for every force there are λ ≥ 0 with GF + GGᵀλ ≥ 0 and λ·(GF + GGᵀλ) = 0",
            lambda s, a, b, c: (
                [],
                z3.Or([fits(rows, (a, b, c), s) for size in range(4) for rows in combinations(range(3), size)]),
            ),
            "with −λ",
        ),
        implication(
            "v = F + Σλ∇g is then the nearest admissible velocity: |F − w|² = |F − v|² + 2λ·Gw + |w − v|² ≥ |F − v|²",
            lambda s, n, p, D, far: ([D >= 0, p >= 0, n >= 0, far == n + s * 2 * p + D], far >= n),
            "−2λ·Gw",
        ),
    )


@claim(
    "c1.penalty-force",
    "A force that is large enough pushes a point out of S against the energy n dist(x, S).",
    source="(1.7), (1.8)",
    quote="but if F is large enough, it could push x into the unfeasible region.",
    recorded=Verdict.PROVED,
    chosen="a closed S, outside where the nearest point is unique; “large enough” is e·F > n, e away from that point",
)
def _penalty() -> Evidence:
    """Outside of S grad dist(x, S) = e, the unit vector from the nearest point to x; f = e.F, q = e.e = 1, v = e.x'."""
    return proved(
        implication(
            "outside S the distance to S changes by e·(F − ne) = e·F − n: it falls for e·F < n and grows for e·F > n",
            lambda s, f, n, q, v: (
                [n > 0, q == 1, v == f - s * n * q],
                [solver_library().Implies(f < n, v < 0), solver_library().Implies(f > n, v > 0)],
            ),
            "the penalty pushes outwards",
        )
    )


@claim(
    "c1.indicator",
    "As n grows, n dist(x, S) tends to the indicator function of S.",
    source="section 1.3",
    quote="W(x) := lim sup W_n(x) = I_S(x) = ∞ if x ∉ S, 0 if x ∈ S",
    recorded=Verdict.PROVED,
)
def _indicator() -> Evidence:
    """d = dist(x, S), which is positive outside of the closed S; K is any bound."""
    return proved(
        implication("n dist(x, S) = 0 for x ∈ S", lambda s, n, d: ([d == 0], n * d + (1 - s) == 0), "positive in S"),
        implication(
            "n dist(x, S) ≥ K for x ∉ S and all n ≥ K/dist(x, S)",
            lambda s, n, d, K, least: ([d > 0, K > 0, least * d == K, n >= s * least], n * d >= K),
            "all n ≥ K/(2 dist(x, S))",
            0.5,
        ),
    )


@claim(
    "c1.subdifferential",
    "∂I_[0, 1] is {0} inside, a half-line at each end, ∅ outside.",
    source="after (1.9)",
    quote="∂W(x) = {0} if x ∈ (0, 1), ∅ if x < 0 or x > 1, (-∞, 0] if x = 0, [0, ∞) if x = 1",
    recorded=Verdict.PROVED,
)
def _subdifferential() -> Evidence:
    """v is a slope at x if W(y) - W(x) >= v (y - x) for all y, where W is 0 in [0, 1] and infinite outside."""
    z3 = solver_library()
    return proved(
        implication(
            "v ≤ 0 has v(y − 0) ≤ 0 for all y ∈ [0, 1], and v ≥ 0 has v(y − 1) ≤ 0",
            lambda s, v, y: (
                [y >= 0, y <= 1],
                [z3.Implies(s * v <= 0, v * y <= 0), z3.Implies(s * v >= 0, v * (y - 1) <= 0)],
            ),
            "−v",
        ),
        implication(
            "v(y − x) ≤ 0 at y = 0 and y = 1 gives v ≤ 0 at x = 0, v ≥ 0 at x = 1, and v = 0 between",
            lambda s, v, x: (
                [x >= 0, x <= 1, s * v * x >= 0, v * (1 - x) <= 0],
                [z3.Implies(x == 0, v <= 0), z3.Implies(x == 1, v >= 0), z3.Implies(z3.And(x > 0, x < 1), v == 0)],
            ),
            "≥ 0 at y = 0",
        ),
        implication(
            "W(0) − W(x) < v(0 − x) if W(x) > vx, so no v is a slope where W(x) = ∞",
            lambda s, v, x, W: ([s * v * x < W], v * (0 - x) > 0 - W),
            "W(x) > −vx",
        ),
    )


def inside(y: Floats) -> Floats:
    """Return the projection onto the unit disc."""
    return np.asarray(y / max(float(np.linalg.norm(y)), 1.0))


def subgradient(v: Floats, x: Floats) -> bool:
    """Say whether v is a subgradient (1.9) of the indicator function of the unit disc, x in it."""
    return bool(((EDGE - x) @ v).max() <= BLIND)


def proximal(v: Floats, x: Floats) -> bool:
    """Whether x = P_S(x + v/2)."""
    return bool(np.abs(inside(x + v / 2) - x).max() <= ROUNDING)


@claim(
    "c1.outward-normals",
    "The subdifferential of the indicator function of a set is its normal cone.",
    source="before Model 1.3",
    quote="∂W(x) is the set of all outward pointing normal vectors of S, e.g. ∂W(x) = ∂I_S(x) = N(S, x)",
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
    tried_on="the unit disc, and two touching discs",
)
def _outward() -> Evidence:
    """Random unit vectors and the outward ones at points of the disc, and the normal of two discs in contact."""
    rng = np.random.default_rng(SEED)
    places = [inside(y) for y in rng.normal(size=(SAMPLES, 2))]
    vectors = [w / np.linalg.norm(w) for w in (*rng.normal(size=(SAMPLES, 2)), *places)]
    found = [(subgradient(v, x), proximal(v, x)) for v, x in zip(vectors, places * 2, strict=True)]
    unlike, both = sum(a != b for a, b in found), sum(a and b for a, b in found)
    touching = np.array([[-0.5, 0.0], [0.5, 0.0]])
    missed = float(np.linalg.norm(np.diff(touching - FAR * touching, axis=0)) >= 1)
    return Evidence(
        printed=(equal("normals of two touching discs that (1.9) misses, as S goes on behind them", missed, 0),),
        corrected=(
            equal(f"unit vectors in only one of ∂I_S(x) and N(S, x), of {2 * SAMPLES}, S a disc", unlike, 0),
            at_least("those in both", both, SAMPLES // 10),
        ),
        seed=SEED,
    )


@claim(
    "c1.equivalent",
    "The inclusion with the normal cone and the equations with multipliers have the same solutions.",
    source="section 1.3; Theorem 1.25; Corollary 1.30, (1.35)",
    also=("c1.cones", "c1.sum-of-all", "c1.sum-limit"),
    quote="we will see that this model is equivalent to (1.4) and (1.5).",
    recorded=Verdict.PROVED_INSTANCE,
    tried_on="states whose contacts have independent gradients",
)
def _equivalent() -> Evidence:
    """Both right sides are equal where N = N^g: (1.10) is F - N, (1.4), (1.5) is F + sum lambda grad g."""
    return proved(*cones())
