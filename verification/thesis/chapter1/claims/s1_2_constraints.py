"""Chapter 1, sections 1.2 and 1.3: discs with multipliers, energies, and the two forms of the model."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.reals import reals
from verification.claims.formal.stated import argument, implication
from verification.thesis.chapter1.lemmas import CONES

# Outside of S grad dist(x, S) = e, the unit vector from the nearest point to x; f = e.F, q = e.e = 1, v = e.x'.
(v,) = reals("v")


# v is a slope at x if W(y) - W(x) >= v (y - x) for all y, where W is 0 in [0, 1] and infinite outside.
(y,) = reals("y")


_outward = implication(
    "c1.outward-normals",
    "before Model 1.3",
    "∂W(x) is the set of all outward pointing normal vectors of S, e.g. ∂W(x) = ∂I_S(x) = N(S, x)",
    "The subdifferential of the indicator function of a set is its normal cone.",
    given=[v > 0, y * y >= 1],
    then=-v * (y - 1) <= v / 2 * (y - 1) * (y - 1),
    wrong=-v * (y - 1) <= 0,
    correction=Correction(
        "for convex S; otherwise ∂ is the proximal subdifferential, which (1.9) is not",
        Effect.PROOF,
        "the step to Model 1.3, which stands with N(S, x) of Definition 1.23",
        why=(
            "(1.9) bounds W from below at all y, and behind a touching disc there are feasible y again: at two "
            "touching discs (1.9) gives {0}, the cone has a normal"
        ),
        place=359,
    ),
    chosen="two discs on a line at the distance y, which may pass each other: S = {y² ≥ 1}, and the normal −a at y = 1",
)

_equivalent = argument(
    "c1.equivalent",
    "section 1.3; Theorem 1.25; Corollary 1.30, (1.35); (1.4), (1.5)",
    "we will see that this model is equivalent to (1.4) and (1.5).",
    "The inclusion with the normal cone and the equations with multipliers have the same solutions.",
    *CONES,
    also=("c1.cones", "c1.sum-of-all", "c1.sum-limit", "c1.multipliers"),
    tried_on="states whose contacts have independent gradients",
)
