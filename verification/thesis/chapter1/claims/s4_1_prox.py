"""Chapter 1, sections 4 and 4.1: sets that are not convex, prox-regularity, proximal normals."""

from __future__ import annotations

import math

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.algebra import library
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter1.lemmas import NEAREST
from verification.thesis.chapter1.sets import ROUNDING, contact_gradients

sp = library()
R, w, a, r = sp.symbols("R w a r", positive=True)
p, k, D, t, u, v = reals("p k D t u v")

SEED = 11
RADIUS = 0.5

# Centres at -e and e, exchanged, and half-way between: any radius and direction.
e = R * sp.Matrix([sp.cos(w), sp.sin(w)])
# Squares of the distances of the centres of both, and of half the sum of both states.
TOUCHING, MIDDLE = (2 * e).dot(2 * e), (e - e).dot(e - e)

_not_convex = identity(
    "c1.not-convex",
    "section 4",
    "the set of non-overlapping disks … is not convex.",
    "Two touching discs and the same exchanged have the distance 2R, half-way the centres coincide: S is not convex.",
    right=[TOUCHING - 4 * R**2, MIDDLE],
    wrong=TOUCHING,
)

# (a, 0) in a mouth of half the angle w < pi/2, and the point of a lip at r from the corner.
LIP = (a - r * sp.cos(w)) ** 2 + (r * sp.sin(w)) ** 2 - (r - a * sp.cos(w)) ** 2

_pacman = identity(
    "c1.pacman",
    "Figure 7",
    "The Pacman-like set is not uniformly prox-regular since for points in the middle of the mouth … not unique.",
    "On both lips of the Pacman set the point at a cos w is nearest to (a, 0) in its mouth, as near as one likes.",
    right=LIP - (a * sp.sin(w)) ** 2,
    wrong=LIP + (a * sp.sin(w)) ** 2,
)


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


# p = n.(y - x), D = |y - x|^2 for y in C; n is proximal if p <= k D for a k >= 0; x + t(y - x) is in C.
SHORT = [k > 0, D > 0, t * p <= k * t * t * D, t * t <= 1]

_same_cones = argument(
    "c1.same-cones",
    "after Definition 1.23",
    "N_C(x) = N(C, x) for all x ∈ ℝ^d",
    "The proximal normals of a convex set are its normals of convex analysis.",
    follows(
        [*SHORT, t * (p + k * D) == p],
        p <= 0,
        ([*SHORT, t * (-p + k * D) == p], p <= 0),
        "t n·(y − x) ≤ k t²|y − x|² for t = p/(p + kD) ∈ (0, 1] gives n·(y − x) ≤ 0: proximal normals are normals",
        "t of the wrong sign",
    ),
    follows(
        [D >= 0, p <= 0],
        D - 2 * p >= 0,
        D + 2 * p >= 0,
        "n·(y − x) ≤ 0 gives |x + n − y|² ≥ |n|²: x is the nearest point of C to x + n",
        "to x − n",
    ),
    rests_on=("c1.outside",),
    chosen="x ∈ C, or N_C(x) = ∅ outside C, as is said after Definition 1.16",
)

# A is the outside of the unit disc, x = (0, 1), n = -x; (u, v) is a point of A.
NOT_NEARER = u * u + (v - 0.5) * (v - 0.5) >= 0.25

_not_a_convex_normal = argument(
    "c1.nonconvex-normal",
    "Figure 8",
    "n would not be a normal vector according to Definition 1.16 since n·(y - x) > 0.",
    "A proximal normal of a set that is not convex need not be a normal of Definition 1.16.",
    follows(
        [u * u + v * v >= 1],
        NOT_NEARER,
        ([u * u + v * v >= 0.25], NOT_NEARER),
        "x is nearest in A to x + n/2 = (0, ½), so n is a proximal normal",
        "A the outside of a disc with the radius ½",
    ),
    follows(
        [v == -1.5, p == -(v - 1)],
        p > 0,
        ([v == -1.5, p == v - 1], p > 0),
        "but n·(y − x) = 5/2 > 0 for y = (0, −3/2) ∈ A",
        "n = x",
    ),
    chosen="the outside of the unit disc",
)

_projection_normal = argument(
    "c1.projection-normal",
    "(1.23); after (1.39); (1.66)",
    "x = P_S(y) ⟺ P_S(x + (y - x)) = x ⟹ y - x ∈ N(S, x)",
    "The difference of y and its projection is a proximal normal; so is x_k + hF(x_k) − x_{k+1} in a step of catch-up.",
    NEAREST,
    also=("c1.catch-up-normal", "c1.step-inclusion"),
)
