"""Chapter 1, section 3: normal cones of convex sets, and convex sets that move."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.reals import reals, solver_library
from verification.claims.formal.stated import implication

z3 = solver_library()
# p = v.(y - x) <= 0 and q = w.(x - y) <= 0 for v in N_C(x), w in N_C(y).
x, v, p, q, b, L = reals("x v p q b L")

# C = [0, 1] and x > 1: v.(y - x) <= 0 for all y of C if it is so at both ends.
ENDS = z3.And(v * (0 - x) <= 0, v * (1 - x) <= 0)

_outside = implication(
    "c1.outside",
    "after Definition 1.16",
    "If x ∉ C then N_C(x) = ∅.",
    "Outside a convex set its normal cone is empty.",
    given=[x > 1],
    then=z3.Not(z3.And(x <= 1, ENDS)),
    wrong=z3.Not(ENDS),
    correction=Correction(
        "it is empty if Definition 1.16 asks for x ∈ C besides; as printed N_C(x) contains at least 0",
        Effect.MODEL,
        "(1.15) and (1.16): as printed they do not keep a point in C, and 0 is a solution from every start",
        why="v = 0 fulfils v·(y − x) ≤ 0 for every x, also outside of C, and the definition does not ask for x ∈ C",
        place=536,
    ),
)

_monotone = implication(
    "c1.monotone",
    "after (1.15)",
    "(v - w)·(x - y) ≤ 0 for all v ∈ N_C(x), w ∈ N_C(y)",
    "Normals v at x, w at y of a convex set have (v - w)·(x - y) ≤ 0.",
    given=[p <= 0, q <= 0],
    then=-p - q >= 0,
    wrong=-p - q <= 0,
    correction=Correction(
        "(v - w)·(x - y) ≥ 0",
        Effect.PROOF,
        "the uniqueness of solutions of (1.15), which stands: the right-hand side has -N_C",
        why="v·(y − x) ≤ 0 and w·(x − y) ≤ 0 by Definition 1.16; their sum is −(v − w)·(x − y) ≤ 0",
        place=559,
    ),
)

_convex_unique = implication(
    "c1.convex-unique",
    "after (1.15)",
    "in the case F = 0, Theorem 1.13 implies uniqueness of solutions of (1.15).",
    "Without a force the solution in a convex set is unique: ½ d/dt ‖x − y‖² = v·(y − x) + w·(x − y) ≤ 0 for ẋ = −v, ẏ"
    " = −w.",
    given=[p <= 0, q <= 0],
    then=p + q <= 0,
    wrong=-p - q <= 0,
    rests_on=("c1.dependence", "c1.monotone"),
    chosen="a set that moves, as in (1.16): in one that stands still nothing moves without F",
)

# n = -x'/|x'| is normal to C(t). A point of C(t) is within L h of x(t - h) = x - h x' + o(h): n.(z - x) <= 0. So h |x'|
# - L h b <= o(h), b <= 1 being n times the direction to z; v = |x'| in the limit h -> 0.
_sweeping = implication(
    "c1.sweeping",
    "Theorem 1.18",
    "For almost every t ∈ [0, T] we have ‖ẋ(t)‖ ≤ L.",
    "The speed of the sweeping process is at most the Lipschitz constant L of the moving set.",
    given=[L > 0, b <= 1, b >= -1, v <= L * b],
    then=v <= L,
    wrong=v <= L / 2,
    rests_on=("c1.sweeping-unique",),
    chosen="a given start, see c1.sweeping-unique",
)

# The distance d of two solutions does not grow, so one start has one solution.
d, start = reals("d start")

_sweeping_unique = implication(
    "c1.sweeping-unique",
    "Theorem 1.18, (1.16), (1.17)",
    "(1.17) x(0) ∈ C(0) … Then there is an unique solution x ∈ AC([0, T], ℝ^d) solving (1.16) and (1.17).",
    "The sweeping process with x(0) ∈ C(0) has a unique solution.",
    given=[start == 0, d >= 0, d <= start],
    then=d == 0,
    wrong=([start >= 0, d >= 0, d <= start], d == 0),
    correction=Correction(
        "for each xⁱⁿⁱᵗ ∈ C(0) there is a unique solution with x(0) = xⁱⁿⁱᵗ",
        Effect.MODEL,
        "(1.17), which should fix the start; Theorem 1.31 has x(0) = xⁱⁿⁱᵗ",
        why="(1.17) only asks for a start in C(0), and different starts in it have different solutions",
        place=573,
    ),
)
