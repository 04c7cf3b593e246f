"""Chapter 1, sections 4 to 4.4: prox-regular sets, hypomonotone normals, support functions."""

from __future__ import annotations

import math

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument, implication
from verification.thesis.chapter1.lemmas import NEAREST
from verification.thesis.chapter1.sets import ROUNDING, contact_gradients

p, v = reals("p v")

SEED = 11
RADIUS = 0.5


def printed_constant(n: int, d: int) -> float:
    """Return η of Proposition 1.22."""
    return RADIUS / (6 * n) * (math.sin(2 * math.pi / n) / 3) ** d


def safe_constant(n: int) -> float:
    """Return the η of the correction, for discs of radius RADIUS."""
    return RADIUS * math.sqrt(2 / (2 * n - 3))


def bent_rows(n: int) -> float:
    """Return the largest 2η n·(y - x)/(‖n‖ ‖y - x‖²), at most 1 by (1.28), x a row of touching discs, y bent."""
    rng = np.random.default_rng(SEED)
    along = np.arange(n)[:, None] * np.array([1.0, 0.0])
    gradients = contact_gradients(along, [(i, i + 1) for i in range(n - 1)])
    largest = 0.0
    for angles in (0.2 * rng.normal(size=(300, n - 1))).clip(-0.5, 0.5):
        joints = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        moved = np.vstack([np.zeros(2), np.cumsum(joints, axis=0)]) - along
        v, normal = (moved - moved.mean(axis=0)).ravel(), -rng.exponential(size=n - 1) @ gradients
        largest = max(largest, 2 * safe_constant(n) * float(normal @ v) / float(np.linalg.norm(normal) * (v @ v)))
    return largest


@claim(
    "c1.prox-constant",
    "The set of N discs is η-prox-regular with η = R/(6N) (sin(2π/N)/3)^d for all N.",
    source="Proposition 1.22",
    quote="S is η-prox-regular with η = R/(6N) (1/3 sin(2π/N))^d for N ∈ ℕ",
    correction=Correction(
        "the formula is for N ≥ 3; η = R √(2/(2N - 3)) holds for all N ≥ 2",
        Effect.NUMBER,
        "Theorem 1.31 and Corollary 1.33 for two discs, which need some η > 0",
        why=(
            "sin(2π/N) is 0 for N = 1 and N = 2, and Definition 1.21 asks for η > 0; two discs are √2 R-prox-regular, "
            "as their projection is unique until the centres meet"
        ),
        place=646,
    ),
    tried_on="N = 2 to 199, d = 1, 2, 3; bent rows of 2 to 9 discs",
)
def _prox_constant() -> Evidence:
    """Two discs: the projection is unique unless the centres coincide, at distance sqrt(2) R from S."""
    tried = [(printed_constant(n, d), safe_constant(n)) for n in range(3, 200) for d in (1, 2, 3)]
    two, safe, exact = printed_constant(2, 2), safe_constant(2), math.sqrt(2) * RADIUS
    largest, least = max(p / q for p, q in tried), min(p for p, _ in tried) / RADIUS
    bent = max(bent_rows(n) for n in range(2, 10))
    return Evidence(
        printed=(at_least("N = 2, d = 2: printed η over the exact √2 R", two / exact, ROUNDING),),
        corrected=(
            at_most("printed η over R √(2/(2N - 3)), N = 3 to 199, largest", largest, 1.0),
            at_most("left over right side of (1.28), η = R √(2/(2N - 3)), bent rows", bent, 1.0, 1e-9),
            at_least("printed η over R, N = 3 to 199, least", least, 0.0, -1e-15),
            equal("N = 2: R √(2/(2N - 3)) over √2 R", safe / exact, 1.0, ROUNDING),
        ),
    )


_projection_normal = argument(
    "c1.projection-normal",
    "(1.23); after (1.39); (1.66)",
    "x = P_S(y) ⟺ P_S(x + (y - x)) = x ⟹ y - x ∈ N(S, x)",
    "The difference of y and its projection is a proximal normal; so is x_k + hF(x_k) − x_{k+1} in a step of catch-up.",
    NEAREST,
    also=("c1.catch-up-normal", "c1.step-inclusion"),
)


# p = v.(y - x), q = w.(x - y), D = |x - y|^2, k = 1/(2 eta); c = p/|v|, square is |x + eta v/|v| - y|^2.
p, q, v, w, D, k, eta, c, square = reals("p q v w D k eta c square")

BALL = [eta > 0, v > 0, D >= 0, p == v * c, square >= eta * eta]

_hypomonotone = argument(
    "c1.hypomonotone",
    "(1.28)",
    "-(v - w)·(x - y) ≤ (‖v‖ + ‖w‖)/(2η) ‖x - y‖²",
    "Normals of prox-regular sets are monotone up to a quadratic term.",
    follows(
        [*BALL, square == D - 2 * eta * c + eta * eta],
        2 * eta * p <= v * D,
        ([*BALL, square == D + 2 * eta * c + eta * eta], 2 * eta * p <= v * D),
        "no point y of S is nearer to x + ηv/‖v‖ than x, so v·(y − x) ≤ ‖v‖‖x − y‖²/(2η)",
        "x − ηv/‖v‖",
    ),
    follows(
        [k > 0, v >= 0, w >= 0, D >= 0, p <= v * k * D, q <= w * k * D],
        p + q <= (v + w) * k * D,
        p + q <= (v - w) * k * D,
        "v·(y − x) ≤ ‖v‖‖x − y‖²/(2η) and w·(x − y) ≤ ‖w‖‖x − y‖²/(2η) sum to (1.28)",
        "‖v‖ − ‖w‖",
    ),
)


z3 = solver_library()
a, b, p = reals("a b p")

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
