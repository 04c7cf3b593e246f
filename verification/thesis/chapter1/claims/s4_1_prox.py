"""Chapter 1, sections 4 and 4.1: sets that are not convex, prox-regularity, proximal normals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_least, at_most, claim, equal, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter1.lemmas import nearest
from verification.thesis.chapter1.sets import ROUNDING, contact_gradients

SEED = 11
RADIUS = 0.5


@claim(
    "c1.not-convex",
    "The set of discs that do not overlap is not convex.",
    source="section 4",
    quote="the set of non-overlapping disks … is not convex.",
    recorded=Verdict.PROVED,
)
def _not_convex() -> Evidence:
    """Centres at -R e and R e, exchanged, and half-way between: any radius and direction."""
    sp = library()
    R, w = sp.symbols("R w", positive=True)
    e = R * sp.Matrix([sp.cos(w), sp.sin(w)])
    first, other = (-e, e), (e, -e)
    between = [(a + b) / 2 for a, b in zip(first, other, strict=True)]

    def square(pair: Any) -> Any:
        return (pair[0] - pair[1]).dot(pair[0] - pair[1])

    return proved(
        identity(
            "two touching discs and the same with places exchanged have the distance 2R, half-way the centres coincide",
            lambda s: [square(first) - s * 4 * R**2, square(other) - 4 * R**2, square(between)],
            "no distance",
            0,
        )
    )


@claim(
    "c1.pacman",
    "The Pacman set is not uniformly prox-regular.",
    source="Figure 7",
    quote=(
        "The Pacman-like set is not uniformly prox-regular since for points in the middle of the mouth … not unique."
    ),
    recorded=Verdict.PROVED,
)
def _pacman() -> Evidence:
    """(s, 0) in a mouth of half the angle w < pi/2, and the point of a lip at r from the corner."""
    sp = library()
    a, r, w = sp.symbols("a r w", positive=True)
    square = (a - r * sp.cos(w)) ** 2 + (r * sp.sin(w)) ** 2
    return proved(
        identity(
            "|(a, 0) − r(cos w, ± sin w)|² = (r − a cos w)² + a² sin²w: on both lips the point at r = a cos w is "
            "nearest, at the distance a sin w, as small as one likes",
            lambda s: square - (r - a * sp.cos(w)) ** 2 - s * (a * sp.sin(w)) ** 2,
            "−a² sin²w",
        )
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
            "sin(2π/N) is 0 for N = 1 and N = 2, and Definition 1.21 asks for η > 0; two discs are √2 "
            "R-prox-regular, as their projection is unique until the centres meet"
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


@claim(
    "c1.same-cones",
    "The proximal normals of a convex set are its normals of convex analysis.",
    source="after Definition 1.23",
    quote="N_C(x) = N(C, x) for all x ∈ ℝ^d",
    recorded=Verdict.PROVED,
    rests_on=("c1.outside",),
    chosen="x ∈ C, or N_C(x) = ∅ outside C, as is said after Definition 1.16",
)
def _same_cones() -> Evidence:
    """p = n.(y - x), D = |y - x|^2 for y in C; n is proximal if p <= k D for a k >= 0; x + t(y - x) is in C."""
    return proved(
        implication(
            "t n·(y − x) ≤ k t²|y − x|² for t = p/(p + kD) ∈ (0, 1] gives n·(y − x) ≤ 0: proximal normals are normals",
            lambda s, p, k, D, t: (
                [k > 0, D > 0, t * (s * p + k * D) == p, t * p <= k * t * t * D, t * t <= 1],
                p <= 0,
            ),
            "t of the wrong sign",
        ),
        implication(
            "n·(y − x) ≤ 0 gives |x + n − y|² ≥ |n|²: x is the nearest point of C to x + n",
            lambda s, p, D: ([D >= 0, p <= 0], D - s * 2 * p >= 0),
            "to x − n",
        ),
    )


@claim(
    "c1.nonconvex-normal",
    "A proximal normal of a set that is not convex need not be a normal of Definition 1.16.",
    source="Figure 8",
    quote="n would not be a normal vector according to Definition 1.16 since n·(y - x) > 0.",
    recorded=Verdict.PROVED,
    chosen="the outside of the unit disc",
)
def _not_a_convex_normal() -> Evidence:
    """A is the outside of the unit disc, x = (0, 1), n = -x; (u, v) is a point of A."""
    return proved(
        implication(
            "x is nearest in A to x + n/2 = (0, ½), so n is a proximal normal",
            lambda s, u, v: ([u * u + v * v >= s], u * u + (v - 0.5) * (v - 0.5) >= 0.25),
            "A the outside of a disc with the radius ½",
            0.25,
        ),
        implication(
            "but n·(y − x) = 5/2 > 0 for y = (0, −3/2) ∈ A",
            lambda s, v, p: ([v == -1.5, p == -s * (v - 1)], p > 0),
            "n = x",
        ),
    )


@claim(
    "c1.projection-normal",
    "The difference of y and its projection is a proximal normal.",
    source="(1.23)",
    quote="x = P_S(y) ⟺ P_S(x + (y - x)) = x ⟹ y - x ∈ N(S, x)",
    recorded=Verdict.PROVED,
)
def _projection_normal() -> Evidence:
    """|y - z|^2 = |y - x|^2 - 2 (y - x).(z - x) + |z - x|^2."""
    return proved(nearest())
