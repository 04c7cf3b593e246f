"""Chapter 1, sections 4.2 and 4.3: cones of discs, hypomonotonicity."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from verification.claims import Evidence, FormalProof, Verdict, at_most, equal, proved
from verification.formal.algebra import identity
from verification.formal.reals import implication
from verification.thesis.chapter1.claims.s2_1_inclusions import LINE, step_values
from verification.thesis.text.quoted import claim


def cones() -> tuple[FormalProof, FormalProof, FormalProof]:
    """Prove N^g = N where the rows of G are independent; of a pair a = |d|, p = d.move, r = |move|^2, b is new.

    n = -G^T lambda is proximal, as g grows at most by its slope and r/(2a). A proximal n has n.w <= 0 for all w with
    G w > 0; W = G^T (G G^T)^-1 has G W = I, so lambda = -W^T n >= 0 and n = -G^T lambda but for what no row sees.
    """
    return (
        implication(
            "|d + move| ≤ |d| + d·move/|d| + |move|²/(2|d|), so Σλ_k∇g_k·(y − x) ≥ −K‖y − x‖² for all y ∈ S: N^g ⊆ N",
            lambda s, a, b, p, r: ([a > 0, b >= 0, b * b == a * a + 2 * p + r], 2 * a * b <= 2 * a * a + 2 * p + s * r),
            "−|move|²/(2|d|)",
        ),
        identity(
            "G Gᵀ(GGᵀ)⁻¹ = I: n·w ≤ 0 for the columns w gives λ ≥ 0",
            lambda s, GGT: GGT * GGT**-s - 1,
            "GGᵀ for its inverse",
            words=True,
        ),
        implication(
            "n·w ≤ 0 for w and −w that no row sees gives n·w = 0: N ⊆ N^g",
            lambda s, p: ([p <= 0, -s * p <= 0], p == 0),
            "for w alone",
        ),
    )


@claim(
    "c1.cones",
    "The proximal normals of the set of discs are what multipliers give.",
    "Theorem 1.25",
    Verdict.PROVED_INSTANCE,
    tried_on="states whose contacts have independent gradients",
)
def _cones() -> Evidence:
    return proved(*cones())


@claim(
    "c1.sum-of-all",
    "The proximal normals of the set of discs are the sums of those of its pairs.",
    "Theorem 1.25",
    Verdict.PROVED_INSTANCE,
    tried_on="states whose contacts have independent gradients",
)
def _sum_of_all() -> Evidence:
    """N(S_j, x) is the ray of one gradient, by the same proof with one row, and N^g the sum of these rays."""
    return proved(*cones())


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
    "section 4.3",
    Verdict.CORRECTED,
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


@claim(
    "c1.hypomonotone",
    "Normals of prox-regular sets are monotone up to a quadratic term.",
    "(1.28)",
    Verdict.PROVED,
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
    "The one-sided Lipschitz constant of normals of length up to 1.",
    "section 4.3",
    Verdict.PROVED,
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
