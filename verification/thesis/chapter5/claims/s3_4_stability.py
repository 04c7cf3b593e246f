"""Chapter 5, sections 3.4 and 4: the distance of measures, the stability estimate (5.60) and its constants."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import reals
from verification.claims.formal.stated import argument, implication
from verification.thesis.chapter5.instant import Floats, runge_kutta, soft
from verification.thesis.chapter5.lemmas import ESTIMATE, GRONWALL, MEANS_APART

# A fibre with forces and interaction that fulfils all assumptions of section 2.4: g = X + sin(X)/2 - y, W0 = -cos y,
# W1 = sqrt(1 + X^2), V(r) = sqrt(1 + r^2); Phi and Omega do not depend on y.
MASS = 0.7


def omega(x: Floats) -> Floats:
    """Return Omega(X)[1, 1] = Phi'(X) Phi(X)."""
    return np.asarray(np.sin(x) / 2 * soft(x) ** 3)


def root(x: Floats) -> Floats:
    """Return x/sqrt(1 + x^2): the slope of sqrt(1 + x^2), bounded by 1 and with slopes of at most 1."""
    return np.asarray(x / np.sqrt(1 + x**2))


class FlowState(NamedTuple):
    """Atoms X with weights w that sum to 1, and y, v of the macroscopic component."""

    X: Floats
    w: Floats
    y: float
    v: float


def mass(at: FlowState) -> float:
    """Return m_eff of (5.41a)."""
    return float(1 + MASS * (at.w @ soft(at.X) ** 2))


def force(at: FlowState) -> float:
    """Return F_eff of (5.41b), with -m Phi^T Omega[v, v]."""
    pull = at.w @ root(at.X[:, None] - at.X[None, :])
    each = -root(at.X) + pull - MASS * omega(at.X) * at.v**2
    return float(-np.sin(at.y) + at.w @ (soft(at.X) * each))


w, x, shift = library().symbols("w x a", positive=True)

_dual = argument(
    "c5.dual",
    "(5.59); Lemma 5.15",
    "W₁(ν, μ) = sup |∫ϕ dν − ∫ϕ dμ| over ϕ ∈ C(ℝⁿˣ, ℝⁿˣ), Lip(ϕ) ≤ 1",
    "The distance of two measures is the largest difference of the means of a function.",
    MEANS_APART,
    vanishes(
        w * (x + shift) - w * x - w * shift,
        w * (x + shift) - w * x - 2 * w * shift,
        "ϕ(x) = x, with Lip(ϕ) = 1, attains the cost of moving all mass by a",
        "the cost of moving it by 2a",
    ),
    also=("c5.integrals",),
    tried_on="a measure on a line and its shift",
    chosen="ϕ with values in ℝ, see c5.dual-values, and as printed in ℝⁿˣ with a norm for |·|",
)

_fundamental = argument(
    "c5.fundamental",
    "Lemma 5.17; (5.64)",
    "‖z₁(t) − z₂(t)‖ ≤ ϱ e^{Lt} + ε/L (e^{Lt} − 1)",
    "Solutions of two equations move apart by at most ϱe^{Lt} + ε/L (e^{Lt} − 1).",
    *GRONWALL,
    also=("c5.flow-estimate",),
    chosen="z, z′ ∈ A, see c5.fundamental-set",
)


# One piece of a transport plan from x to z, r = |x - z|: a = |X1(x) - X2(x)|, b = |X2(x) - X2(z)|, L = Lip(X2).
n, a, b, r, L = reals("n a b r L")

_stability_step = implication(
    "c5.stability-step",
    "(5.65)",
    "W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖_X + W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
    "Two measures are at most C_μ‖X₁ᵗ − X₂ᵗ‖ farther apart than at the start.",
    given=[r > 0, a >= 0, b >= 0, L > 0, n <= a + b, b <= L * r],
    then=n <= a + L * r,
    wrong=n <= a + r,
    correction=Correction(
        "W₁(μ₁ᵗ, μ₂ᵗ) ≤ C_μ‖X₁ᵗ − X₂ᵗ‖ + Lip(X₂ᵗ) W₁(μ₁ⁱⁿⁱᵗ, μ₂ⁱⁿⁱᵗ)",
        Effect.PROOF,
        "Theorem 5.16 stands with larger C and L, since Lip(X₂ᵗ) ≤ exp(L_Φ M_v t); it is 1 if all are shifted",
        why=(
            "the function that is integrated over both initial measures is ϕ∘X₂ᵗ, with a Lipschitz constant up to "
            "Lip(ϕ) Lip(X₂ᵗ), and flows stretch"
        ),
        place=3924,
    ),
    rests_on=("c5.dual",),
)


# What steps of a run leave.
RUN_TOL = 1e-6
# The mass of the particles beside that of the macroscopic component, and how far they are apart at first.
M, APART = 0.01, 1e-15


