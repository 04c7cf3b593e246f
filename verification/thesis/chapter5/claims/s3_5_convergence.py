"""Chapter 5, sections 3.4 and 3.5: the linear case, particles that come close to their limit, and its moments."""

from __future__ import annotations

from math import ceil
from statistics import NormalDist
from typing import Any

import numpy as np

from verification.claims import Evidence, Interval, Verdict, at_least, claim, proved
from verification.formal.algebra import identity, library, matrices
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.lemmas import estimate

SEED = 65
DRAWS, TWO_SIDED = 40, NormalDist().inv_cdf(0.975)


@claim(
    "c5.shifted",
    "With linear constraints the measure is only shifted.",
    source="Remark 5.18",
    quote="there is a vector w(t) such that μⁱⁿⁱᵗ(A) = μᵗ(A − w(t))",
    recorded=Verdict.PROVED,
    rests_on=("c5.linear-map",),
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
    "With linear constraints (5.65) holds as printed, without the Lipschitz constant of the flow.",
    source="Remark 5.18",
    quote=(
        "in the linear case the third step in the proof is easier, since the particle distribution will only be shifted"
    ),
    recorded=Verdict.PROVED,
    rests_on=("c5.linear-map", "c5.stability-step"),
    chosen="the step that leads from (5.64) to (5.65), the last one of the proof, which is about the distribution",
)
def _linear_step() -> Evidence:
    """The flow by the constraint; then one piece of a transport plan from x to z, r = |x - z|.

    a = |X1(x) - X2(x)| and b = |X2(x) - X2(z)|.
    """
    x, z, y, start, G = (library().Symbol(name) for name in ("x", "z", "y", "y_init", "G"))

    def apart(s: Any) -> Any:
        first, second = (X + G * (y - start) if s == 1 else X * y / start for X in (x, z))
        return first - second - (x - z)

    return proved(
        identity(
            "X₂ᵗ(x) − X₂ᵗ(x′) = x − x′ for X₂ᵗ(x) = x + G(y − yⁱⁿⁱᵗ), each coordinate, so Lip(X₂ᵗ) = 1",
            apart,
            "for Example 5.2, X₂ᵗ(x) = xy/yⁱⁿⁱᵗ",
        ),
        implication(
            "so ‖X₁ᵗ(x) − X₂ᵗ(x′)‖ ≤ ‖X₁ᵗ(x) − X₂ᵗ(x)‖ + ‖x − x′‖ for each piece of a transport plan: (5.65)",
            lambda s, n, a, b, r: ([r > 0, a >= 0, n <= a + b, b == (r if s == 1 else 2 * r)], n <= a + r),
            "for Lip(X₂ᵗ) = 2",
        ),
    )


def quantiles(count: int) -> Floats:
    """Return points of equal weight that stand for the normal distribution."""
    return np.array([NormalDist().inv_cdf((k + 0.5) / count) for k in range(count)])


FINE = quantiles(2048)


def distance(one: Floats, fine: Floats) -> float:
    """Return W1 of points of equal weight and of a multiple of as many."""
    return float(np.abs(np.repeat(np.sort(one), fine.size // one.size) - np.sort(fine)).mean())


@claim(
    "c5.convergence",
    "At each time particles converge to the mean-field limit, at the rate of their distance at the start.",
    source="Corollary 5.19; section 3.4",
    also=("c5.limit-in-time",),
    quote="‖y − y_k‖ + ‖ẏ − ẏ_k‖ + W₁(μᵗ, μ_kᵗ) ≤ C e^{Lt} W₁(μⁱⁿⁱᵗ, μ_k^emp) → 0",
    recorded=Verdict.PROVED,
    rests_on=("c5.same-estimate", "c5.consistency"),
    chosen="C and L may depend on the time t, which the corollary does not exclude: for all t there are none, see "
    "c5.same-estimate",
)
def _rate() -> Evidence:
    """(5.60) on [0, t] for the empirical measure of the start, d <= c w, and w -> 0, which (5.66) asks for."""
    return proved(
        implication(
            "d ≤ C e^{Lt} w is ≤ δ for w ≤ δ/(C e^{Lt})",
            lambda s, d, c, w, e: ([c > 0, w >= 0, e > 0, d <= c * w, c * w <= s * e], d <= e),
            "w ≤ 2δ/(C e^{Lt})",
            2,
        ),
        *estimate(),
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


@claim(
    "c5.closure",
    "The transport equation gives equations for the moments of the density.",
    source="Remark 5.20",
    quote="find equations for the first moments by inserting this ansatz into the (5.42a) and (5.42b)",
    recorded=Verdict.PROVED_INSTANCE,
    rests_on=("c5.shear-flow", "c5.transport"),
    tried_on="Example 5.4, all points and weights",
    chosen="Example 5.4 with y(t) given, where the equations close without an assumption on the density",
)
def _closed() -> Evidence:
    """The moments of one point that follows x' = A x with A = F(y')F(y)^-1; measures are sums of points."""
    A, AT, x, xT = matrices("A AT x xT")
    return proved(
        identity(
            "ρ̇ = Aρ and σ̇ = Aσ + σAᵀ for each point x with ẋ = Ax, so the first two moments close",
            lambda s: [A * x * xT + x * (xT * AT) - (A * (x * xT) + s * (x * xT) * AT)],
            "−σAᵀ",
        )
    )


@claim(
    "c5.mass",
    "The transport equation keeps the number of particles.",
    source="(5.68)",
    quote="ṁ(t) = 0, conservation of mass",
    recorded=Verdict.PROVED,
    rests_on=("c5.transport",),
    chosen="m is that of (5.67), not the mass of a particle",
)
def _mass() -> Evidence:
    """In each coordinate: the rate of the mass between a and b is what flows through the ends."""
    sp = library()
    x, a, b = sp.symbols("x a b", real=True)
    flux = sp.Function("q")(x)

    def residual(s: Any) -> Any:
        return sp.integrate(-flux.diff(x), (x, a, b)) + flux.subs(x, b) - s * flux.subs(x, a)

    return proved(
        identity(
            "∫ₐᵇ ∂_t f dx = q(a) − q(b) for (5.42b), q = fΦ[ẏ]: with no flux at the ends the mass is constant",
            residual,
            "−q(a)",
        )
    )
