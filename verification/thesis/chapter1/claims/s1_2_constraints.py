"""Chapter 1, sections 1.2 and 1.3: discs with multipliers, and the way to normal cones by energies."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import minimize

import dincl
from verification.claims import claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter1.sets import PLACES, SLOPES, Floats, contact_gradients, subgradients, unlike

SEED = 13
ROUNDING = 1e-12
# What a minimiser leaves that stops at 1e-12 of a square.
MINIMISED = 1e-5
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, math.sqrt(0.75)]])
SIDES = [(0, 1), (0, 2), (1, 2)]
STRENGTH = 1.0


def pairs_of(count: int) -> int:
    """How many distances between discs are constrained, by counting the rows of a set of discs that are far apart."""
    row = 2.0 * np.arange(count)[:, None] * np.ones(2)
    problem = dincl.Problem(row, lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])
    return problem.rows_within(0.0, row, 1e3).values(row).size


@claim(
    "c1.pairs",
    "N discs have as many constraints as pairs.",
    source="before (1.3)",
    quote="Let us define g₁, …, g_M for M = (N over 2)",
    recorded=Kind.NOT_REFUTED,
    tried_on="2, 3, 4 and 7 discs",
)
def _pairs() -> Evidence:
    counts = {n: pairs_of(n) for n in (2, 3, 4, 7)}
    wrong = sum(found != math.comb(n, 2) for n, found in counts.items())
    return Evidence(
        f"Rows of constraints of 2, 3, 4, 7 discs: {', '.join(map(str, counts.values()))}; N over 2 each time.",
        printed=(equal("wrong counts", wrong, 0),),
    )


def nearest_admissible(force: Floats) -> Floats:
    """The velocity nearest to a force with which no two of three touching discs approach, found among velocities."""
    gradients = contact_gradients(TRIANGLE, SIDES)
    found = minimize(
        lambda v: ((v - force) ** 2).sum(),
        np.zeros(6),
        jac=lambda v: 2 * (v - force),
        constraints={"type": "ineq", "fun": lambda v: gradients @ v, "jac": lambda _: gradients},
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 200},
    )
    return np.asarray(found.x)


@claim(
    "c1.multipliers",
    "Discs in contact are pushed apart along the gradients of their distances, with multipliers ≥ 0.",
    source="(1.4), (1.5)",
    quote="Ẋ_i = F_i(X) + Σ λ_k ∇_{X_i} g_k(X), g_k ≥ 0, λ_k ≥ 0 and λ_k g_k = 0",
    recorded=Kind.NOT_REFUTED,
    tried_on="three touching discs, 20 random forces",
)
def _multipliers() -> Evidence:
    """lambda from v = F + sum lambda grad g, without asking for its sign."""
    gradients = contact_gradients(TRIANGLE, SIDES)
    least, left, product = math.inf, 0.0, 0.0
    for force in np.random.default_rng(SEED).normal(size=(20, 6)):
        v = nearest_admissible(force)
        multipliers = np.linalg.lstsq(gradients.T, v - force, rcond=None)[0]
        least = min(least, float(multipliers.min()))
        left = max(left, float(np.abs(force + multipliers @ gradients - v).max()))
        product = max(product, float(np.abs(multipliers * (gradients @ v)).max()))
    return Evidence(
        f"Three touching discs, 20 forces: the nearest velocity without approach is F + Σ λ_k ∇g_k to {left:.0e}, the "
        f"least of the λ_k is {least:.0e}, and λ_k d/dt g_k = 0 to {product:.0e}.",
        printed=(
            at_most("|F + Σ λ ∇g - v|", left, MINIMISED),
            at_least("least multiplier", least, -MINIMISED),
            at_most("|λ d/dt g|", product, MINIMISED),
        ),
        seed=SEED,
    )


def depth(force: float) -> float:
    """How deep (1.8) with W_n = n dist(x, [0, ∞)) lets a point sink that is pushed down for a time of 1."""
    h, x = 1e-3, 0.0
    for _ in range(1000):
        x = min(x + h * ((STRENGTH if x < 0 else 0.0) - force), 0.1)
    return max(-x, 0.0)


@claim(
    "c1.penalty-force",
    "The energy n dist(x, S) holds a point back unless the force is too large.",
    source="(1.7), (1.8)",
    quote="but if F is large enough, it could push x into the unfeasible region.",
    chosen="S = [0, ∞) and a constant force; “large enough” is |F| > n",
)
def _penalty() -> Evidence:
    weak, strong = depth(0.9 * STRENGTH), depth(1.5 * STRENGTH)
    return Evidence(
        f"S = [0, ∞): pushed with 0.9 n the point stays within a step of S ({weak:.1e}), pushed with 1.5 n it is "
        f"{strong:.2f} below after a time of 1/n.",
        printed=(at_most("depth, |F| < n", weak, 1e-3), equal("depth, |F| = 1.5 n", strong, 0.5, 2e-3)),
    )


def indicator(x: Floats) -> Floats:
    """I_S for S = [0, 1]."""
    return np.where((x >= 0) & (x <= 1), 0.0, np.inf)


@claim(
    "c1.indicator",
    "The penalty energies tend to the indicator function.",
    source="section 1.3",
    quote="W(x) := lim sup W_n(x) = I_S(x) = ∞ if x ∉ S, 0 if x ∈ S",
    recorded=Kind.NOT_REFUTED,
    tried_on="the interval [0, 1]; S is closed, as the sets of the model are: the derivation is called informal",
)
def _indicator() -> Evidence:
    """n dist(x, [0, 1]) for a large n, the distance as a minimum over points of S."""
    s = PLACES[(PLACES >= 0) & (PLACES <= 1)]
    energy = 1e12 * np.abs(PLACES[:, None] - s).min(axis=1)
    there = np.isfinite(indicator(PLACES))
    inside, beyond = float(energy[there].max()), float(energy[~there].min())
    return Evidence(
        f"S = [0, 1], n = 10¹²: n dist is at most {inside:g} at places of S, its ends included, and at least "
        f"{beyond:.1e} elsewhere.",
        printed=(at_most("n dist in S", inside, 0.0), at_least("n dist outside of S", beyond, 1e9)),
    )


@claim(
    "c1.subdifferential",
    "The subdifferential of the indicator function of [0, 1].",
    source="after (1.9)",
    quote="∂W(x) = {0} if x ∈ (0, 1), ∅ if x < 0 or x > 1, (-∞, 0] if x = 0, [0, ∞) if x = 1",
)
def _subdifferential() -> Evidence:
    printed = {0.5: SLOPES[SLOPES == 0], -0.5: SLOPES[:0], 1.5: SLOPES[:0]}
    printed |= {0.0: SLOPES[SLOPES <= 0], 1.0: SLOPES[SLOPES >= 0]}
    wrong = sum(unlike(subgradients(indicator, x), slopes) for x, slopes in printed.items())
    return Evidence(
        f"By (1.9), slopes from {SLOPES[0]:g} to {SLOPES[-1]:g} at x = -1/2, 0, 1/2, 1, 3/2: {wrong} are in one of the "
        "measured and the printed set only.",
        printed=(equal("slopes in one of the sets only", wrong, 0),),
    )
