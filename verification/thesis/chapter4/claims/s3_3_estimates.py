"""Chapter 4, section 3.3: the apical-basal scale, categories of event times, and the ratios estimated for them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tissue.state.cells import Floats
from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, equal, proved
from verification.formal.algebra import identity, library

SEED = 333
RUNS, GROUP = 20_000, 10
# Chances of a mean of independent numbers to be this many standard errors off: 6e-5.
ERRORS = 4.0
SETS = 25
# Four standard errors of a share of 20,000 draws.
ROUNDING = 1e-12
# A model of a run: P[T_i in D_k], and P[extruded | T_i in D_k] for the cells of the group.
CHANCE = np.array([0.5, 0.3, 0.2])
GIVEN = np.array([0.1, 0.4, 0.8])


def share_sum(sets: int) -> float:
    """Sum over so many sets of chances 1/n^D."""
    return sum(1 / SETS for _ in range(sets))


@claim(
    "c4.categories-count",
    "The event times are divided into n^D + 1 categories D_1 to D_{n^D}.",
    source="section 3.3.3",
    quote="we will consider a partition … into n^D + 1 many subsets D_1, …, D_{n^D}",
    correction=Correction(
        "n^D many subsets",
        Effect.NUMBER,
        "P[D_k] ≈ 1/n^D and the n^rep/n^D samples for each category",
        why="the sets are numbered from 1 to n^D, and n^D chances of 1/n^D make up 1",
        place=2655,
    ),
)
def _count() -> Evidence:
    what = f"total chance of sets with a chance of 1/n^D each, n^D = {SETS},"
    return Evidence(
        printed=(equal(f"{what} n^D + 1 sets", share_sum(SETS + 1), 1.0, ROUNDING),),
        corrected=(equal(f"{what} n^D sets", share_sum(SETS), 1.0, ROUNDING),),
    )


def extruded_given(i: int) -> Floats:
    """P[extruded | T_i in D_k]: cells at the end of the group leave more often."""
    return np.asarray(GIVEN * (1.0 - 0.05 * i))


def estimate(hits: Floats, inside: Floats) -> float:
    """(4.12)."""
    return float((hits * inside).sum() / inside.sum())


def runs(rng: np.random.Generator) -> tuple[NDArray[np.int64], Floats]:
    """Categories and outcomes of all cells of all runs, (RUNS, GROUP); those of one run share their luck."""
    kinds = rng.choice(len(CHANCE), size=(RUNS, GROUP), p=CHANCE)
    luck = (rng.random((RUNS, 1)) + 0.5 * rng.random((RUNS, GROUP))) % 1.0
    chance = np.stack([extruded_given(i)[kinds[:, i]] for i in range(GROUP)], axis=1)
    return kinds, (luck < chance).astype(float)


def by_counting() -> tuple[Floats, Floats]:
    """(4.9) and (4.11) for the first cell, from all equally likely outcomes: ten of a category, twenty of luck."""
    kinds, luck = np.meshgrid(np.repeat(np.arange(3), (10 * CHANCE).round().astype(int)), np.arange(20))
    extruded = luck < (20 * extruded_given(0)).round()[kinds]
    inside = [kinds == k for k in range(3)]
    joint = [(extruded & here).sum() / kinds.size / (here.sum() / kinds.size) for here in inside]
    means = [(extruded * here).mean() / here.mean() for here in inside]
    return np.array(joint), np.array(means)


@claim(
    "c4.conditional",
    "The ratio of chances is the conditional expectation, and the ratio of sums over runs tends to it.",
    source="(4.9), (4.11), (4.12)",
    quote="E[δ_i | T_i ∈ D_k] ≈ Σ_ℓ δ_i(ω_ℓ) 1_{D_k}(T_i(ω_ℓ)) / Σ_ℓ 1_{D_k}(T_i(ω_ℓ))",
    tried_on="a model with three categories and known chances",
)
def _conditional() -> Evidence:
    exact = extruded_given(0)
    formula = max(float(np.abs(each - exact).max()) for each in by_counting())
    kinds, hits = runs(np.random.default_rng(SEED))
    worst = 0.0
    for k, wanted in enumerate(exact):
        inside = kinds[:, 0] == k
        error = np.sqrt(wanted * (1 - wanted) / inside.sum())
        worst = max(worst, abs(estimate(hits[:, 0], inside) - wanted) / error)
    return Evidence(
        printed=(
            at_most("(4.9) and (4.11) minus the chance of the model", formula, 0.0, ROUNDING),
            at_most(f"(4.12) by {RUNS} runs minus the chance [standard errors]", worst, ERRORS),
        ),
        seed=SEED,
    )


@claim(
    "c4.average",
    "The mean over the cells of a group and the ratio over all cells of a category estimate one number.",
    source="(4.10), Remark 4.1",
    quote="Expected ratio of basally extruded cells in category k = A/B",
    rests_on=("c4.conditional",),
    tried_on="a model with three categories and known chances, whose cells differ by place and share their luck",
)
def _average() -> Evidence:
    """The cells of a run depend on each other: errors by the scatter of ten parts of the runs."""
    kinds, hits = runs(np.random.default_rng(SEED))
    worst = 0.0
    for k in range(len(CHANCE)):
        apart = []
        for part in np.split(np.arange(RUNS), 40):
            inside = kinds[part] == k
            each = [estimate(hits[part, i], inside[:, i]) for i in range(GROUP)]
            apart.append(np.mean(each) - estimate(hits[part], inside))
        worst = max(worst, abs(np.mean(apart)) / (np.std(apart, ddof=1) / np.sqrt(len(apart))))
    return Evidence(
        printed=(at_most("(4.10) by (4.12) minus A/B [standard errors]", float(worst), ERRORS),),
        seed=SEED,
    )


@claim(
    "c4.total",
    (
        "With equally distributed event times the ratios of the categories, weighted by their chances, make "
        "up the ratio of extruded cells."
    ),
    source="(4.7), (4.10)",
    quote="r*(D_k) := 1/N^EMT Σ_i E[δ_i* | T_i ∈ D_k]",
    recorded=Verdict.PROVED,
    rests_on=("c4.conditional",),
)
def _total() -> Evidence:
    """e = E[delta_i 1_{D_k}(T_i)] of a cell with P[T_i in D_k] = p + d in a category with P[D_k] = p, d = 0."""
    e, p, d = library().symbols("e p d", positive=True)
    return proved(
        identity(
            "P[D_k] E[δ_i 1_k]/P[T_i ∈ D_k] = E[δ_i 1_k] for each cell and category, so "
            "Σ_k P[D_k] r(D_k) = 1/N Σ_i Σ_k E[δ_i 1_k] = 1/N Σ_i E[δ_i] = r",
            lambda s: p * e / (p + (1 - s) * d) - e,
            "cells whose times have other chances",
        )
    )
