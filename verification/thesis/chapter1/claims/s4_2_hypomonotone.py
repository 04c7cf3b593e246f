"""Chapter 1, sections 4.2 and 4.3: cones of discs, hypomonotonicity."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

import dincl
from dincl.projection.cone import distance_to_cone
from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter1.claims.s1_2_constraints import SIDES, TRIANGLE
from verification.thesis.chapter1.claims.s2_1_inclusions import LINE, step_values, touching
from verification.thesis.chapter1.sets import Floats, contact_gradients, support_of_cone

SAMPLES, SEED = 300, 12
ETA = 0.7


def discs() -> dincl.Problem:
    """Three discs of radius 1/2, each of which touches both others."""
    return dincl.Problem(TRIANGLE, lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])


def projected(y: Floats) -> Floats:
    """P_S(y) for y near the triangle, as one step of catch-up with dt = 1."""
    constant = dincl.Problem(TRIANGLE, lambda _t, _x: y - TRIANGLE, [dincl.NonOverlap(0.5)])
    path = dincl.solve(constant, dincl.CatchUp(dt=1.0, projection=dincl.Daqp(tol=1e-12)), t=1.0)
    return np.asarray(path.final)


def moved(n: Floats) -> float:
    """|P_S(x + n) - x| at the triangle."""
    return float(np.abs(projected(TRIANGLE + n) - TRIANGLE).max())


@claim(
    "c1.cones",
    "The proximal normals of the set of discs are what multipliers give.",
    source="Theorem 1.25",
    quote="N(S, x) = N^g(x) for all x ∈ ℝ^2N",
    recorded=Kind.NOT_REFUTED,
    tried_on="three touching discs",
)
def _cones() -> Evidence:
    """At a triangle of touching discs every x - P_S(x + n) is a combination of gradients; outside both are empty."""
    gradients = discs().rows_within(0.0, TRIANGLE, 1e-6).jacobian(TRIANGLE)
    rng = np.random.default_rng(SEED)
    weights = rng.uniform(0.0, 1.0, (50, gradients.shape[0]))
    normals = [-(weight @ gradients).reshape(3, 2) for weight in weights]
    reached = max(moved(1e-4 * normal) for normal in normals)
    others = [n for n in rng.normal(size=(50, 3, 2)) if distance_to_cone(-n.ravel(), gradients) > 0.1]
    missed = min(moved(1e-4 * n) for n in others)
    return Evidence(
        f"Three touching discs: P_S(x + n) returns to x to {reached:.0e} for n in N^g and misses it by {missed:.0e} or "
        "more for other n; outside of S both cones are empty as defined, so the statement is right for all x.",
        printed=(at_most("|P_S(x + n) - x|, n ∈ N^g", reached, 1e-10), at_least("the same, other n", missed, 1e-6)),
        seed=SEED,
    )


def single_normal(pair: tuple[int, int], length: float) -> Floats:
    """A proximal normal of the set S_j of one pair at the triangle: towards each other."""
    return np.asarray(-length * contact_gradients(TRIANGLE, [pair])[0].reshape(3, 2))


def beside_the_sum(y: Floats) -> float:
    """How far y - P_S(y) is from the sum of the N(S_j, P_S(y)), over its length; 0 where y is in S."""
    x = projected(y)
    closed = [(i, j) for i, j in SIDES if np.linalg.norm(x[i] - x[j]) < 1 + 1e-9]
    n = (y - x).ravel()
    along = support_of_cone(-contact_gradients(x, closed), n)
    return math.sqrt(max(1 - along**2 / float(n @ n), 0.0)) if np.abs(n).max() > 1e-6 else 0.0


@claim(
    "c1.sum-of-all",
    "The proximal normals of the set of discs are the sums of those of its pairs.",
    source="Theorem 1.25",
    quote="N(S, x) = Σ_j N(S_j, x) for all x ∈ ℝ^2N",
    recorded=Kind.NOT_REFUTED,
    tried_on="three touching discs",
)
def _sum_of_all() -> Evidence:
    rng = np.random.default_rng(SEED)
    lengths = rng.uniform(0.0, 1e-4, (30, 3))
    back = max(
        moved(np.sum([single_normal(*both) for both in zip(SIDES, each, strict=True)], axis=0)) for each in lengths
    )
    beside = max(beside_the_sum(TRIANGLE + 1e-3 * shift) for shift in rng.normal(size=(30, 3, 2)))
    return Evidence(
        f"Three touching discs: after sums of normals of the three S_j the projection onto S returns to x to "
        f"{back:.0e}; for 30 points y beside x, y - P_S(y) is such a sum at P_S(y) to {beside:.0e} of its length.",
        printed=(
            at_most("|P_S(x + Σ n_j) - x|", back, 1e-10),
            at_most("distance from the sum, relative", beside, 1e-6),
        ),
        seed=SEED,
    )


def spread(sign: float) -> float:
    """How far apart solutions s t of sign times (1.13) are at t = 1 that all start at 0."""
    ends = []
    for s in (-1.0, -0.5, 0.0, 0.5, 1.0):
        allowed = (sorted(sign * end for end in step_values(s * t)) for t in (0.25, 0.5, 1.0))
        if all(low <= s <= high for low, high in allowed):
            ends.append(s)
    return max(ends) - min(ends)


@claim(
    "c1.one-sided-word",
    "What Theorem 1.13 asks for.",
    source="section 4.3",
    quote="We saw in Theorem 1.13 that solutions of ẋ ∈ F(x) are unique, if F is one-sided semicontinuous.",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "if F is one-sided Lipschitz continuous; so in the sentence after it",
        Effect.NOTATION,
        "nothing else: Theorem 1.13 has the right word",
        why=(
            "Theorem 1.13 is stated for one-sided Lipschitz continuous multi-functions, and “one-sided "
            "semicontinuous” is defined nowhere"
        ),
        place=723,
    ),
    chosen="semicontinuous is read as in Definition 1.10",
)
def _one_sided_word() -> Evidence:
    low, high = step_values(0.0)
    beyond = sum(not low <= -end <= high for y in LINE for end in step_values(y))
    return Evidence(
        f"sign is upper semicontinuous at 0 ({beyond} of its values lie outside of [-1, 1]), but ẋ ∈ sign(x) has "
        f"solutions from 0 that are {spread(-1.0):g} apart at t = 1. For -sign, one-sided Lipschitz with L = 0, the "
        f"spread is {spread(1.0):g}.",
        printed=(at_most("spread at t = 1, semicontinuous", spread(-1.0), 0.0),),
        corrected=(
            at_most("spread at t = 1, one-sided Lipschitz", spread(1.0), 0.0),
            equal("values of sign outside of its value at 0", beyond, 0),
        ),
    )


def on_the_ball(rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Pairs of points of the sphere of radius ETA in space, whose outside is ETA-prox-regular."""
    first, second = (ETA * z / np.linalg.norm(z, axis=1, keepdims=True) for z in rng.normal(size=(2, SAMPLES, 3)))
    return first, second


