"""Chapter 5, section 3.4: the distance of measures and the proof of the stability estimate."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment, linprog

from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, proved, put_right
from verification.formal.enclosures import balls, not_negative
from verification.formal.reals import implication
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.lemmas import gronwall, means_apart
from verification.thesis.chapter5.wavy import M, soft

SEED = 65
LINE = np.linspace(-20.0, 20.0, 2001)


def points() -> tuple[Floats, Floats]:
    """Return two sets of six points in the plane."""
    first, second = np.random.default_rng(SEED).normal(size=(2, 6, 2))
    return first, second + np.array([1.0, 0.5])


def potentials(cost: Floats, assigned: NDArray[np.intp]) -> Floats:
    """Return potentials f for which the least |x_i - y_j| - f_i + g_j, j not the partner of i, is largest.

    g at the partner of i is f_i less their distance.
    """
    size = len(cost)
    own = cost[np.arange(size), assigned]
    rows, bounds = [], []
    for i, j in permutations(range(size), 2):
        rows.append([*(np.eye(size)[i] - np.eye(size)[j]), 1.0])
        bounds.append(cost[i, assigned[j]] - own[j])
    goal = [*np.zeros(size), -1.0]
    return np.asarray(linprog(goal, rows, bounds, bounds=(None, None)).x[:size])


def slack(assigned: NDArray[np.intp]) -> Any:
    """Return a ball for the least slack of the potentials of an assignment, the points being exact."""
    arb, (first, second) = balls().arb, points()
    level = potentials(np.linalg.norm(first[:, None] - second[None], axis=-1), assigned)
    size, least = len(first), None

    def distance(i: int, j: int) -> Any:
        return sum(
            ((arb(a) - arb(b)) * (arb(a) - arb(b)) for a, b in zip(first[i], second[j], strict=True)), arb(0)
        ).sqrt()

    for i, j in permutations(range(size), 2):
        found = distance(i, assigned[j]) - distance(j, assigned[j]) - arb(level[i]) + arb(level[j])
        least = found if least is None else least.min(found)
    return least


@claim(
    "c5.dual",
    "The distance of two measures is the largest difference of the means of a function.",
    source="(5.59); Lemma 5.15",
    also=("c5.integrals",),
    quote="W₁(ν, μ) = sup |∫ϕ dν − ∫ϕ dμ| over ϕ ∈ C(ℝⁿˣ, ℝⁿˣ), Lip(ϕ) ≤ 1",
    recorded=Verdict.PROVED_INSTANCE,
    tried_on="two sets of six points in the plane",
    chosen="ϕ with values in ℝ, see c5.dual-values, and as printed in ℝⁿˣ with a norm for |·|",
)
def _dual() -> Evidence:
    """If f_i - g_j <= |x_i - y_j|, equal for partners, min_j g_j + |z - y_j| has the constant 1 and attains W1."""
    first, second = points()
    best = linear_sum_assignment(np.linalg.norm(first[:, None] - second[None], axis=-1))[1]
    return proved(
        means_apart(),
        not_negative(
            "the best assignment has potentials, so a function ϕ with Lip(ϕ) ≤ 1 whose means differ by its cost "
            "W₁; maps into ℝⁿˣ have no more, e·ϕ being such a function",
            lambda s: slack(best if s == 1 else np.arange(len(first))),
            [],
            "another assignment has potentials",
        ),
    )


@claim(
    "c5.fundamental",
    "Solutions of two equations move apart by at most ϱe^{Lt} + ε/L (e^{Lt} − 1).",
    source="Lemma 5.17",
    quote="‖z₁(t) − z₂(t)‖ ≤ ϱ e^{Lt} + ε/L (e^{Lt} − 1)",
    recorded=Verdict.PROVED,
    chosen="z, z′ ∈ A, see c5.fundamental-set",
)
def _fundamental() -> Evidence:
    return proved(*gronwall())


@claim(
    "c5.push-forward",
    "The right side is Lipschitz continuous in the initial measure with a constant of M_v and C_μ.",
    source="proof of Theorem 5.16",
    quote="‖h(…; μ₁) − h(…; μ₂)‖ = ‖(m_eff(μ₁, y))⁻¹F_eff(μ₁, y, v) − …‖ … L_μ depends only on M_v and C_μ",
    correction=Correction(
        (
            "h contains m_eff(φ#μ, y) and F_eff(φ#μ, y, v); the bound has the factor Lip(φ), which is at most "
            "exp(L_Φ M_v t) for flows"
        ),
        Effect.PROOF,
        "Theorem 5.16 stands with larger C and L",
        why="h contains the image of μ under φ, and ∫k d(φ#μ) = ∫k∘φ dμ, where Lip(k∘φ) is at most Lip(k) Lip(φ)",
        place=3898,
    ),
    rests_on=(
        "c5.any-number",
        "c5.dual",
    ),
    tried_on="two point masses, φ(x) = 100x",
)
def _push_forward() -> Evidence:
    """m_eff of phi # mu for two point masses and phi(x) = k x: how it changes with the distance."""
    k, apart = 100.0, np.pi / 100
    change = float(M * (soft(np.array(k * apart)) ** 2 - soft(np.zeros(())) ** 2))
    bound = float(np.abs(np.diff(M * soft(LINE) ** 2)).max() / (LINE[1] - LINE[0])) * apart
    return Evidence(
        printed=(at_most("change of m_eff(φ#μ, y) for φ(x) = 100x, bound Lip(m_eff) W₁", change, bound),),
        corrected=(at_most("change of m_eff(φ#μ, y) for φ(x) = 100x, bound Lip(φ) Lip(m_eff) W₁", change, k * bound),),
    )


