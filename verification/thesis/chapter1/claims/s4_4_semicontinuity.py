"""Chapter 1, section 4.4: scalar semicontinuity of normals, and what follows for the cones of discs."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

from verification.claims import Evidence, FormalProof, Verdict, at_most, equal, proved
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter1.claims.s1_2_constraints import SIDES
from verification.thesis.chapter1.claims.s4_2_hypomonotone import cones
from verification.thesis.chapter1.sets import Floats, contact_gradients, support_of_cone
from verification.thesis.text.quoted import claim

SAMPLES, SEED = 300, 12


def bent(opening: float) -> Floats:
    """Three discs of which the first touches both others; 0 closes the triangle."""
    angles = np.array([0.0, math.pi / 3 + opening])
    return np.concatenate([[[0.0, 0.0]], np.stack([np.cos(angles), np.sin(angles)], axis=1)])


def normals_support(x: Floats, w: Floats) -> float:
    """sigma(-N(S, x) ∩ B_1, w) of discs of radius 1/2 at a point of S."""
    closed = [(i, j) for i, j in SIDES if np.linalg.norm(x[i] - x[j]) < 1 + 1e-12]
    return support_of_cone(contact_gradients(x, closed), w)


def limits(step: float) -> Floats:
    """sigma at three sequences that are ``step`` away from the closed triangle, and at the triangle, (4, K)."""
    directions = np.random.default_rng(SEED).normal(size=(100, 6))
    corner = bent(0.0)
    turned = corner @ np.array([[math.cos(step), math.sin(step)], [-math.sin(step), math.cos(step)]])
    places = (bent(step), turned, (1 + step) * corner, corner)
    return np.array([[normals_support(x, w) for w in directions] for x in places])


def excess(values: Floats) -> float:
    """How far sigma at the sequences of ``limits`` is above sigma at their limit."""
    return float((values[:3] - values[3]).max())


def closed_graph() -> FormalProof:
    """Prove that the inequality of proximal normals of a prox-regular set holds in the limit.

    v_n.(y - x_n) and |v_n||y - x_n|^2/(2 eta) come within any e > 0 of p and K of the limit; e = (p - K)/3 is tried.
    """
    z3 = solver_library()
    return implication(
        "v_n·(y − x_n) ≤ ‖v_n‖‖y − x_n‖²/(2η) for all y ∈ S holds in the limit: v ∈ N(S, x), and ‖v‖ ≤ 1, so no "
        "sequence has a larger σ in the limit, for any uniformly prox-regular S",
        lambda s, p, K, e: ([3 * e == s * (p - K), z3.Implies(e > 0, p <= K + 2 * e)], p <= K),
        "e = (K − p)/3",
    )


@claim(
    "c1.scalarly-upper",
    "The short normals of the set of discs are scalarly upper semicontinuous.",
    "Proposition 1.28",
    Verdict.PROVED,
)
def _scalarly_upper() -> Evidence:
    """v_n in N(S, x_n), |v_n| <= 1, tend to v (a subsequence, the ball being compact) and x_n to x: p, K of the limit.

    p = v.(y - x) and K = |v||y - x|^2/(2 eta) for a point y of S; both are continuous in v and x.
    """
    return proved(closed_graph())


@claim(
    "c1.distance",
    "The short normals are the proximal subgradients of the distance.",
    "Remark 1.29",
    Verdict.PROVED_INSTANCE,
    chosen="the outside of the unit disc, x on its boundary; the ball is closed (see the errata)",
    tried_on="the outside of the unit disc, every point of its boundary",
)
def _distance() -> Evidence:
    """v = -s x for a boundary point x: r = |y|, D = |y - x|^2, x.(y - x) = (r^2 - 1 - D)/2; k is any constant."""
    z3 = solver_library()
    return proved(
        implication(
            "dist(y) ≥ v·(y − x) − |y − x|² for v = −ax with 0 ≤ a ≤ 1: short normals are proximal subgradients",
            lambda s, r, D, a, d: (
                [r >= 0, D >= 0, a >= 0, a <= s, d == z3.If(r < 1, 1 - r, 0)],
                d >= -a * (r * r - 1 - D) / 2 - D,
            ),
            "0 ≤ a ≤ 2",
            2,
        ),
        implication(
            "for a > 1 and for a < 0 no constant k serves: on the ray of x, at y = (1 − u)x and (1 + u)x",
            lambda s, a, k, u: (
                [k > 0, u > 0, u < 1, s * u * k < z3.If(a > 1, a - 1, -a), z3.Or(a > 1, a < 0)],
                z3.If(a > 1, u - a * u + k * u * u < 0, a * u + k * u * u < 0),
            ),
            "larger u",
            0.25,
        ),
        implication(
            "nor for a tangential part c: on the circle, at y = ((1 − w²)x + 2w x⊥)/(1 + w²), where v·(y − x) = "
            "2w(c + aw)/(1 + w²)",
            lambda s, a, c, k, w: (
                [k > 0, c > 0, a >= 0, w > 0, s * 2 * k * w < c],
                2 * w * (c + a * w) > k * 4 * w * w,
            ),
            "larger w",
            0.25,
        ),
    )


@claim(
    "c1.sum-limit",
    "Sums of normals at points that tend to x are, in the limit, normals at x.",
    "Corollary 1.30, (1.35)",
    Verdict.PROVED_INSTANCE,
    chosen="the ball cuts the sum of the cones, not each of them",
    tried_on="contacts with independent gradients",
)
def _sum_limit() -> Evidence:
    """n = sum l_j grad g_j(p_j), |n| <= 1: the l_j are bounded, so that a subsequence converges, to a normal at x."""
    return proved(
        implication(
            "with |Gᵀλ| ≥ σ|λ| at x and |Gᵀλ − G′ᵀλ| ≤ ½σ|λ| near x, |G′ᵀλ| ≤ 1 gives |λ| ≤ 2/σ",
            lambda s, lam, near, at, sigma: (
                [sigma > 0, lam >= 0, at >= sigma * lam, near >= at - 0.5 * sigma * lam, near <= 1],
                sigma * lam <= s * 2,
            ),
            "|λ| ≤ 1/σ",
            0.5,
        ),
        *cones(),
    )


@claim(
    "c1.sum-of-cones",
    "The proof of the corollary adds support functions of cones that are cut by a ball.",
    "proof of Corollary 1.30",
    Verdict.CORRECTED,
    tried_on="two pairs of touching discs",
)
def _sum_of_cones() -> Evidence:
    """Two touching pairs of discs far apart, with normals orthogonal in R^8; p_j = x, w along -(n_1 + n_2)."""
    far = np.array([[0.0, 0.0], [1.0, 0.0], [9.0, 0.0], [10.0, 0.0]])
    rows = contact_gradients(far, [(0, 1), (2, 3)]) / math.sqrt(2)
    w = rows.sum(axis=0) / math.sqrt(2)
    whole, each = support_of_cone(rows, w), sum(support_of_cone(row[None], w) for row in rows)
    directions = np.random.default_rng(SEED).normal(size=(SAMPLES, 8))
    bound = max(sum(support_of_cone(row[None], u) for row in rows) - 2 * support_of_cone(rows, u) for u in directions)
    return Evidence(
        f"Two pairs in contact: σ((Σ -N_j) ∩ B₁, w) = {whole:.4f}, Σ σ(-N_j ∩ B₁, w) = {each:.4f}. If the ball cuts "
        "the sum, the first equality of the proof fails; if it cuts each cone, the last set is in B_M, not in B₁: "
        f"Σ σ(-N_j ∩ B₁) - σ(-N ∩ B_M) ≤ {bound:.0e} in {SAMPLES} directions.",
        printed=(equal("Σ σ(-N_j ∩ B₁, w) over σ((Σ -N_j) ∩ B₁, w)", each / whole, 1.0, 1e-9),),
        corrected=(at_most("Σ σ(-N_j ∩ B₁, w) - σ(-N ∩ B_M, w)", bound, 0.0, 1e-6),),
        seed=SEED,
    )