def amplified(force: Callable[[float], float], y: float, v: float, time: float = 1.0) -> float:
    """Return log W1(time)/W1(0) of point masses at 0 and at APART, on g = sinh(X) exp(-y), so Phi = tanh X."""

    def rate(z: Floats) -> Floats:
        moved = np.tanh(z[2])
        curved = moved * (1 - moved**2) * z[1] ** 2
        return np.array([z[1], (force(z[0]) - M * moved * curved) / (1 + M * moved**2), moved * z[1]])

    end = runge_kutta(rate, np.array([y, v, APART]), time)[-1]
    return float(np.log(end[2] / APART))


@claim(
    "c5.stability-constants",
    "The constants of the stability estimate are the same for all starts of one energy and moment.",
    source="Theorem 5.16",
    quote="for some constants L, C > 0 which do only depend on the initial total energy of both states and on … C_μ",
    correction=Correction(
        (
            "for potentials that are bounded below; L then depends on the energy above their infimum. Otherwise C and "
            "L depend on the largest speed up to the time t"
        ),
        Effect.CONCLUSION,
        "Theorem 5.16 and Corollary 5.19, as far as C and L are said to be independent of the start and of time",
        why=(
            "L contains the bound of the speed, which follows from the energy only if the potential energy is bounded "
            "below"
        ),
        place=3854,
    ),
    rests_on=("c5.fundamental", "c5.stability-step", "c5.speed-bound"),
    tried_on="three starts in one potential ≥ 0",
    chosen="two point masses, g = sinh(X)e⁻ʸ, W₀ = −y, no other forces",
)
def _constants() -> Evidence:
    """Starts of one energy and one first moment: in free fall, and in a potential sqrt(1 + y^2) - y >= 0."""
    falling = [amplified(lambda _: 1.0, v**2 / 2, v) for v in (1.0, 10.0)]
    energy = 2.0
    held = []
    for y in (0.0, 5.0, 500.0):
        v = float(np.sqrt(2 * (energy - (np.sqrt(1 + y**2) - y))))
        held.append(amplified(lambda y: float(1 - y / np.sqrt(1 + y**2)), y, v))
    bound = float(np.sqrt(2 * energy))
    return Evidence(
        printed=(
            at_most(
                "log(W₁(1)/W₁(0)) for v = 10 over the same for v = 1, W₀ = −y, E = 0, C_μ = 1",
                falling[1] / falling[0],
                1.0,
                RUN_TOL,
            ),
        ),
        corrected=(
            at_most(
                "log(W₁(1)/W₁(0)) for W₀ = √(1 + y²) − y, E = 2, three starts, bound √(2E)", max(held), bound, RUN_TOL
            ),
        ),
    )


def moved(X: Floats, y: float, v: float) -> Floats:
    """Return (y, y', X_1, ...) at t = 2 for particles of equal weight on the fibre of ``bounded``."""
    w = np.full(X.size, 1 / X.size)

    def rate(z: Floats) -> Floats:
        at = FlowState(z[2:], w, float(z[0]), float(z[1]))
        return np.concatenate([[at.v, force(at) / mass(at)], soft(at.X) * at.v])

    return np.asarray(runge_kutta(rate, np.concatenate([[y, v], X]), 2.0, 40)[-1])


@claim(
    "c5.same-estimate",
    "With nonlinear constraints the distance of solutions is at most C e^{Lt} times that of their starts, for all t.",
    source="section 4; section 1",
    also=("c5.abstract-estimate",),
    quote="the same stability estimate as in the linear case also holds for nonlinear constraints",
    correction=Correction(
        (
            "it holds on each [0, T], with C and L that depend on the largest speed up to T, and for all times if "
            "potentials are bounded below"
        ),
        Effect.CONCLUSION,
        "Corollary 5.19 at each time t, which stands; nothing for all times at once, see c5.stability-constants",
        why=(
            "in free fall the speed grows without end, and particles that are close at first move apart as exp(t²/2); "
            "linear forces and constraints make the whole system linear, so that C and L exist for all times"
        ),
        place=3968,
    ),
    rests_on=("c5.fundamental", "c5.stability-step", "c5.speed-all-times", "c5.stability-constants"),
    chosen="two point masses, g = sinh(X)e⁻ʸ, W₀ = −y, no other forces, which fulfils (A1a) to (A5b); the correction "
    "for all systems of the chapter",
)
def _estimate() -> Evidence:
    """Free fall from rest: close particles move apart as exp(y) = exp(t^2/2), which no C exp(L t) bounds."""
    first, second, last = (amplified(lambda _: 1.0, 0.0, 0.0, time) for time in (2.0, 4.0, 6.0))
    return Evidence(
        printed=(
            at_most(
                "growth of log(W₁(t)/W₁(0)) from t = 4 to 6 over growth from t = 2 to 4, free fall from rest",
                (last - second) / (second - first),
                1.0,
                RUN_TOL,
            ),
        ),
        corrected=tuple(step() for step in ESTIMATE),
    )