@claim(
    "c5.flow-estimate",
    "Two solutions and their flows move apart by at most the bound of Lemma 5.17.",
    source="(5.64)",
    quote=("‖y₁ − y₂‖ + ‖ẏ₁ − ẏ₂‖ + ‖X₁ᵗ − X₂ᵗ‖_X ≤ ϱ e^{tL_{f1}} + L_μ W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)/Lip(h₁) (e^{tLip(h₁)} − 1)"),
    recorded=Verdict.PROVED,
    rests_on=("c5.fundamental", "c5.right-side", "c5.push-forward"),
    chosen="the notation of c5.flow-norm and c5.flow-constant",
)
def _flow_estimate() -> Evidence:
    """(5.64) is Lemma 5.17 with eps = L_mu W1: the right sides of two measures are that far apart at one point."""
    return proved(
        implication(
            "|h₁(z₁) − h₂(z₂)| ≤ |h₁(z₁) − h₁(z₂)| + |h₁(z₂) − h₂(z₂)| ≤ Lip(h₁)‖z₁ − z₂‖ + L_μ W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
            lambda s, n, a, b, L, u, k, W: (
                [n <= a + b, a <= L * u, b <= k * W, L > 0, u >= 0, k > 0, W > 0],
                n <= L * u + s * k * W,
            ),
            "without W₁",
            0,
        ),
        *gronwall(),
    )


@claim(
    "c5.stability-step",
    "Two measures are at most C_μ‖X₁ᵗ − X₂ᵗ‖ farther apart than at the start.",
    source="(5.65)",
    quote="W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖_X + W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
    correction=Correction(
        "W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖ + Lip(X₂ᵗ) W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
        Effect.PROOF,
        "Theorem 5.16 stands with larger C and L, since Lip(X₂ᵗ) ≤ exp(L_Φ M_v t); it is 1 if all are shifted",
        why=(
            "the function that is integrated over both initial measures is ϕ∘X₂ᵗ, with a Lipschitz constant up to"
            " Lip(ϕ) Lip(X₂ᵗ), and flows stretch"
        ),
        place=3924,
    ),
    rests_on=("c5.dual",),
)
def _stability_step() -> Evidence:
    """One piece of a transport plan from x to z, r = |x - z|: a = |X1(x) - X2(x)|, b = |X2(x) - X2(z)|, L = Lip(X2)."""
    return put_right(
        implication(
            "‖X₁(x) − X₂(z)‖ ≤ ‖X₁(x) − X₂(x)‖ + Lip(X₂ᵗ)‖x − z‖",
            lambda s, n, a, b, r, L: ([r > 0, a >= 0, b >= 0, L > 0, n <= a + b, b <= L * r], n <= a + L**s * r),
            "≤ ‖X₁(x) − X₂(x)‖ + ‖x − z‖",
            0,
        )
    )
