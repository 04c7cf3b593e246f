"""Chapter 5, Remark 5.20: moments of the density."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most
from verification.thesis.chapter5.claims.s2_3_examples import PLANE, deformation
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.wavy import runge_kutta, soft

# What rounding leaves of sums, and steps of a run.
TOL, RUN_TOL = 1e-9, 1e-8
# Far above: what a wrong term makes here.
WRONG = 1e-4
LINE, YDOT = np.linspace(-10.0, 10.0, 401), 0.6
BELL = np.exp(-((LINE - 0.3) ** 2) / 2) / np.sqrt(2 * np.pi)


def moment_rates(A: Floats, rho: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """What inserting a density into (5.35) gives for its first and second moments."""
    return A @ rho, A @ sigma + sigma @ A.T


@claim(
    "c5.closure",
    "The transport equation gives equations for the moments of the density.",
    source="Remark 5.20",
    quote="find equations for the first moments by inserting this ansatz into the (5.42a) and (5.42b)",
    recorded=Kind.NOT_REFUTED,
    chosen="Example 5.4 with y(t) given, where the equations close without an assumption on the density",
    tried_on="50 points in Example 5.4",
)
def _closed() -> Evidence:
    """Moments of a measure in a sheared element, integrated alone, and those of the points that are carried along."""
    y, v = PLANE
    X = np.random.default_rng(520).normal(size=(50, 2)) @ np.array([[1.0, 0.3], [0.0, 0.6]]) + np.array([0.4, -0.2])

    def rate(z: Floats) -> Floats:
        A = deformation(v) @ np.linalg.inv(deformation(y + z[-1] * v))
        first, second = moment_rates(A, z[:2], z[2:6].reshape(2, 2))
        return np.concatenate([first, second.ravel(), [1.0]])

    start = np.concatenate([X.mean(axis=0), (X.T @ X / len(X)).ravel(), [0.0]])
    end = runge_kutta(rate, start, 0.5)[-1]
    moved = X @ (deformation(y + 0.5 * v) @ np.linalg.inv(deformation(y))).T
    first = float(np.abs(end[:2] - moved.mean(axis=0)).max())
    second = float(np.abs(end[2:6] - (moved.T @ moved / len(X)).ravel()).max())
    change = float(np.abs(end[2:6] - start[2:6]).max())
    return Evidence(
        f"Example 5.4: ρ and σ of 50 points, from equations for moments only, agree with those of the moved points to "
        f"{first:.0e} and {second:.0e}, while σ changes by {change:.2f}: the velocity is linear in x.",
        printed=(
            at_most("ρ against that of the points", first, 0.0, RUN_TOL),
            at_most("σ against that of the points", second, 0.0, RUN_TOL),
            at_least("change of σ", change, WRONG),
        ),
        seed=520,
    )


def _rate_of(weight: Callable[[Floats], Floats]) -> float:
    """d/dt int w f dx = int w df/dt dx by (5.42b), f = BELL, g = X + sin(X)/2 - y."""
    U, slope = soft(LINE) * YDOT, np.sin(LINE) / 2 * soft(LINE) ** 2 * YDOT
    rate = -(slope * BELL - U * (LINE - 0.3) * BELL)
    return float((weight(LINE) * rate).sum() * (LINE[1] - LINE[0]))


@claim(
    "c5.mass",
    "The transport equation keeps the number of particles.",
    source="(5.68)",
    quote="ṁ(t) = 0, conservation of mass",
    recorded=Kind.NOT_REFUTED,
    chosen="m is that of (5.67), not the mass of a particle",
    tried_on="g = X + sin(X)/2 − y, one density",
)
def _mass() -> Evidence:
    rate, moving = abs(_rate_of(np.ones_like)), abs(_rate_of(lambda x: x))
    return Evidence(
        f"∫∂_t f dx = {rate:.0e} for g = X + sin(X)/2 − y, while ∫x ∂_t f dx = {moving:.2f}.",
        printed=(at_most("|dm/dt|", rate, 0.0, TOL), at_least("|dρ/dt|", moving, WRONG)),
    )


@claim(
    "c5.first-moment",
    "The rate of the first moment of the density.",
    source="(5.69)",
    quote="ρ̇(t) =",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "ρ̇(t) = ∫Φ(x, y)[ẏ] f(x, t) dx",
        Effect.NOTATION,
        "the method of moments, which the remark sets out; the equation for σ is left out too",
        why="(5.42b), multiplied by x and integrated by parts; the right side is left blank",
        place=3962,
    ),
    tried_on="g = X + sin(X)/2 − y, one density",
)
def _first_moment() -> Evidence:
    """int x df/dt dx against int Phi y' f dx, for g = X + sin(X)/2 - y."""
    found = _rate_of(lambda x: x)
    right = float((soft(LINE) * YDOT * BELL).sum() * (LINE[1] - LINE[0]))
    return Evidence(
        f"The right side is left blank, while ρ changes at a rate of {found:.4f}. By (5.42b) it is ∫Φ(x, y)[ẏ] f dx = "
        f"{right:.4f}, to {abs(found - right):.0e}.",
        printed=(at_most("|dρ/dt|, the right side taken as 0", abs(found), 0.0, TOL),),
        corrected=(at_most("|dρ/dt − ∫Φ(x, y)[ẏ] f dx|", abs(found - right), 0.0, TOL),),
    )
