"""Chapter 5, sections 3.4 and 3.5: the linear case, particles that come close to their limit, and its moments."""

from __future__ import annotations

from math import ceil
from statistics import NormalDist

import numpy as np

from verification.claims import Evidence, Interval, at_least, claim
from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument, identity, implication
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.lemmas import ESTIMATE

sp = library()

SEED = 65
DRAWS, TWO_SIDED = 40, NormalDist().inv_cdf(0.975)

# Any set A of the line (of each coordinate): x is in A just if x + d is in A - w, that is x + d + w in A.
z3 = solver_library()
member = z3.Function("A", z3.RealSort(), z3.BoolSort())
place, shift, back = reals("x d w")
SAME = member(place) == member(place + shift + back)

_shifted = implication(
    "c5.shifted",
    "Remark 5.18",
    "there is a vector w(t) such that μⁱⁿⁱᵗ(A) = μᵗ(A − w(t))",
    "With linear constraints the measure is only shifted.",
    given=[back == -shift],
    then=SAME,
    wrong=([back == shift], SAME),
    rests_on=("c5.linear-map",),
)

# The flow by the constraint, and that of Example 5.2; then one piece of a transport plan from x to z, r = |x - z|:
# first = |X1(x) - X2(x)|, second = |X2(x) - X2(z)|.
x, z, y, start, G = sp.symbols("x z y y_init G")
apart, first, second, r = reals("n a b r")
PIECE = [r > 0, first >= 0, apart <= first + second]

_linear_step = argument(
    "c5.linear-step",
    "Remark 5.18",
    "in the linear case the third step in the proof is easier, since the particle distribution will only be shifted",
    "With linear constraints (5.65) holds as printed, without the Lipschitz constant of the flow.",
    vanishes(
        x + G * (y - start) - (z + G * (y - start)) - (x - z),
        x * y / start - z * y / start - (x - z),
        "X₂ᵗ(x) − X₂ᵗ(x′) = x − x′ for X₂ᵗ(x) = x + G(y − yⁱⁿⁱᵗ), each coordinate, so Lip(X₂ᵗ) = 1",
        "for Example 5.2, X₂ᵗ(x) = xy/yⁱⁿⁱᵗ",
    ),
    follows(
        [*PIECE, second == r],
        apart <= first + r,
        ([*PIECE, second == 2 * r], apart <= first + r),
        "so ‖X₁ᵗ(x) − X₂ᵗ(x′)‖ ≤ ‖X₁ᵗ(x) − X₂ᵗ(x)‖ + ‖x − x′‖ for each piece of a transport plan: (5.65)",
        "for Lip(X₂ᵗ) = 2",
    ),
    rests_on=("c5.linear-map", "c5.stability-step"),
    chosen="the step that leads from (5.64) to (5.65), the last one of the proof, which is about the distribution",
)


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


# The moments of one point; measures are sums of points.
A, AT, point, pointT = matrices("A AT x xT")
SECOND = A * point * pointT + point * (pointT * AT) - A * (point * pointT)

_closed = identity(
    "c5.closure",
    "Remark 5.20",
    "find equations for the first moments by inserting this ansatz into the (5.42a) and (5.42b)",
    "The first two moments close: ρ̇ = Aρ and σ̇ = Aσ + σAᵀ for points that follow ẋ = Ax, A = F(ẏ)F(y)⁻¹.",
    right=SECOND - (point * pointT) * AT,
    wrong=SECOND + (point * pointT) * AT,
    rests_on=("c5.shear-flow", "c5.transport"),
    tried_on="Example 5.4, all points and weights",
    chosen="Example 5.4 with y(t) given, where the equations close without an assumption on the density",
)

# In each coordinate: the rate of the mass between a and b is what flows through the ends; q = f Phi[y'].
at, a, b = sp.symbols("x a b", real=True)
flux = sp.Function("q")
CHANGE = sp.integrate(-flux(at).diff(at), (at, a, b))

_mass = identity(
    "c5.mass",
    "(5.68)",
    "ṁ(t) = 0, conservation of mass",
    "The transport equation keeps the number of particles.",
    right=CHANGE + flux(b) - flux(a),
    wrong=CHANGE + flux(b) + flux(a),
    rests_on=("c5.transport",),
    chosen="m is that of (5.67), not the mass of a particle",
)
