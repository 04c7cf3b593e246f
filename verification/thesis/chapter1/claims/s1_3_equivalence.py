"""Chapter 1, section 1.3: normals as subdifferentials, and the two forms of the model of discs."""

from __future__ import annotations

import numpy as np

from verification.claims import Evidence, Verdict, at_least, equal, proved
from verification.thesis.chapter1.claims.s4_2_hypomonotone import cones
from verification.thesis.chapter1.sets import Floats
from verification.thesis.text.quoted import claim

SAMPLES, SEED = 300, 14
ROUNDING = 1e-12
# Points of the edge of the unit disc, and what the largest product with them may lack.
EDGE = np.stack([f(np.linspace(0, 2 * np.pi, 720, endpoint=False)) for f in (np.cos, np.sin)], axis=1)
BLIND = 1e-4
# How far two discs are moved along a vector, in diameters.
FAR = 1e4


def inside(y: Floats) -> Floats:
    """The projection onto the unit disc."""
    return np.asarray(y / max(float(np.linalg.norm(y)), 1.0))


def subgradient(v: Floats, x: Floats) -> bool:
    """(1.9) for the indicator function of the unit disc, x in it."""
    return bool(((EDGE - x) @ v).max() <= BLIND)


def proximal(v: Floats, x: Floats) -> bool:
    """Whether x = P_S(x + v/2)."""
    return bool(np.abs(inside(x + v / 2) - x).max() <= ROUNDING)


@claim(
    "c1.outward-normals",
    "The subdifferential of the indicator function of a set is its normal cone.",
    "before Model 1.3",
    Verdict.CORRECTED,
    tried_on="the unit disc, and two touching discs",
)
def _outward() -> Evidence:
    """Random unit vectors and the outward ones at points of the disc, and at two discs in contact."""
    rng = np.random.default_rng(SEED)
    places = [inside(y) for y in rng.normal(size=(SAMPLES, 2))]
    vectors = [w / np.linalg.norm(w) for w in (*rng.normal(size=(SAMPLES, 2)), *places)]
    found = [(subgradient(v, x), proximal(v, x)) for v, x in zip(vectors, places * 2, strict=True)]
    unlike, both = sum(a != b for a, b in found), sum(a and b for a, b in found)
    touching = np.array([[-0.5, 0.0], [0.5, 0.0]])
    apart = [np.diff(touching + FAR * v, axis=0) for v in (-touching, *rng.normal(size=(SAMPLES, 2, 2)))]
    refuted = sum(float(np.linalg.norm(arrow)) >= 1 for arrow in apart)
    return Evidence(
        f"Unit disc, {2 * SAMPLES} points with unit vectors: {unlike} are in one of ∂I_S(x) and N(S, x) only, {both} "
        f"in both. For two touching discs (1.9) gives {{0}} instead: for {refuted} of {len(apart)} vectors v, their "
        f"normal included, x + {FAR:g} v is in S, so v is no subgradient.",
        printed=(equal("normals of two touching discs that (1.9) misses", float(np.linalg.norm(apart[0]) >= 1), 0),),
        corrected=(
            equal("vectors in one of the sets only, convex S", unlike, 0),
            at_least("vectors in both", both, SAMPLES // 10),
        ),
        seed=SEED,
    )


@claim(
    "c1.equivalent",
    "The inclusion with the normal cone and the equations with multipliers have the same solutions.",
    "section 1.3",
    Verdict.PROVED_INSTANCE,
    chosen="the four discs of Figure 4 of chapter 2",
    tried_on="states whose contacts have independent gradients",
)
def _equivalent() -> Evidence:
    """Both right sides are equal where N = N^g: (1.10) is F - N, (1.4), (1.5) is F + sum lambda grad g."""
    return proved(*cones())