def hypomonotone_sides(longest: float) -> tuple[Floats, Floats]:
    """Both sides of (1.28) over |x - y|^2, for normals -a x/|x|, -b y/|y| with a, b up to a length."""
    rng = np.random.default_rng(SEED)
    x, y = on_the_ball(rng)
    a, b = rng.uniform(0, longest, (2, SAMPLES, 1))
    squares = ((x - y) ** 2).sum(axis=1)
    return ((a * x - b * y) / ETA * (x - y)).sum(axis=1) / squares, (a + b)[:, 0] / (2 * ETA)


def disc_sides(eta: float) -> tuple[Floats, Floats]:
    """The same for two touching discs of radius 1/2 at any place, with normals that push them together."""
    rng = np.random.default_rng(SEED)
    left, right = [], []
    for angles in rng.uniform(0, 2 * np.pi, (SAMPLES, 2)):
        (x, n), (y, m) = (touching(angle) for angle in angles)
        (a, b), step = rng.uniform(0, 3, 2), x + rng.choice([0.0, 0.5]) * rng.normal(size=2) - y
        square = (step**2).sum()
        left.append(-((a * n - b * m) * step).sum() / square)
        right.append((a + b) / (2 * eta))
    return np.array(left), np.array(right)


@claim(
    "c1.hypomonotone",
    "Normals of prox-regular sets are monotone up to a quadratic term.",
    source="(1.28)",
    quote="-(v - w)·(x - y) ≤ (‖v‖ + ‖w‖)/(2η) ‖x - y‖²",
    recorded=Kind.NOT_REFUTED,
    tried_on="the outside of a ball in space, and two discs",
)
def _hypomonotone() -> Evidence:
    left, right = hypomonotone_sides(3.0)
    ours, bound = disc_sides(math.sqrt(0.5))
    return Evidence(
        f"Outside of a ball of radius η = {ETA}, {SAMPLES} pairs: both sides over |x - y|² agree to "
        f"{np.abs(left - right).max():.0e}, so (1.28) is sharp. For two discs of radius R and η = √2 R left over right "
        f"is at most {(ours / bound).max():.6f}.",
        printed=(
            at_most("left - right, outside of a ball", float((left - right).max()), 0.0, 1e-9),
            at_most("left over right, two discs", float((ours / bound).max()), 1.0, 1e-9),
        ),
        seed=SEED,
    )


@claim(
    "c1.one-over-eta",
    "The one-sided Lipschitz constant of normals of length up to 1.",
    source="section 4.3",
    quote="x ↦ -N(S, x) ∩ B₁(0) is one-sided Lipschitz with constant 1/η.",
    recorded=Kind.NOT_REFUTED,
    tried_on="the outside of a ball in space",
)
def _one_over_eta() -> Evidence:
    short = float(hypomonotone_sides(1.0)[0].max())
    rng = np.random.default_rng(SEED)
    x, y = on_the_ball(rng)
    full = ((x - y) / ETA * (x - y)).sum(axis=1) / ((x - y) ** 2).sum(axis=1)
    return Evidence(
        f"Outside of a ball of radius η = {ETA} the largest -(v - w)·(x - y)/|x - y|² is {short * ETA:.3f}/η for "
        f"random normals in the unit ball and {full.max() * ETA:.6f}/η for unit normals.",
        printed=(
            at_most("largest slope times η", max(short, float(full.max())) * ETA, 1.0, 1e-9),
            at_least("the same, unit normals", float(full.max()) * ETA, 1.0, 1e-9),
        ),
        seed=SEED,
    )
