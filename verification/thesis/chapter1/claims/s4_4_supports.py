"""Chapter 1, section 4.4: support functions, scalar semicontinuity of normals, and cones of discs."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.reals import reals, solver_library
from verification.claims.formal.stated import implication

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
