"""Chapter 1, sections 4 and 4.1: sets that are not convex, prox-regularity, proximal normals."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from typing import Any

import numpy as np

from verification.claims import Evidence, FormalProof, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter1.claims.s3_cones import SEED
from verification.thesis.chapter1.sets import contact_gradients
from verification.thesis.text.quoted import claim

ROUNDING = 1e-12
RADIUS = 0.5


@claim(
    "c1.not-convex",
    "Discs that do not overlap may overlap half-way between two arrangements.",
    "section 4",
    Verdict.PROVED,
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
    "c1.convex-projection",
    "Convex sets have one nearest point.",
    "after Definition 1.20",
    Verdict.PROVED,
)
def _convex_projection() -> Evidence:
    """The parallelogram law in each coordinate; p, q nearest at the distance r, e = |p - q|^2, m their middle."""
    return proved(
        identity(
            "|z − m|² = |z − p|²/2 + |z − q|²/2 − |p − q|²/4 for the middle m of p, q",
            lambda s, z, p, q: (z - (p + q) / 2) ** 2 - (z - p) ** 2 / 2 - (z - q) ** 2 / 2 + s * (p - q) ** 2 / 4,
            "+|p − q|²/4",
        ),
        implication(
            "m ∈ C is no nearer than p and q, so p = q",
            lambda s, r2, e, m2: ([e >= 0, r2 >= 0, m2 == r2 - s * e / 4, m2 >= r2], e == 0),
            "+|p − q|²/4",
        ),
    )


@claim(
    "c1.pacman",
    "A disc with a mouth has points with two nearest points, as near to it as one likes.",
    "Figure 7",
    Verdict.PROVED,
)
def _pacman() -> Evidence:
    """(s, 0) in a mouth of half the angle w < pi/2, and the point of a lip at r from the corner."""
    sp = library()
    a, r, w = sp.symbols("a r w", positive=True)
    square = (a - r * sp.cos(w)) ** 2 + (r * sp.sin(w)) ** 2
    return proved(
        identity(
            "|(a, 0) − r(cos w, ± sin w)|² = (r − a cos w)² + a² sin²w: on both lips the point at r = a cos w is "
            "nearest, "
            "at the distance a sin w, as small as one likes",
            lambda s: square - (r - a * sp.cos(w)) ** 2 - s * (a * sp.sin(w)) ** 2,
            "−a² sin²w",
        )
    )


def printed_constant(n: int, d: int) -> float:
    """η of Proposition 1.22."""
    return RADIUS / (6 * n) * (math.sin(2 * math.pi / n) / 3) ** d


def safe_constant(n: int) -> float:
    """The η of the correction, for discs of radius RADIUS."""
    return RADIUS * math.sqrt(2 / (2 * n - 3))


def bent_rows(n: int) -> float:
    """The largest 2η n·(y - x)/(‖n‖ ‖y - x‖²), at most 1 by (1.28): x a row of touching discs, y the row bent."""
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
    "The constant of prox-regularity of N discs.",
    "Proposition 1.22",
    Verdict.CORRECTED,
    tried_on="N = 2 to 199, d = 1, 2, 3; bent rows of 2 to 9 discs",
)
def _prox_constant() -> Evidence:
    """Two discs: the projection is unique unless the centres coincide, at distance sqrt(2) R from S."""
    tried = [(printed_constant(n, d), safe_constant(n)) for n in range(3, 200) for d in (1, 2, 3)]
    largest, bent = max(p / q for p, q in tried), max(bent_rows(n) for n in range(2, 10))
    two, safe, exact = printed_constant(2, 2), safe_constant(2), math.sqrt(2) * RADIUS
    return Evidence(
        f"For N = 2 the formula has sin(π) = 0, so no η > 0 ({two:.0e}), though two discs of radius 1/2 have η = "
        f"√2 R = {exact:.3f}. For N = 3 to 199, d = 1, 2, 3 it is positive and at most {largest:.1e} "
        f"of η = R √(2/(2N - 3)), with which rows of 2 to 9 discs come to {bent:.4f} of (1.28).",
        printed=(at_least("η for N = 2 over √2 R", two / exact, ROUNDING),),
        corrected=(
            at_most("η as printed over the safe one, N ≥ 3", largest, 1.0),
            at_most("left over right side of (1.28), safe η, bent rows", bent, 1.0, 1e-9),
            at_least("η as printed over R, N ≥ 3", min(p for p, _ in tried) / RADIUS, 0.0, -1e-15),
            equal("safe η over √2 R, N = 2", safe / exact, 1.0, ROUNDING),
        ),
    )


@claim(
    "c1.same-cones",
    "For convex sets proximal normals are the normals of convex analysis.",
    "after Definition 1.23",
    Verdict.PROVED,
    chosen="x ∈ C, or N_C(x) = ∅ outside of C, as is said after Definition 1.16",
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
    "A proximal normal of a set that is not convex may point towards other points of the set.",
    "Figure 8",
    Verdict.PROVED,
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


def nearest() -> FormalProof:
    """Prove that x stays nearest along v = y - x: p = v.(z - x), D = |z - x|^2 for a point z of S."""
    return implication(
        "if |y − z| ≥ |y − x| for all z ∈ S, x is nearest to x + α(y − x), 0 ≤ α ≤ 1: y − x ∈ N(S, x)",
        lambda s, p, D, a: ([D >= 0, D - 2 * p >= 0, a >= 0, a <= 1], D - s * 2 * a * p >= 0),
        "for −1 ≤ α ≤ 0",
    )


@claim(
    "c1.projection-normal",
    "What a projection takes away is a proximal normal.",
    "(1.23)",
    Verdict.PROVED,
)
def _projection_normal() -> Evidence:
    """|y - z|^2 = |y - x|^2 - 2 (y - x).(z - x) + |z - x|^2."""
    return proved(nearest())
