"""Chapter 5, sections 3.4 and 3.5: the linear case, particles that come close to their limit, and its moments."""

from __future__ import annotations

from math import ceil
from statistics import NormalDist

import numpy as np

from verification.claims import Evidence, Interval, at_least, claim
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.lemmas import ESTIMATE

SEED = 65
DRAWS, TWO_SIDED = 40, NormalDist().inv_cdf(0.975)


def quantiles(count: int) -> Floats:
    """Return points of equal weight that stand for the normal distribution."""
    return np.array([NormalDist().inv_cdf((k + 0.5) / count) for k in range(count)])


FINE = quantiles(2048)


def distance(one: Floats, fine: Floats) -> float:
    """Return W1 of points of equal weight and of a multiple of as many."""
    return float(np.abs(np.repeat(np.sort(one), fine.size // one.size) - np.sort(fine)).mean())


# (5.60) on [0, t] for the empirical measure of the start, d <= c w, and w -> 0, which (5.66) asks for.
d, c, w, e = reals("d c w e")
BOUNDED = [c > 0, w >= 0, e > 0, d <= c * w]

_rate = argument(
    "c5.convergence",
    "Corollary 5.19; section 3.4",
    "‖y − y_k‖ + ‖ẏ − ẏ_k‖ + W₁(μᵗ, μ_kᵗ) ≤ C e^{Lt} W₁(μⁱⁿⁱᵗ, μ_k^emp) → 0",
    "At each time particles converge to the mean-field limit, at the rate of their distance at the start.",
    follows(
        [*BOUNDED, c * w <= e],
        d <= e,
        ([*BOUNDED, c * w <= 2 * e], d <= e),
        "d ≤ C e^{Lt} w is ≤ δ for w ≤ δ/(C e^{Lt})",
        "w ≤ 2δ/(C e^{Lt})",
    ),
    *ESTIMATE,
    also=("c5.limit-in-time",),
    rests_on=("c5.same-estimate", "c5.consistency"),
    chosen="C and L may depend on the time t, which the corollary does not exclude: for all t there are none, see "
    "c5.same-estimate",
)


def draws() -> Floats:
    """Return W1 of 64 and of 1024 random points and the normal distribution, (2, DRAWS)."""
    rng = np.random.default_rng(SEED)
    return np.array([[distance(rng.normal(size=n), FINE) for _draw in range(DRAWS)] for n in (64, 1024)])


@claim(
    "c5.samples",
    "Random positions come close to the distribution that they are drawn from.",
    source="section 3.5",
    quote="the existence of suitable initial conditions such that (5.66) holds is shown in",
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
        printed=(
            at_least(
                f"order in N at which the mean of W₁ falls, N = 64 and 1024, {DRAWS} draws each",
                order,
                0.0,
                interval=interval,
            ),
        ),
        seed=SEED,
        runs_needed=needed,
    )
