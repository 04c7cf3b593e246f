"""Chapter 5, sections 3.2, 3.4 and 3.5: particles and measures, weak solutions and moments."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.instant import Floats
from verification.claims.measure import shift_rate, tested
from verification.claims.wavy import T, soft, wavy_flow, wavy_motion

# What rounding leaves of sums, and what steps of a Runge-Kutta method leave.
TOL = 1e-9
SEED, SAMPLES = 65, 200
# What the steps of a run leave.
RUN_TOL = 1e-7
SHIFT = 0.8


def _consistency(_: Tables) -> Verdict:
    """Three particles, two in one place, and the measure of two atoms with the weights 2/3 and 1/3."""
    particles = wavy_motion(np.array([0.2, 1.5, 1.5]), np.full(3, 1 / 3))
    measure = wavy_motion(np.array([1.5, 0.2]), np.array([2, 1]) / 3)
    same = float(np.abs(particles[[0, 1, 3, 2]] - measure).max())
    flowed = float(np.abs(wavy_flow(np.array([0.2, 1.5, 1.5]), particles[0]) - particles[2:]).max())
    return holds_if(
        max(same, flowed) < RUN_TOL,
        f"g = X + sin(X)/2 − y, three particles, two of them in one place: y, ẏ and X_i at t = {T:g} are those of "
        f"(5.40) for their empirical measure to {same:.0e}, and the flow at X_iⁱⁿⁱᵗ is X_i(t), (5.48), to {flowed:.0e}",
    )


def _bracket(_: Tables) -> Verdict:
    """Particles that are all shifted, Phi = 1, y' = 0.6: the divergence of Phi y' is 0, that of Phi y' f is not."""
    v = 0.6
    by_flow, printed = tested(lambda x: 0 * x + v, lambda x, f: 0 * f, 1)
    right = tested(lambda x: 0 * x + v, lambda x, f: shift_rate(x, f, v), 1)[1]
    return corrected_if(
        abs(by_flow - printed) < TOL,
        abs(by_flow - right) < TOL,
        f"Φ = 1: d/dt ⟨ξ, f⟩ = {by_flow:.3f}, but −⟨ξ, div(Φẏ)f⟩ = {printed:g}. f belongs into the bracket, as in the "
        f"line above: −⟨ξ, div(Φẏ f)⟩ = {right:.3f}",
    )


def _shifted(_: Tables) -> Verdict:
    """Particles that follow y by a shift: how many are in A = [0, 1] at first, in A - w later, w minus the shift."""
    x = np.random.default_rng(SEED).normal(size=SAMPLES)
    later = x + SHIFT

    def inside(points: Floats, start: float) -> int:
        return int(((points >= start) & (points <= start + 1)).sum())

    first, with_minus, with_plus = inside(x, 0.0), inside(later, SHIFT), inside(later, -SHIFT)
    return holds_if(
        first == with_minus != with_plus,
        f"A − w(t) holds as many of {SAMPLES} points as A did ({first}) for w = −(shift); for w = shift it is "
        f"{with_plus}, so w is the negative of the displacement G(y(t) − yⁱⁿⁱᵗ)",
    )


def _moments(weight: Callable[[Floats], Floats]) -> float:
    """d/dt int w f dx = int w df/dt dx by (5.42b), f = exp(-(x - 0.3)^2/2)/sqrt(2 pi), U = Phi(x) y', y' = 0.6."""
    line, v = np.linspace(-10.0, 10.0, 401), 0.6
    f = np.exp(-((line - 0.3) ** 2) / 2) / np.sqrt(2 * np.pi)
    U, slope = soft(line) * v, np.sin(line) / 2 * soft(line) ** 2 * v
    rate = -(slope * f - U * (line - 0.3) * f)
    return float((weight(line) * rate).sum() * (line[1] - line[0]))


def _mass(_: Tables) -> Verdict:
    rate = abs(_moments(np.ones_like))
    return holds_if(
        rate < TOL, f"∫∂_t f dx = {rate:.0e} for g = X + sin(X)/2 − y (here m is not the particles' mass m)"
    )


def _first_moment(_: Tables) -> Verdict:
    """int x df/dt dx against int Phi y' f dx, for g = X + sin(X)/2 - y."""
    line = np.linspace(-10.0, 10.0, 401)
    f = np.exp(-((line - 0.3) ** 2) / 2) / np.sqrt(2 * np.pi)
    right = float((soft(line) * 0.6 * f).sum() * (line[1] - line[0]))
    off = abs(_moments(lambda x: x) - right)
    return corrected_if(
        False,
        off < TOL,
        f"the right side is left blank. It is ∫Φ(x, y)[ẏ] f dx = {right:.4f}, from (5.42b) to {off:.0e}; ρ and σ close "
        "without an assumption on f if Φ and F₁ are affine in x and K is linear, as in Examples 5.2 to 5.4",
    )


CLAIMS = (
    Claim(
        "c5.consistency", "Lemma 5.10", "solutions of the ODE model are solutions of (5.40a) to (5.40c)", _consistency
    ),
    Claim("c5.weak-bracket", "proof of Lemma 5.10", "d/dt ⟨ξ, f⟩ = … = −⟨ξ, div(Φẏ) f⟩", _bracket),
    Claim("c5.shifted", "Remark 5.18", "there is a vector w(t) such that μⁱⁿⁱᵗ(A) = μᵗ(A − w(t))", _shifted),
    Claim("c5.mass", "(5.68)", "ṁ(t) = 0, conservation of mass", _mass),
    Claim("c5.first-moment", "(5.69)", "ρ̇(t) =", _first_moment),
)
