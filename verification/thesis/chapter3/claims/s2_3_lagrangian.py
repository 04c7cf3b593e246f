"""Chapter 3, section 2.3: the constraints, the Lagrangian and the equilibria on which the minimisers rest."""

from __future__ import annotations

import math
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

import dincl
from verification.claims import Correction, Effect, Evidence, Verdict, at_least, at_most, claim, equal, proved
from verification.formal.algebra import identity
from verification.formal.reals import implication, solver_library

Floats = NDArray[np.float64]
SEED = 37
SAMPLES = 1000
# The hard radius, the largest distance of neighbouring basal points [R_soft], and a small tissue.
HARD, MOST, CELLS = 1 / 3, 1 / 3, 5


def states() -> Floats:
    """Return nuclei, apical and basal points of CELLS cells, shape (SAMPLES, 3 CELLS, 2); many are not feasible."""
    rng = np.random.default_rng(SEED)
    z = rng.uniform(0.0, 3.0, (SAMPLES, 3 * CELLS, 2))
    z[:, 2 * CELLS :, 0] = rng.uniform(-0.05, 1.2 * MOST, (SAMPLES, CELLS)).cumsum(axis=1)
    z[:, 2 * CELLS :, 1] *= rng.uniform(size=(SAMPLES, 1)) < 0.2
    return z


def apart(nuclei: Floats) -> bool:
    """Return whether (C1) holds, as printed."""
    return all(math.dist(one, other) >= 2 * HARD for one, other in combinations(nuclei.tolist(), 2))


def lined_up(basal: Floats) -> bool:
    """Return whether (C2), (C3) and (C4) hold, as printed."""
    steps = [(math.dist(basal[i], basal[j]), basal[j, 0] - basal[i, 0]) for i, j in pairwise(range(CELLS))]
    return all(length <= MOST and step >= 0 for length, step in steps) and not basal[:, 1].any()


def in_all(z: Floats) -> bool:
    """Return whether z lies in each S_j of (C1), (C4) and (C2), sets of the program, and (C3) holds."""
    chain = np.arange(2 * CELLS, 3 * CELLS)
    sets = (
        dincl.NonOverlap(HARD, among=np.arange(CELLS)),
        dincl.Ordered(chain, axis=0),
        dincl.MaxDistance(np.column_stack((chain[1:], chain[:-1])), MOST),
    )
    return bool(all((one.select(z, 0.0).values(z) >= 0).all() for one in sets) and not z[chain, 1].any())


@claim(
    "c3.feasible-set",
    (
        "S is the intersection of the sets of single constraints: the nuclei that meet (C1), times all apical"
        " points, times a convex set of basal points. So S is prox-regular if the set of (C1) is."
    ),
    source="(3.16), sections 3.2 and 3.3",
    quote="S = ⋂_{j=1}^M S_j, which is the key assumption for the application of PBD",
    rests_on=("c3.equal-radii",),
    chosen="1000 random states of 5 cells; equal hard radii, as in Proposition 1.22; for others see c3.equal-radii",
)
def _set() -> Evidence:
    """Put nuclei and basal points of different states together, and take midpoints."""
    z, split = states(), 2 * CELLS
    nuclei = [one[:CELLS] for one in z if apart(one[:CELLS])]
    basal = [one[split:] for one in z if lined_up(one[split:])]
    wrong = sum(in_all(one) != (apart(one[:CELLS]) and lined_up(one[split:])) for one in z)
    mixed = sum(not in_all(np.vstack((x, z[0, CELLS:split], b))) for x, b in zip(nuclei, basal, strict=False))
    flat = sum(not lined_up((b + other) / 2) for b, other in pairwise(basal))
    bent = sum(not apart((x + other) / 2) for x, other in pairwise(nuclei))
    return Evidence(
        printed=(
            equal("states in S as printed or in all S_j of the program, but not in both", wrong, 0.0),
            equal("feasible nuclei that do not go with feasible basal points of another state", mixed, 0.0),
            equal(f"midpoints of {len(basal)} feasible basal layers that are not feasible", flat, 0.0),
            at_least(
                "feasible states, the lesser of nuclei and basal layers", min(len(nuclei), len(basal)), SAMPLES / 20
            ),
            at_least("midpoints of feasible nuclei that are not feasible", bent, 1),
        ),
        seed=SEED,
    )


