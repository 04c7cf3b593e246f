"""Chapter 1, sections 4 and 4.1: sets that are not convex, prox-regularity, proximal normals."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter1.claims.s3_cones import SAMPLES, SEED, box_points, in_convex_cone
from verification.thesis.chapter1.sets import Floats, apart, contact_gradients, outside

ROUNDING = 1e-12
# A point moves by this when it is tried whether a vector is normal; less than any feature of the sets.
NUDGE = 1e-3
# How much a square of a distance may be above the least one.
SLACK = 0.02
# Half the opening of the mouth.
MOUTH = 0.6
RADIUS = 0.5


def in_proximal_cone(v: Floats, x: Floats) -> np.ndarray:
    """Definition 1.23 for the unit cube: x is the nearest point to x + NUDGE v."""
    return np.asarray(np.abs(np.clip(x + NUDGE * v, 0.0, 1.0) - x).max(axis=1) <= ROUNDING)


def half_way(first: Floats, second: Floats) -> Floats:
    """Between two arrangements."""
    return (first + second) / 2


@claim(
    "c1.not-convex",
    "Discs that do not overlap may overlap half-way between two arrangements.",
    source="section 4",
    quote="the set of non-overlapping disks … is not convex.",
)
def _not_convex() -> Evidence:
    first = np.array([[-RADIUS, 0.0], [RADIUS, 0.0]])
    middle = half_way(first, first[::-1])
    gaps = [float(np.linalg.norm(x[0] - x[1]) - 2 * RADIUS) for x in (first, first[::-1], middle)]
    return Evidence(
        f"Two touching discs and the same with places exchanged have gaps {gaps[0]:g} and {gaps[1]:g}; half-way their "
        f"gap is {gaps[2]:g}.",
        printed=(at_least("gap at the ends", min(gaps[:2]), 0.0), at_most("gap half-way", gaps[2], -RADIUS)),
    )


def filled_triangle() -> Floats:
    """Points of a convex set, (K, 2); (0, 0) lies nearest to points (0, h) above it."""
    weights = np.random.default_rng(SEED).dirichlet(np.ones(3), 20_000)
    return np.vstack([weights @ np.array([[-1.0, 0.0], [1.0, 0.0], [0.2, -1.0]]), [[0.0, 0.0]]])


@claim(
    "c1.convex-projection",
    "Convex sets have one nearest point.",
    source="after Definition 1.20",
    quote="the projection onto convex, closed, non-empty sets C is unique, i.e. P_C is single valued.",
    chosen="a triangle",
    recorded=Kind.NOT_REFUTED,
    tried_on="a triangle and one point beside it",
)
def _convex_projection() -> Evidence:
    """By the parallelogram law points whose squared distance is within s of the least are within 2 sqrt(s)."""
    points = filled_triangle()
    squares = ((points - [0.0, 0.5]) ** 2).sum(axis=1)
    near = points[squares <= squares.min() + SLACK]
    spread = float(np.linalg.norm(near[:, None] - near, axis=2).max())
    return Evidence(
        f"A triangle, {len(points)} points of it and one beside it: the {len(near)} points whose squared distance is "
        f"within {SLACK} of the least are at most {spread:.4f} apart, so no two can be nearest; convexity allows "
        f"{2 * math.sqrt(SLACK):.4f}.",
        printed=(
            at_most("spread over its bound for convex sets", spread / (2 * math.sqrt(SLACK)), 1.0),
            at_least("points that are nearly nearest", len(near), 10),
        ),
        seed=SEED,
    )


def lips(count: int) -> tuple[Floats, Floats]:
    """Points of the upper and the lower lip of a disc of radius 1 with a mouth."""
    along = np.linspace(0.0, 1.0, count)[:, None]
    return along * [math.cos(MOUTH), math.sin(MOUTH)], along * [math.cos(MOUTH), -math.sin(MOUTH)]


@claim(
    "c1.pacman",
    "A disc with a mouth has points with two nearest points, as near to it as one likes.",
    source="Figure 7",
    quote="The Pacman-like set is not uniformly prox-regular since for points in the middle of the mouth … not unique.",
    chosen="a mouth that opens by 1.2",
)
def _pacman() -> Evidence:
    """Points (s, 0) on the middle line of the mouth, s -> 0."""
    nearest, apart_by = [], []
    for s in (0.1, 0.01, 0.001):
        ends = [lip[np.linalg.norm(lip - [s, 0.0], axis=1).argmin()] for lip in lips(100_001)]
        distances = [float(np.linalg.norm(end - [s, 0.0])) for end in ends]
        nearest.append(max(distances))
        apart_by.append(float(np.linalg.norm(ends[0] - ends[1])) / s - abs(distances[0] - distances[1]) / s)
    return Evidence(
        f"In the middle of a mouth that opens by {2 * MOUTH} the nearest points of both lips are equally far and "
        f"{min(apart_by):.2f} s apart; the distance s from the corner may be as small as one likes (here to "
        f"{nearest[-1]:.0e} from the set), so no η > 0 will do.",
        printed=(
            equal("distance of the two nearest points over s", min(apart_by), math.sin(2 * MOUTH), 1e-2),
            equal("distance from the set over s, smallest s", nearest[-1] / 1e-3, math.sin(MOUTH), 1e-2),
        ),
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
    source="Proposition 1.22",
    quote="S is η-prox-regular with η = R/(6N) (1/3 sin(2π/N))^d for N ∈ ℕ",
    recorded=Kind.CORRECTED,
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
    source="after Definition 1.23",
    quote="N_C(x) = N(C, x) for all x ∈ ℝ^d",
    chosen="x ∈ C, or N_C(x) = ∅ outside of C, as is said after Definition 1.16",
    recorded=Kind.NOT_REFUTED,
    tried_on="the unit cube",
)
def _same_cones() -> Evidence:
    rng = np.random.default_rng(SEED)
    x = box_points(rng)
    signs = rng.choice([-1.0, 0.0, 1.0], x.shape) * rng.uniform(0.0, 1.0, x.shape)
    convex, proximal = in_convex_cone(signs, x), in_proximal_cone(signs, x)
    unlike, away = int((convex != proximal).sum()), int(in_proximal_cone(signs, x + 2.0).sum())
    return Evidence(
        f"Unit cube, {SAMPLES} points and vectors: {unlike} are normal by one definition only, {int(convex.sum())} by "
        f"both; outside of the cube {away} are proximal normals.",
        printed=(
            equal("normal by one definition only", unlike, 0),
            equal("proximal normals outside", away, 0),
        ),
        seed=SEED,
    )


@claim(
    "c1.nonconvex-normal",
    "A proximal normal of a set that is not convex may point towards other points of the set.",
    source="Figure 8",
    quote="n would not be a normal vector according to Definition 1.16 since n·(y - x) > 0.",
    chosen="the outside of the unit disc",
)
def _not_a_convex_normal() -> Evidence:
    x, n, y = np.array([0.0, 1.0]), np.array([0.0, -1.0]), np.array([0.0, -1.5])
    back = float(np.abs(outside(x + 0.5 * n) - x).max())
    angle = float(n @ (y - x))
    return Evidence(
        f"A is the outside of the unit disc, x = (0, 1), n = (0, -1): P_A(x + n/2) misses x by {back:.0e}, so n is a "
        f"proximal normal; for y = (0, -1.5) ∈ A, n·(y - x) = {angle:g}.",
        printed=(at_most("|P_A(x + n/2) - x|", back, ROUNDING), at_least("n·(y - x)", angle, ROUNDING)),
    )


@claim(
    "c1.projection-normal",
    "What a projection takes away is a proximal normal.",
    source="(1.23)",
    quote="x = P_S(y) ⟺ P_S(x + (y - x)) = x ⟹ y - x ∈ N(S, x)",
    recorded=Kind.NOT_REFUTED,
    tried_on="two discs, 2000 random points",
)
def _projection_normal() -> Evidence:
    rng = np.random.default_rng(SEED)
    y = rng.normal(size=(SAMPLES, 2, 2)) * 0.4
    x = apart(y)
    part = rng.uniform(0.0, 1.0, (SAMPLES, 1, 1))
    missed = float(np.abs(apart(x + part * (y - x)) - x).max())
    pushed = int((np.abs(x - y).max(axis=(1, 2)) > 0).sum())
    return Evidence(
        f"Two discs, {SAMPLES} points y of which {pushed} overlap, x = P_S(y): P_S(x + α(y - x)) misses x by "
        f"{missed:.0e} for random α ∈ [0, 1].",
        printed=(at_most("|P_S(x + α(y - x)) - x|", missed, ROUNDING), at_least("points that overlap", pushed, 100)),
        seed=SEED,
    )
