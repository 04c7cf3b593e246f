"""Chapter 5, sections 2.4 and 2.5: boundedness and Lipschitz constants of the terms of the equations."""

from __future__ import annotations

from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter5.lemmas import PRODUCTS

S, n, M, h = reals("S n M h")
TERMS = [n >= 1, M >= 0, n * M >= S, -n * M <= S, h <= M, h >= -M]

_any_number = argument(
    "c5.any-number",
    "Lemma 5.6",
    "m_eff and F_eff are bounded and Lipschitz continuous … The derived bounds do not depend on N",
    "Effective mass and force have bounds and Lipschitz constants that do not depend on N.",
    follows(
        TERMS,
        [S + h <= (n + 1) * M, S + h >= -(n + 1) * M],
        S + h <= n * M,
        "if n terms, or their differences, are at most M and a sum of them at most nM, the next sum is at most (n + "
        "1)M: bounds and Lipschitz constants of means over particles do not depend on N",
        "at most nM",
    ),
    *PRODUCTS,
    rests_on=("c5.product",),
    chosen="distance of positions: the largest over the particles",
)


_product = argument(
    "c5.product",
    "proof of Lemma 5.6",
    "if h₁, h₂ are both bounded and Lipschitz continuous, then the product h₁h₂ is also bounded and Lipschitz",
    "Products of bounded Lipschitz continuous functions are bounded and Lipschitz continuous.",
    *PRODUCTS,
)
