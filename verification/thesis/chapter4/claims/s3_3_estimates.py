"""Chapter 4, section 3.3: the apical-basal scale, categories of event times, and the ratios estimated for them."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.stated import argument, identity

sp = library()
n, p, d, a, b, first, second, e = sp.symbols("n p d a b a1 a2 e", positive=True)

_count = identity(
    "c4.categories-count",
    "section 3.3.3",
    "we will consider a partition … into n^D + 1 many subsets D_1, …, D_{n^D}",
    "The event times are divided into n^D + 1 categories D_1 to D_{n^D}.",
    right=n * (1 / n) - 1,
    wrong=(n + 1) * (1 / n) - 1,
    correction=Correction(
        "n^D many subsets",
        Effect.NUMBER,
        "P[D_k] ≈ 1/n^D and the n^rep/n^D samples for each category",
        why="the sets are numbered from 1 to n^D, and n^D chances of 1/n^D make up 1",
        place=2655,
    ),
)

# Chances a of an extruded cell in a category and b of another cell in it; a1, a2 of two cells of a group.
_conditional = argument(
    "c4.conditional",
    "(4.9), (4.11), (4.12); (4.10), Remark 4.1",
    "E[δ_i | T_i ∈ D_k] ≈ Σ_ℓ δ_i(ω_ℓ) 1_{D_k}(T_i(ω_ℓ)) / Σ_ℓ 1_{D_k}(T_i(ω_ℓ))",
    "The ratio of chances is the conditional expectation, and the ratio of sums over runs tends to it.",
    vanishes(
        n * a / (n * (a + b)) - a / (a + b),
        n * a / n - a / (a + b),
        "(4.9) is E[δ_i 1_k]/P[T_i ∈ D_k], the conditional expectation (4.11), to which (4.12) tends",
        "without the chance of the category",
    ),
    vanishes(
        (first / p + second / p) / 2 - (first + second) / (2 * p),
        (first / p + second / (p + d)) / 2 - (first + second) / (2 * p + d),
        "the mean (4.10) over the cells of a group is A/B, the ratio over all cells of the category",
        "cells whose times have other chances",
    ),
    also=("c4.average",),
    chosen="sums over runs are near n times the chances: the law of large numbers",
)

# e = E[delta_i 1_{D_k}(T_i)] of a cell with P[T_i in D_k] = p, or p + d, in a category with P[D_k] = p.
_total = identity(
    "c4.total",
    "(4.7), (4.10)",
    "r*(D_k) := 1/N^EMT Σ_i E[δ_i* | T_i ∈ D_k]",
    "Weighted by the chances of the categories their ratios make up the ratio of extruded cells, Σ_k P[D_k] r(D_k) = "
    "r.",
    right=p * e / p - e,
    wrong=p * e / (p + d) - e,
    rests_on=("c4.conditional",),
)
