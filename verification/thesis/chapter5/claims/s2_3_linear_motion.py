"""Chapter 5, section 2.3: motion with the linearised constraint (Example 5.3) and with linear ones."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_most, proved
from verification.formal.algebra import identity, library, matrices
from verification.thesis.chapter5.claims.s2_3_examples import ONE, M, shifted
from verification.thesis.chapter5.instant import Floats, force0, force1, instant

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-2


@claim(
    "c5.linear-newton",
    "The equation of motion with the linearised constraint.",
    source="(5.28)",
    quote="mÿ = F₀(y) + 1/N Σ_j F₁(X̃_j)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "(1 + m)ÿ = F₀(y) + 1/N Σ_j F₁(X̃_j)",
        Effect.MODEL,
        "the motion of Example 5.3; (5.26) is right",
        why="(5.11a) with the effective mass 1 + m of (5.26)",
        place=3330,
    ),
    tried_on="one state of three particles",
)
def _linear_newton() -> Evidence:
    at = shifted()
    force = force0(at.system, at.y) + force1(at.system, at.X).mean()
    printed, right = (float(np.abs(mass * at.a - force).max()) for mass in (M, 1 + M))
    return Evidence(
        f"mÿ misses the force by {printed:.2f}, (1 + m)ÿ, as (5.26) says, by {right:.0e}: the mass of y itself is "
        "left out.",
        printed=(at_most("|mÿ − F₀ − 1/N Σ_j F₁|", printed, 0.0, TOL),),
        corrected=(at_most("|(1 + m)ÿ − F₀ − 1/N Σ_j F₁|", right, 0.0, TOL),),
    )


def bell() -> tuple[Floats, Floats]:
    """A density of the particles that is not symmetric, by values on a grid that sum to 1."""
    x = np.linspace(-7.0, 8.0, 4001)
    f = np.exp(-((x - 0.3) ** 2) / 2) * (1.5 + np.tanh(x))
    return x, f / f.sum()


@claim(
    "c5.linear-limit",
    "The mean-field equation of motion with the linearised constraint.",
    source="(5.30)",
    quote="mÿ = F₀(y) + ∫F₁(x)f(x, t) dx",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "(1 + m)ÿ = F₀(y) + ∫F₁(x)f(x, t) dx",
        Effect.MODEL,
        "the mean-field motion of Example 5.3, as in (5.28)",
        why="(5.40a) with the effective mass 1 + m of (5.26)",
        place=3336,
    ),
    tried_on="one density, by 60 particles",
)
def _linear_limit() -> Evidence:
    """The acceleration by 60 constrained particles at quantiles of a density, against the integral over it."""
    x, f = bell()
    X = np.interp((np.arange(60) + 0.5) / 60, f.cumsum(), x)
    at = instant(shifted().system, X[:, None], *ONE)
    force = force0(at.system, at.y) + f @ force1(at.system, x[:, None])[:, 0]
    printed, right = (float(np.abs(mass * at.a - force).max()) for mass in (M, 1 + M))
    return Evidence(
        f"60 constrained particles that stand for a density: mÿ misses F₀ + ∫F₁f dx by {printed:.2f}, (1 + m)ÿ by "
        f"{right:.0e}, which is due to their number (any limit between the two decides alike).",
        printed=(at_most("|mÿ − F₀ − ∫F₁f dx|", printed, 0.0, WRONG),),
        corrected=(at_most("|(1 + m)ÿ − F₀ − ∫F₁f dx|", right, 0.0, WRONG),),
    )


@claim(
    "c5.linear-transport",
    "With the linearised constraint the density is shifted.",
    source="(5.31)",
    quote="∂_t f(x, t) = −∂_x(f(x, t) ẏ(t))",
    recorded=Kind.PROVED,
)
def _linear_transport() -> Evidence:
    sp = library()
    x, t = sp.symbols("x t")
    y, start = sp.Function("y")(t), sp.Function("f")
    f = start(x - y)
    return proved(
        identity(
            "f(x, t) = f₀(x − y(t)) solves (5.31) for every f₀ and y",
            lambda s: f.diff(t) + s * (f * y.diff(t)).diff(x),
            "+∂_x",
        )
    )


@claim(
    "c5.linear-velocity",
    "With the linearised constraint the velocity of a particle is that of the macroscopic component.",
    source="(5.29)",
    quote="X̃_i = ẏ",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "dX̃_i/dt = ẏ",
        Effect.MODEL,
        "the motion of Example 5.3; (5.31) is right",
        why="(5.11b) with Φ = 1: the constraint is differentiated in time, and a position is no velocity",
        place=3332,
    ),
    tried_on="one state of three particles",
)
def _linear_velocity() -> Evidence:
    at = shifted()
    printed, right = (float(np.abs(rate - at.v).max()) for rate in (at.X, at.U))
    return Evidence(
        f"In a state of the constrained system X̃_i is off ẏ by up to {printed:.2f}, dX̃_i/dt by {right:.0e}.",
        printed=(at_most("|X̃_i − ẏ|", printed, 0.0, TOL),),
        corrected=(at_most("|dX̃_i/dt − ẏ|", right, 0.0, TOL),),
    )


@claim(
    "c5.linear-map",
    "With linear constraints the positions are an explicit function of the macroscopic state.",
    source="after (5.31)",
    quote="g = Gy − X_i imply that Φ = G is constant and Ω = 0 … X_i(t) = X_iⁱⁿⁱᵗ + G(y(t) − yⁱⁿⁱᵗ)",
    recorded=Kind.PROVED,
)
def _linear_map() -> Evidence:
    G, X, y, start = matrices("G X y z")
    return proved(
        identity(
            "G y − X keeps its value along X = Xⁱⁿⁱᵗ + G(y − yⁱⁿⁱᵗ), any nx, ny; so Φ = G is constant and Ω = 0",
            lambda s: G * y - (X + s * G * (y - start)) - (G * start - X),
            "−G",
        )
    )