@claim(
    "c3.constraint-count",
    "A tissue of N cells has N(N − 1)/2 + 2(N − 1) + N scalar constraints.",
    source="section 2.3",
    quote="in the setup of Section 2.2.7 we have M = N(N-1)/2 + 2(N-1) + N constraints",
    recorded=Verdict.PROVED,
    chosen="the basal line counts as one constraint for each cell",
)
def _count() -> Evidence:
    """Use induction: one more cell brings a pair with each of the N before, an edge of two constraints, and (C3)."""
    return proved(
        identity(
            "M = N(N − 1)/2 + 2(N − 1) + N is 1 for one cell and grows by N + 2 + 1 with the cell N + 1",
            lambda s, n: [
                (n + 1) * n / 2 + 2 * n + n + 1 - (n * (n - 1) / 2 + 2 * (n - 1) + n) - (n + s * 2 + 1),
                (n * (n - 1) / 2 + 2 * (n - 1) + n).subs(n, 1) - 1,
            ],
            "without (C2), (C4)",
            0,
        )
    )


def basal_pairs() -> Floats:
    """Return x of two neighbouring basal points, shape (SAMPLES, 2), in either order."""
    return np.random.default_rng(SEED).uniform(-1.0, 1.0, (SAMPLES, 2))


@claim(
    "c3.squared",
    "All four kinds of constraints can be taken squared.",
    source="section 2.3",
    quote=(
        "Since the convergence rates can depend on the representation, we define g_ℓ as the square of (C1) to (C4)."
    ),
    correction=Correction(
        "distances (C1), (C2) are squared; the order (C4) is taken as it stands, and (C3) is eliminated",
        Effect.NOTATION,
        "(3.19) and every method that uses these g_ℓ",
        why="(C3) is an equation and (C4) has a sign that its square loses",
        place=1949,
    ),
    chosen="(C4) squared as (x(B_j) − x(B_i))² ≥ 0 or as x(B_j)² ≥ x(B_i)², for 1000 random pairs in either order; a "
    "multiplier can push along a constraint only if its gradient is not 0",
)
def _squared() -> Evidence:
    left, right = basal_pairs().T
    answers = ((right - left) ** 2 >= 0, left**2 <= right**2, right - left >= 0)
    wrong = [int((told != (left <= right)).sum()) for told in answers]
    h = 1e-6
    signed = abs(min(0.0, h) ** 2 - min(0.0, -h) ** 2) / (2 * h)
    return Evidence(
        printed=(equal("pairs judged wrongly by the better of two squares", min(wrong[:2]), 0.0),),
        corrected=(
            equal("pairs judged wrongly by (C4) as it is", wrong[2], 0.0),
            at_most("gradient of −min(0, x(B_j) − x(B_i))² where (C4) is met", signed, 0.0, 1e-5),
        ),
        seed=SEED,
    )


@claim(
    "c3.saddle",
    "inf sup of ℒ = W + Σ λ_ℓ min(0, g_ℓ) over all λ gives the minima of W over S.",
    source="(3.20)",
    quote="Solutions of (3.20) will also be solutions of the original problem (3.18).",
    recorded=Verdict.PROVED,
)
def _saddle() -> Evidence:
    """Take m = min(0, g(z)) of one row; sup over lambda of W + lambda m is W for m = 0 and infinite for m < 0."""
    return proved(
        implication(
            "ℒ = W for every λ where g ≥ 0", lambda s, W, level, m, L: ([m == 0, W + level * m == L], s * W == L), "−W"
        ),
        implication(
            "where g < 0 ℒ is above any K for λ = (K − W + 1)/g: inf sup ℒ is taken in S, at the least W",
            lambda s, W, K, m, level, L: ([m < 0, level * m == s * (K - W + 1), W + level * m == L], L > K),
            "λ = −(K − W + 1)/g",
        ),
    )


@claim(
    "c3.rests",
    "A constrained minimum, with its multipliers, is an equilibrium of both systems.",
    source="(3.21) to (3.23)",
    quote=(
        "The dynamical system (3.21) and (3.22) has every solution of (3.18) as an equilibrium. … (3.23) … "
        "has also all solutions of (3.18) as equilibria."
    ),
    recorded=Verdict.PROVED,
    chosen="multipliers ≤ 0 for (3.21), ≥ 0 for (3.23), as their signs ask for",
)
def _rest() -> Evidence:
    """Take one component and one row: w of grad W, j of grad g; a minimum has w = l j, l >= 0, g >= 0, l g = 0."""
    z3 = solver_library()
    return proved(
        implication(
            "with ∇W = Σ λ∇g, λg = 0 the right sides of (3.21), λ ≤ 0, of (3.22) and of (3.23), λ ≥ 0, vanish",
            lambda s, w, j, level, g, a, b, c: (
                [w == level * j, level >= 0, g >= 0, level * g == 0],
                [
                    a * (w + s * (-level) * j) == 0,
                    z3.Or(z3.And(level == 0, g >= 0), -b * g == 0),
                    a * (w - level * j) + c * level * g * j == 0,
                ],
            ),
            "λ ≥ 0 in (3.21)",
        )
    )
