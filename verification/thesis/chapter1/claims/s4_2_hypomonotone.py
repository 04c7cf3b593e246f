"""Chapter 1, sections 4.2 and 4.3: cones of discs, hypomonotonicity."""

from __future__ import annotations

from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument

# p = v.(y - x), q = w.(x - y), D = |x - y|^2, k = 1/(2 eta); c = p/|v|, square is |x + eta v/|v| - y|^2.
p, q, v, w, D, k, eta, c, square = reals("p q v w D k eta c square")

BALL = [eta > 0, v > 0, D >= 0, p == v * c, square >= eta * eta]

_hypomonotone = argument(
    "c1.hypomonotone",
    "(1.28)",
    "-(v - w)·(x - y) ≤ (‖v‖ + ‖w‖)/(2η) ‖x - y‖²",
    "Normals of prox-regular sets are monotone up to a quadratic term.",
    follows(
        [*BALL, square == D - 2 * eta * c + eta * eta],
        2 * eta * p <= v * D,
        ([*BALL, square == D + 2 * eta * c + eta * eta], 2 * eta * p <= v * D),
        "no point y of S is nearer to x + ηv/‖v‖ than x, so v·(y − x) ≤ ‖v‖‖x − y‖²/(2η)",
        "x − ηv/‖v‖",
    ),
    follows(
        [k > 0, v >= 0, w >= 0, D >= 0, p <= v * k * D, q <= w * k * D],
        p + q <= (v + w) * k * D,
        p + q <= (v - w) * k * D,
        "v·(y − x) ≤ ‖v‖‖x − y‖²/(2η) and w·(x − y) ≤ ‖w‖‖x − y‖²/(2η) sum to (1.28)",
        "‖v‖ − ‖w‖",
    ),
)
