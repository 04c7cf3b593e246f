"""Chapter 3, sections 2.3 and 2.3.1: the damped Arrow-Hurwicz method (DAHA), its step and its limits."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal

Floats = NDArray[np.float64]
State = TypeVar("State", float, Floats)
SEED = 34
ROUNDING = 1e-12
# Table 4.
ALPHA, BETA, GAMMA, C, EPS = 1e-4, 0.25, 1e-3, 2.0, 1e-6
# The order of a difference formula, as far as two steps tell it.
ORDER = 0.1
# Factors of c = 2: 1 and 2 are the last but two and the last but one.
DAMPINGS = (0.1, 0.5, 1.0, 2.0, 10.0)
# What counts as more, where a parameter is doubled.
GROWS = 1.4
# Of a stability limit that is found by bisection.
BISECTIONS = 40


@claim(
    "c3.discretised",
    "(3.25) is a difference formula for the damped second-order system (3.23).",
    source="(3.25)",
    quote="A discretisation of (3.22) and (3.23) yields the damped Arrow-Hurwicz algorithm (DAHA).",
    chosen="the multiplier is a given function of time, so that its misprinted update does not matter",
    recorded=Kind.NOT_REFUTED,
    tried_on="one row with a given multiplier",
)
def _discretised() -> Evidence:
    """A wall with a multiplier that is given, from a state that moves; (3.23) by a Runge-Kutta method."""
    c, alpha, gamma, end = 0.7, 1.3, 0.4, 2.0

    def force(tau: float, z: float) -> float:
        lam, g, slope = 1 + np.sin(tau), z**2 - 0.25, 2 * z
        return float(alpha * (z + 1 - lam * slope) + gamma * lam * g * slope)

    def right(tau: float, state: Floats) -> tuple[float, float]:
        return state[1], -c * state[1] - force(tau, state[0])

    exact = solve_ivp(right, (0, end), (1.0, -0.5), rtol=1e-11, atol=1e-12, dense_output=True).sol
    errors = []
    for steps in (100, 200):
        dtau = end / steps
        before, now = float(exact(0.0)[0]), float(exact(dtau)[0])
        for n in range(1, steps):
            before, now = now, solved(now, before, force(n * dtau, now), c, dtau)
        errors.append(abs(now - float(exact(end)[0])))
    order = float(np.log2(errors[0] / errors[1]))
    return Evidence(
        f"one row with a given multiplier: the error of (3.25) at τ = {end:g} is {errors[0]:.1e} with 100 steps, "
        f"{errors[1]:.1e} with 200: order {order:.2f}",
        printed=(equal("order of (3.25) for (3.23)", order, 2.0, ORDER),),
    )


def solved(now: State, before: State, push: State, c: float, dtau: float) -> State:
    """(3.25) solved for z_{n+1}; ``push`` is all that stands behind -alpha and -gamma there, with these factors."""
    return (2 * now - (1 - dtau * c / 2) * before - dtau**2 * push) / (1 + dtau * c / 2)


@claim(
    "c3.solved",
    "(3.25) solved for the next state.",
    source="section 2.3",
    quote="z_{n+1} = 1/(1 + ½Δτc) (2z_n - (1 - ½Δτc) z_{n-1} - Δτ²α(∇W - Σ λ_ℓ ∇g_ℓ) - Δτ²γ Σ g_ℓ λ_ℓ ∇g_ℓ)",
    recorded=Kind.NOT_REFUTED,
    tried_on="random states, three pairs of c and Δτ",
)
def _solved() -> Evidence:
    """Random numbers in both sides of (3.25)."""
    now, before, push = np.random.default_rng(SEED).normal(size=(3, 6))
    left, scale = [], 0.0
    for c, dtau in ((0.3, 1.0), (2.0, 1.0), (1.5, 0.25)):
        after = solved(now, before, push, c, dtau)
        second = (after - 2 * now + before) / dtau**2
        left.append(np.abs(second + c / (2 * dtau) * (after - before) + push).max())
        scale = max(scale, float(np.abs(second).max()))
    return Evidence(
        f"random states and forces, three pairs of c and Δτ: put into (3.25) the solution misses by {max(left):.0e}, "
        f"where the terms are up to {scale:.0f}",
        printed=(at_most("misfit of (3.25) over its terms", max(left) / scale, ROUNDING),),
        seed=SEED,
    )


@claim(
    "c3.one-step",
    "At this damping the next state no longer depends on the one before the present.",
    source="section 2.3",
    quote="We observe that for c = 2/Δτ the method reduces to a one-step method.",
    recorded=Kind.NOT_REFUTED,
    tried_on="three values of Δτ",
)
def _one_step() -> Evidence:
    now, before, push, shift = np.random.default_rng(SEED).normal(size=(4, 6))

    def felt(c: float, dtau: float) -> float:
        """How much of a change of z_{n-1} is left in z_{n+1}."""
        moved = solved(now, before + shift, push, c, dtau) - solved(now, before, push, c, dtau)
        return float(np.abs(moved).max() / np.abs(shift).max())

    critical, weak = max(felt(2 / dtau, dtau) for dtau in (0.25, 1.0, 3.0)), felt(1.0, 1.0)
    return Evidence(
        f"a change of z_{{n-1}} is felt in z_{{n+1}} with {critical:.0e} of its size for c = 2/Δτ, Δτ = 0.25, 1, 3, "
        f"and with {weak:.2f} for c = 1, Δτ = 1",
        printed=(at_most("part of a change of z_{n-1} that is felt", critical, ROUNDING),),
        seed=SEED,
    )


def radius(stiff: float, c: float, dtau: float) -> float:
    """The spectral radius of (3.25) for an energy with ``stiff`` = alpha W'', without constraints."""
    columns = [(solved(z, before, stiff * z, c, dtau), z) for z, before in ((1.0, 0.0), (0.0, 1.0))]
    return float(np.abs(np.linalg.eigvals(np.array(columns, dtype=float).T)).max())


def limit(c: float, dtau: float) -> float:
    """The largest alpha W'' for which the iteration does not grow, by bisection."""
    low, high = 0.0, 1e3
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        low, high = (middle, high) if radius(middle, c, dtau) <= 1 + ROUNDING else (low, middle)
    return low


def iterations(c: float, dtau: float) -> float:
    """Iterations in which a soft spring loses a factor e."""
    return -1 / float(np.log(radius(1e-3, c, dtau)))


def least_weight(c: float, dtau: float) -> float:
    """The smallest multiplier with which a weight comes to rest on a floor (no curvature, |grad g| = 1)."""
    low, high = 0.0, 1e3
    for _ in range(BISECTIONS):
        lam = (low + high) / 2
        basis = np.eye(3)
        columns = [
            (solved(z, before, GAMMA * lam * z - ALPHA * change, c, dtau), z, change - dtau * BETA * z)
            for z, before, change in basis
        ]
        stable = np.abs(np.linalg.eigvals(np.array(columns, dtype=float).T)).max() < 1
        low, high = (low, lam) if stable else (lam, high)
    return high


@claim(
    "c3.stable-choice",
    "How the damping and the step of DAHA trade stability for iterations.",
    source="section 2.3.1",
    quote=(
        "Increasing the damping coefficient c and the time-step size Δt can reduce the numerical instabilities, but it "
        "also directly increases the number of required iterations."
    ),
    recorded=Kind.CORRECTED,
    correction=Correction(
        "Δτ must be decreased: energies are stable for Δτ²αW'' ≤ 4, whatever c is; a larger c helps contacts only. "
        "Both take more iterations",
        Effect.MODEL,
        "the choice of parameters: a larger Δτ is less stable and needs fewer iterations",
        why="explicit steps of a stiff system become stable by shorter, not longer steps",
        place=2037,
    ),
    chosen="the step is Δτ of (3.25), in which Δt does not occur",
)
def _choice() -> Evidence:
    """c doubled, dtau doubled, dtau halved, each beside c = 2, dtau = 1/2 (where c < 2/dtau)."""
    c, dtau = 2.0, 0.5
    bound, taken, weight = limit(c, dtau), iterations(c, dtau), least_weight(c, dtau)
    bounds = [limit(factor * c, dtau) * dtau**2 for factor in DAMPINGS]
    rests, slower = least_weight(2 * c, dtau) / weight, iterations(2 * c, dtau) / taken
    longer, shorter = (limit(c, step) / bound for step in (2 * dtau, dtau / 2))
    quick, slow = (iterations(c, step) / taken for step in (2 * dtau, dtau / 2))
    return Evidence(
        f"springs: (3.25) bears Δτ²αW'' up to {min(bounds):.3f} to {max(bounds):.3f} for c from {DAMPINGS[0] * c:g} to "
        f"{DAMPINGS[-1] * c:g}. Δτ doubled: {longer:.2f} of the W'' and {quick:.1f} of the iterations; halved: "
        f"{shorter:.0f} times the W'', {slow:.1f} times the iterations. c doubled: {slower:.1f} times the iterations, "
        f"contacts rest with {rests:.1f} of the multiplier",
        printed=(
            at_least("c doubled: stability limit of an energy over before", bounds[-2] / bounds[-3], GROWS),
            at_least("Δτ doubled: stability limit of an energy over before", longer, GROWS),
            at_least("Δτ doubled: iterations over before", quick, GROWS),
        ),
        corrected=(
            *(equal("Δτ²αW'' at the stability limit", found, 4.0, 1e-6) for found in bounds),
            at_least("c doubled: iterations over before", slower, GROWS),
            at_most("c doubled: least multiplier at rest over before", rests, 1 / GROWS),
            at_least("Δτ halved: stability limit of an energy over before", shorter, GROWS),
            at_least("Δτ halved: iterations over before", slow, GROWS),
        ),
    )


def last_move(product: float, steps: int = 2000) -> float:
    """The last relative move for a bounded force, steep where it rests, dtau^2 alpha max W'' = ``product``."""
    width = 0.1
    before = now = 1.3
    for _ in range(steps):
        before, now = now, solved(now, before, product * width * float(np.tanh((now - 1) / width)), C, 1.0)
    return abs(now - before) / abs(before)


@claim(
    "c3.endless",
    "An iteration beyond its stability limit need not meet (3.24).",
    source="section 2.3.1",
    quote="Such instabilities can lead to non-terminating conditions of the iteration",
    chosen="a force that is bounded, as that of the straightness energy is at a given distance",
)
def _endless() -> Evidence:
    below, above = last_move(3.0), last_move(8.0)
    return Evidence(
        f"a bounded force around its rest, c = 2, Δτ = 1, limit Δτ²αW'' = 4: after 2000 iterations the relative move "
        f"is {below:.0e} with Δτ²αW'' = 3; with 8 it swings on with {above:.2f}, above any ε",
        printed=(
            at_most("relative move below the limit", below, EPS),
            at_least("relative move beyond the limit", above, 1e3 * EPS),
        ),
    )
