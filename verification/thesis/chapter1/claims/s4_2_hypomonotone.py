"""Chapter 1, sections 4.2 and 4.3: cones of discs, hypomonotonicity."""

from __future__ import annotations

from verification.claims import Evidence, Verdict, claim, proved
from verification.formal.reals import implication


@claim(
    "c1.hypomonotone",
    "Normals of prox-regular sets are monotone up to a quadratic term.",
    source="(1.28)",
    quote="-(v - w)·(x - y) ≤ (‖v‖ + ‖w‖)/(2η) ‖x - y‖²",
    recorded=Verdict.PROVED,
)
def _hypomonotone() -> Evidence:
    """p = v.(y - x), q = w.(x - y), D = |x - y|^2, k = 1/(2 eta); c = p/|v|, ``square`` is |x + eta v/|v| - y|^2."""
    return proved(
        implication(
            "no point y of S is nearer to x + ηv/‖v‖ than x, so v·(y − x) ≤ ‖v‖‖x − y‖²/(2η)",
            lambda s, p, v, D, eta, c, square: (
                [eta > 0, v > 0, D >= 0, p == v * c, square == D - s * 2 * eta * c + eta * eta, square >= eta * eta],
                2 * eta * p <= v * D,
            ),
            "x − ηv/‖v‖",
        ),
        implication(
            "v·(y − x) ≤ ‖v‖‖x − y‖²/(2η) and w·(x − y) ≤ ‖w‖‖x − y‖²/(2η) sum to (1.28)",
            lambda s, p, q, v, w, D, k: (
                [k > 0, v >= 0, w >= 0, D >= 0, p <= v * k * D, q <= w * k * D],
                p + q <= (v + s * w) * k * D,
            ),
            "‖v‖ − ‖w‖",
        ),
    )


@claim(
    "c1.one-over-eta",
    "The map x ↦ -N(S, x) ∩ B₁(0) is one-sided Lipschitz continuous with the constant 1/η.",
    source="section 4.3",
    quote="x ↦ -N(S, x) ∩ B₁(0) is one-sided Lipschitz with constant 1/η.",
    recorded=Verdict.PROVED,
    rests_on=("c1.hypomonotone",),
)
def _one_over_eta() -> Evidence:
    """(1.28) for |v|, |w| <= 1: p = -(v - w).(x - y), D = |x - y|^2."""
    return proved(
        implication(
            "(1.28) with ‖v‖, ‖w‖ ≤ 1 gives −(v − w)·(x − y) ≤ ‖x − y‖²/η",
            lambda s, p, v, w, D, eta: (
                [eta > 0, v >= 0, v <= 1, w >= 0, w <= 1, D >= 0, 2 * eta * p <= (v + w) * D],
                eta * p <= s * D,
            ),
            "‖x − y‖²/(2η)",
            0.5,
        )
    )
