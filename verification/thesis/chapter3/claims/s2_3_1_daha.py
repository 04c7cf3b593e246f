"""Chapter 3, sections 2.3 and 2.3.1: the damped Arrow-Hurwicz method (DAHA), its step and its limits."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.thesis.text.quoted import claim

Floats = NDArray[np.float64]
State = TypeVar("State", float, Floats)
ROUNDING = 1e-12
# Table 4.
ALPHA, BETA, GAMMA, C, EPS = 1e-4, 0.25, 1e-3, 2.0, 1e-6
# Factors of c = 2: 1 and 2 are the last but two and the last but one.
DAMPINGS = (0.1, 0.5, 1.0, 2.0, 10.0)
# What counts as more, where a parameter is doubled.
GROWS = 1.4
# Of a stability limit that is found by bisection.
BISECTIONS = 40


@claim(
    "c3.discretised",
    "(3.25) is a difference formula for the damped second-order system (3.23).",
    "(3.25)",
    Verdict.PROVED,
    chosen="the multiplier is a given function of time, so that its misprinted update does not matter",
)
def _discretised() -> Evidence:
    """Both quotients of (3.25) for a path with the derivatives v, a, b, d at the present: no terms below h^2."""
    sp = library()

    def residuals(s: Any, z: Any, v: Any, a: Any, b: Any, d: Any, c: Any, h: Any) -> Any:
        def path(t: Any) -> Any:
            return z + v * t + a * t**2 / 2 + b * t**3 / 6 + d * t**4 / 24

        quotients = (path(h) - 2 * z + path(-h)) / h**2 + c / (2 * h) * (path(h) - path(-h))
        error = sp.Poly(sp.expand(quotients - (a + s * c * v)), h)
        return [error.coeff_monomial(h**power) for power in (0, 1)]

    return proved(
        identity("(3.25) is z̈ + cż + force = 0 of (3.23) up to terms with Δτ², for every path", residuals, "−cż")
    )


def solved(now: State, before: State, push: State, c: float, dtau: float) -> State:
    """(3.25) solved for z_{n+1}; ``push`` is all that stands behind -alpha and -gamma there, with these factors."""
    return (2 * now - (1 - dtau * c / 2) * before - dtau**2 * push) / (1 + dtau * c / 2)


def damped(now: Any, before: Any, push: Any, c: Any, dtau: Any) -> Any:
    """Return z_(n+1) of (3.25) as printed, for symbols; push is the sum of the terms with alpha and gamma."""
    return (2 * now - (1 - c * dtau / 2) * before - dtau**2 * push) / (1 + c * dtau / 2)


@claim(
    "c3.solved",
    "(3.25) solved for the next state.",
    "section 2.3",
    Verdict.PROVED,
)
def _solved() -> Evidence:
    return proved(
        identity(
            "the printed z_{n+1} solves (3.25) for all states, forces, c and Δτ",
            lambda s, z, before, push, c, h: (
                (damped(z, before, push, c, h) - 2 * z + before) / h**2
                + s * c / (2 * h) * (damped(z, before, push, c, h) - before)
                + push
            ),
            "−c",
        )
    )


@claim(
    "c3.one-step",
    "At this damping the next state no longer depends on the one before the present.",
    "section 2.3",
    Verdict.PROVED,
)
def _one_step() -> Evidence:
    return proved(
        identity(
            "at c = 2/Δτ z_{n+1} does not depend on z_{n−1}",
            lambda s, z, before, push, h: damped(z, before, push, s * 2 / h, h).diff(before),
            "c = 1/Δτ",
            library().Rational(1, 2),
        )
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
    "section 2.3.1",
    Verdict.CORRECTED,
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
    "section 2.3.1",
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
