"""Chapter 5, Remark 5.20: moments of the density."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_most, proved
from verification.formal.algebra import identity, library, matrices
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.wavy import soft

# What rounding leaves of sums.
TOL = 1e-9
LINE, YDOT = np.linspace(-10.0, 10.0, 401), 0.6
BELL = np.exp(-((LINE - 0.3) ** 2) / 2) / np.sqrt(2 * np.pi)


@claim(
    "c5.closure",
    "The transport equation gives equations for the moments of the density.",
    source="Remark 5.20",
    quote="find equations for the first moments by inserting this ansatz into the (5.42a) and (5.42b)",
    chosen="Example 5.4 with y(t) given, where the equations close without an assumption on the density",
    recorded=Kind.PROVED_INSTANCE,
    tried_on="Example 5.4, all points and weights",
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
    chosen="m is that of (5.67), not the mass of a particle",
    recorded=Kind.PROVED,
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
