"""Chapter 5, sections 3.4 and 3.5: the linear case, and particles that come close to the mean-field limit."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from math import ceil
from statistics import NormalDist

import numpy as np

from verification.claims import Evidence, Interval, Verdict, at_least, proved
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter5.claims.s3_4_estimate import estimate
from verification.thesis.chapter5.instant import Floats
from verification.thesis.text.quoted import claim

SEED = 65
DRAWS, TWO_SIDED = 40, NormalDist().inv_cdf(0.975)


@claim(
    "c5.shifted",
    "With linear constraints the measure is only shifted.",
    "Remark 5.18",
    Verdict.PROVED,
)
def _shifted() -> Evidence:
    """Any set A of the line (of each coordinate): x is in A just if x + d is in A - w, that is x + d + w in A."""
    z3 = solver_library()
    A = z3.Function("A", z3.RealSort(), z3.BoolSort())
    return proved(
        implication(
            "μⁱⁿⁱᵗ(A) = μᵗ(A − w) for every A with w = −G(y(t) − yⁱⁿⁱᵗ)",
            lambda s, x, d, w: ([w == -s * d], A(x) == A(x + d + w)),
            "w = G(y(t) − yⁱⁿⁱᵗ)",
        )
    )


@claim(
    "c5.linear-step",
    "For measures that are shifted the last step of the proof needs nothing else.",
    "Remark 5.18",
    Verdict.PROVED,
    chosen="the step that leads from (5.64) to (5.65), the last one of the proof, which is about the distribution",
)
def _linear_step() -> Evidence:
    """One piece of a transport plan in one coordinate: x, z move by a and b; e >= |x - z|, f >= |a - b|, C_mu >= 1."""
    return proved(
        implication(
            "|x + a − x′ − b| ≤ |x − x′| + C_μ|a − b| for each piece of a transport plan, so W₁(μ₁ᵗ, μ₂ᵗ) ≤ "
            "C_μ‖X₁ᵗ − X₂ᵗ‖ + W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
            lambda s, x, z, a, b, e, f, C: (
                [C >= 1, e >= x - z, e >= z - x, f >= a - b, f >= b - a],
                [x + a - z - b <= s * (e + C * f), z + b - x - a <= s * (e + C * f)],
            ),
            "half of the right side",
            0.5,
        )
    )


def quantiles(count: int) -> Floats:
    """Points of equal weight that stand for the normal distribution."""
    return np.array([NormalDist().inv_cdf((k + 0.5) / count) for k in range(count)])


FINE = quantiles(2048)


def distance(one: Floats, fine: Floats) -> float:
    """W1 of points of equal weight and of a multiple of as many."""
    return float(np.abs(np.repeat(np.sort(one), fine.size // one.size) - np.sort(fine)).mean())


@claim(
    "c5.convergence",
    "Particles converge to the mean-field limit, at the rate of their distance at the start.",
    "Corollary 5.19",
    Verdict.PROVED,
)
def _rate() -> Evidence:
    """(5.60) for the empirical measure of the start, d <= c w, and w -> 0, which (5.66) asks for."""
    return proved(
        implication(
            "d ≤ C e^{Lt} w with w ≤ δ/(C e^{Lt}) gives d ≤ δ: as w → 0, so does d",
            lambda s, d, c, w, e: ([c > 0, w >= 0, e > 0, d <= c * w, c * w <= s * e], d <= e),
            "w ≤ 2δ/(C e^{Lt})",
            2,
        ),
        *estimate(),
    )


def draws() -> Floats:
    """W1 of 64 and of 1024 random points and the normal distribution, (2, DRAWS)."""
    rng = np.random.default_rng(SEED)
    return np.array([[distance(rng.normal(size=n), FINE) for _draw in range(DRAWS)] for n in (64, 1024)])


@claim(
    "c5.samples",
    "Random positions come close to the distribution that they are drawn from.",
    "section 3.5",
    Verdict.NOT_REFUTED,
    tried_on="a normal distribution on a line, N = 64 and 1024",
)
def _samples() -> Evidence:
    """Random initial positions: the logarithm of the ratio of the mean distances, with its interval."""
    found = draws()
    means, spreads = found.mean(axis=1), found.std(axis=1, ddof=1)
    order = float(np.log(means[0] / means[1]) / np.log(1024 / 64))
    error = TWO_SIDED * float(np.sqrt(((spreads / means) ** 2).sum() / DRAWS)) / np.log(1024 / 64)
    interval: Interval = (order - error, order + error)
    needed = ceil(DRAWS * (error / order) ** 2) + 1
    return Evidence(
        f"{DRAWS} times 64 and 1024 independent points of a normal distribution: W₁ to it is {means[0]:.3f} and "
        f"{means[1]:.4f} in the mean, so it falls like N to the power −{order:.2f} ± {error:.2f}.",
        printed=(at_least("order in N at which W₁ falls", order, 0.0, interval=interval),),
        seed=SEED,
        runs_needed=needed,
    )
