"""Chapter 2, section 3: the lines of the proof of Lemma 2.8."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

import dincl
from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved, put_right
from verification.formal.algebra import identity
from verification.formal.reals import implication
from verification.thesis.chapter1.sets import Floats
from verification.thesis.chapter2.discs import RADIUS, ROUNDING, overlap, parted, points_of_step, row
from verification.thesis.text.quoted import claim

SEED, SAMPLES = 21, 100
DT = 1e-3
# Discs that a single one is kicked along by, see ``kicked``.
KICKS = 12
# Two touching discs that are pulled apart with |F| = sqrt(2).
APART = np.array([[-1.0, 0.0], [1.0, 0.0]])


def other_side(x: Floats) -> Floats:
    """Two overlapping discs moved through each other until they touch on the other side."""
    along = (x[1] - x[0]) / np.linalg.norm(x[1] - x[0])
    middle = (x[0] + x[1]) / 2
    return np.array([middle + RADIUS * along, middle - RADIUS * along])


def not_normal(normal: Floats, p: Floats) -> float:
    """How far P_S(p + α normal) is from p for a small α: 0 for a proximal normal (Definition 1.23)."""
    return float(np.linalg.norm(parted(p + 0.01 * normal) - p))


@claim(
    "c2.equivalent",
    "That p_j is the projection of p_{j−1}, and that their difference is normal at p_j, is the same.",
    "proof of Lemma 2.8",
    Verdict.CORRECTED,
)
def _equivalent() -> Evidence:
    """p - q normal at q: for q the projection of p, and for a q that is not."""
    rng = np.random.default_rng(SEED)
    pairs = [np.array([[0.0, 0.0], [r * math.cos(s), r * math.sin(s)]]) for r, s in rng.uniform(0.9, 1.0, (SAMPLES, 2))]
    forward = max(not_normal(p - parted(p), parted(p)) for p in pairs)
    others = [other_side(p) for p in pairs]
    normal = max(not_normal(p - q, q) for p, q in zip(pairs, others, strict=True))
    apart = max(float(np.linalg.norm(q - parted(p))) for p, q in zip(pairs, others, strict=True))
    return Evidence(
        f"{SAMPLES} pairs of discs with overlap below 0.1: p − P(p) is normal at P(p) to {forward:.0e}. So is p − q at "
        f"the q where the discs have changed sides (to {normal:.0e}), but q is {apart:.1f} away from P(p).",
        printed=(
            at_most("p − q misses the normal cone at q by", normal, ROUNDING),
            at_most("distance of q from the projection", apart, ROUNDING),
        ),
        corrected=(at_most("p − P(p) misses the normal cone by", forward, ROUNDING),),
        seed=SEED,
    )


@claim(
    "c2.scale",
    "The rate of a step without its drift, by its first and last point.",
    "(2.12)",
    Verdict.CORRECTED,
)
def _scale() -> Evidence:
    """p_0 = x + dt F(x) and Phi(x) = p_M."""
    return put_right(
        identity(
            "(Φ(x) − x)/Δt − F(x) = (p_M − p_0)/Δt",
            lambda s, x, F, h, last: (last - x) / h - F - (last - (x + h * F)) / h**s,
            "= p_M − p_0",
            0,
        )
    )


@claim(
    "c2.steps",
    "Every projection at most doubles the distance from the start of the step.",
    "(2.13)",
    Verdict.PROVED,
)
def _steps() -> Evidence:
    """x is in all S_j: n = |p_j - p_(j-1)| <= |x - p_(j-1)| = d, q = |p_j - x|, P = 2^(j-1) dt |F|."""
    return proved(
        implication(
            "‖p_j − x‖ ≤ ‖p_j − p_{j−1}‖ + ‖p_{j−1} − x‖ ≤ 2‖p_{j−1} − x‖, so 2^j Δt‖F‖ by induction, for any "
            "sets S_j ∋ x",
            lambda s, n, d, q, P: ([d >= 0, n <= d, q <= n + d, d <= P], q <= s * 2 * P),
            "no factor 2",
            0.5,
        )
    )


def kicked(count: int) -> tuple[Floats, Floats]:
    """A state of S and a prediction in which disc 0 meets, one after another, ``count`` discs just behind it."""
    width, place = 1e-3 * RADIUS, 0.0
    x, predicted = np.zeros((2, count + 1, 2))
    x[0] = -1.9 * RADIUS, 0.0
    for k in range(1, count + 1):
        predicted[k] = place - width, 0.0
        x[k] = RADIUS * (k - 1), RADIUS * (0.87 if k % 2 else -0.87)
        place += (2 * RADIUS - width) / 2
    return x, predicted


@claim(
    "c2.induction",
    "The rate of a step without its drift is bounded by the force, with a constant that has the index j.",
    "after (2.13)",
    Verdict.CORRECTED,
    chosen="j = 1 for the free index",
)
def _induction() -> Evidence:
    x, predicted = kicked(KICKS)
    moved = predicted - x
    gap = min(float(np.linalg.norm(x[i] - x[j])) for i in range(len(x)) for j in range(i)) - 2 * RADIUS
    ratio = float(np.linalg.norm(points_of_step(x, moved, 1.0)[-1] - predicted) / np.linalg.norm(moved))
    pairs = math.comb(len(x), 2)
    return Evidence(
        f"{len(x)} discs of which one is passed on along a row by the others (Δt = 1): the left side is {ratio:.2f} "
        f"‖F‖, more than (2¹ + 1) ‖F‖. The bound is for p_M, so 2^j must read 2^M, here with M = {pairs}.",
        printed=(at_least("gap of the state", gap, 0, ROUNDING), at_most("left side / ‖F‖, j = 1", ratio, 3.0)),
        corrected=(at_least("gap of the state", gap, 0, ROUNDING), at_most("left side / ‖F‖", ratio, 2.0**pairs + 1)),
    )


@claim(
    "c2.last-line",
    "In the limit of small steps the cones at the p_j have the support function of the cone at x.",
    "proof of Lemma 2.8, last line",
    Verdict.CORRECTED,
)
def _last() -> Evidence:
    """Both sides for two touching discs, w pointing apart: p_1 has no contact left."""
    x, limit = row(2), 3 * float(np.linalg.norm(APART)) + 1
    problem = dincl.Problem(x, lambda _t, x: 0 * x, [dincl.NonOverlap(RADIUS)])
    last, w = points_of_step(x, APART, DT)[-1], np.array([[-1.0, 0.0], [1.0, 0.0]])
    left, right = (dincl.geometry.support(problem, 0.0, at, w, tol=1e-9, radius=limit) for at in (last, x))
    return Evidence(
        f"Two touching discs that are pulled apart, overlap {overlap(last):g} after the step: −N(S_1, p_1) is {{0}}, "
        f"the lim sup is {left:g}, but the last line is {right:.2f}. Corollary 1.30 has “≤”, which is enough.",
        printed=(equal("lim sup", left, right, 1e-6),),
        corrected=(at_most("lim sup", left, right, 1e-6),),
    )
