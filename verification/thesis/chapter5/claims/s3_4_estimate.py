"""Chapter 5, sections 3.4 and 4: the stability estimate (5.60) and its constants."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Evidence, FormalProof, Verdict, at_least, at_most, proved
from verification.formal.reals import implication
from verification.thesis.chapter5.bounded import FlowState, force, mass
from verification.thesis.chapter5.claims.s3_4_stability import gronwall
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.wavy import runge_kutta, soft
from verification.thesis.text.quoted import claim

# What steps of a run leave.
RUN_TOL = 1e-6
# Far above it: what a force makes here.
FELT = 1e-4
# The mass of the particles beside that of the macroscopic component, and how far they are apart at first.
M, APART = 0.01, 1e-15


def amplified(force: Callable[[float], float], y: float, v: float) -> float:
    """log W1(1)/W1(0) of point masses at 0 and at APART, on g = sinh(X) exp(-y), so Phi = tanh X."""

    def rate(z: Floats) -> Floats:
        moved = np.tanh(z[2])
        curved = moved * (1 - moved**2) * z[1] ** 2
        return np.array([z[1], (force(z[0]) - M * moved * curved) / (1 + M * moved**2), moved * z[1]])

    end = runge_kutta(rate, np.array([y, v, APART]), 1.0)[-1]
    return float(np.log(end[2] / APART))


@claim(
    "c5.stability-constants",
    "The constants of the stability estimate are the same for all starts of one energy and moment.",
    "Theorem 5.16",
    Verdict.CORRECTED,
    chosen="two point masses, g = sinh(X)e⁻ʸ, W₀ = −y, no other forces",
    tried_on="three starts in one potential ≥ 0",
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
        f"g = sinh(X)e⁻ʸ, W₀ = −y fulfil (A1) to (A5). Starts (y, ẏ) = (v²/2, v) have E = 0, C_μ = 1, but W₁ = 10⁻¹⁵ "
        f"grows in a time 1 by e^{falling[0]:.1f} for v = 1, e^{falling[1]:.1f} for v = 10: no C, L fit all. With a "
        f"potential ≥ 0 it grows by at most e^{max(held):.2f} for E = {energy:g}, below e^√(2E).",
        printed=(at_most("log of the growth of W₁, v = 10 over v = 1", falling[1] / falling[0], 1.0, RUN_TOL),),
        corrected=(at_most("log of the growth of W₁, potential ≥ 0", max(held), bound, RUN_TOL),),
    )


def moved(X: Floats, y: float, v: float) -> Floats:
    """(y, y', X_1, ...) at t = 2 for particles of equal weight on the fibre of ``bounded``."""
    w = np.full(X.size, 1 / X.size)

    def rate(z: Floats) -> Floats:
        at = FlowState(z[2:], w, float(z[0]), float(z[1]))
        return np.concatenate([[at.v, force(at) / mass(at)], soft(at.X) * at.v])

    return np.asarray(runge_kutta(rate, np.concatenate([[y, v], X]), 2.0, 40)[-1])


def estimate() -> tuple[FormalProof, ...]:
    """Prove (5.60) by the rates of its parts, see ``_estimate``, and Lemma 5.17."""
    return (
        implication(
            "the sum of ‖y₁ − y₂‖, ‖ẏ₁ − ẏ₂‖ and ∫‖X₁ − X₂‖ grows at most at the rate L times itself",
            lambda s, a, b, c, da, db, dc, kx, ky, kv, px, py, pv, L: (
                [
                    a >= 0,
                    b >= 0,
                    c >= 0,
                    da <= b,
                    db <= kx * c + ky * a + kv * b,
                    dc <= px * c + py * a + pv * b,
                    kx + px <= L,
                    ky + py <= L,
                    s + kv + pv <= L,
                ],
                da + db + dc <= L * (a + b + c),
            ),
            "L without the 1 of ‖ẏ₁ − ẏ₂‖",
            0,
        ),
        *gronwall(),
    )


@claim(
    "c5.same-estimate",
    "With nonlinear constraints the distance of solutions is at most a multiple of that of their starts.",
    "section 4",
    Verdict.PROVED,
    chosen="potentials that are bounded below, and starts at rest",
)
def _estimate() -> Evidence:
    """a = |y1 - y2|, b = |v1 - v2|, c = int |X1 - X2| with an optimal coupling of the starts; k are the constants.

    By c5.product and c5.acceleration-lipschitz b' <= kx c + ky a + kv b and c' <= px c + py a + pv b at bounded speed.
    W1 is at most c, and equal to it at the start.
    """
    return proved(*estimate())


@claim(
    "c5.future-interaction",
    "Forces between particles are an extension that is still to be made.",
    "section 4",
    Verdict.CORRECTED,
    chosen="the forces of (5.4), within the class of the chapter",
)
def _future() -> Evidence:
    """F_eff of (5.41b) for spread points, against its mean for each point alone, on which no other pulls."""
    X = np.linspace(-1.0, 2.5, 8)
    w, v = np.full(X.size, 1 / X.size), 0.5
    together = force(FlowState(X, w, 0.3, v))
    alone = float(np.mean([force(FlowState(X[k : k + 1], np.ones(1), 0.3, v)) for k in range(X.size)]))
    part = abs(together - alone)
    return Evidence(
        f"(5.4), (5.6a), (5.14) and (5.41b) have forces K between particles: on g = X + sin(X)/2 − y, 𝒱(r) = √(1 + "
        f"r²), which fulfil (A1) to (A5), F_eff of {X.size} particles is {together:.3f}, of each alone {alone:.3f} in "
        "the mean. The theorems hold with these forces.",
        printed=(at_most("part of F_eff by forces between particles", part, 0.0, RUN_TOL),),
        corrected=(at_least("part of F_eff by forces between particles", part, FELT),),
    )
