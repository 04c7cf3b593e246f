"""Chapter 5, section 2.3: the linearised constraint (Example 5.3)."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.claims.s2_3_examples import ONE, X0, M, with_springs
from verification.thesis.chapter5.instant import force0, force1, instant, slopes

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
N, Y_C = 50, 2.0


def scaled(x: float, y_c: float, x_c: float) -> float:
    """X~ = (y_c/X_c) X."""
    return y_c / x_c * x


@claim(
    "c5.characteristic-length",
    "The point of the linearisation and the scaled coordinate lead to X̃ − y.",
    source="Example 5.3",
    quote="linearising the constraint around X_i ≈ X_c = 1/N … X̃_i = y_c/X_c X_i = N y_c X_i",
    chosen="y_c is a number of order 1, so that O(y_c/N) contains 1/N",
    recorded=Kind.PROVED,
)
def _length() -> Evidence:
    x, y, n, c = library().symbols("x y N y_c", positive=True)
    at = {x: 1 / n, y: c}
    linear = x / c - y / (n * c**2)
    return proved(
        identity(
            "at X = 1/N, y = y_c the slopes of X/y are those of (5.24), which is (X̃ − y)/(N y_c²) for X̃ = N y_c X",
            lambda s: [
                (x / y).diff(x).subs(at) - linear.diff(x),
                (x / y).diff(y).subs(at) - linear.diff(y),
                linear - (n**s * c * x - y) / (n * c**2),
            ],
            "X̃ = y_c X/N",
        )
    )


@claim(
    "c5.linearised",
    "The constraint of a straight fibre, linearised.",
    source="(5.24)",
    quote="g(X_i, y) ≈ X_i/y_c − y/(N y_c²)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "g(X_i, y) ≈ X_i/y_c − y/(N y_c²) + 1/(N y_c)",
        Effect.NOTATION,
        "nothing: a constraint keeps g constant, so a constant may be left out; (5.25) says “= const.”",
        why="the first terms are 0 where X/y is linearised, X = 1/N and y = y_c, and X/y is 1/(N y_c) there",
        place=3316,
    ),
    chosen="X_c = 1/N, as printed",
    tried_on="N = 50, y_c = 2",
)
def _linearised() -> Evidence:
    """Value and slopes of X/y where it is linearised, against those of (5.24)."""
    g = with_springs(lambda X, y: X / y).g
    at, y = np.array([[1 / N]]), np.array([Y_C])
    first, second = slopes(lambda x: g(x, y), at).item(), slopes(lambda z: g(at, z), y).item()
    off = abs(first - 1 / Y_C), abs(second + 1 / (N * Y_C**2))
    value, printed = g(at, y).item(), (at / Y_C - y / (N * Y_C**2)).item()
    constant = 1 / (N * Y_C)
    return Evidence(
        f"At X = 1/N, y = y_c X/y is {value:g} and (5.24) {printed:g}: the constant 1/(N y_c) is left out, which a "
        f"constraint allows. The slopes of X/y are those of (5.24), to {max(off):.0e}.",
        printed=(equal("(5.24) over X/y at X = 1/N, y = y_c", printed / value, 1.0, TOL),),
        corrected=(
            equal("the same with the constant", (printed + constant) / value, 1.0, TOL),
            at_most("slope in X against 1/y_c", off[0], 0.0, TOL),
            at_most("slope in y against −1/(N y_c²)", off[1], 0.0, TOL),
        ),
    )


@claim(
    "c5.coordinates",
    "In the scaled coordinate the effective mass of y is 1 + m.",
    source="Example 5.3",
    quote="we apply the coordinate change X̃_i = y_c/X_c X_i = N y_c X_i … m_eff = m I + 1",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "m_eff = 1 + m(X_c/y_c)² = 1 + m/(N y_c)², and (X_c/y_c)F₁ for F₁; or m and F₁ are said to be those of X̃",
        Effect.MODEL,
        "(5.26) to (5.30): by the letter they are another model than the linearised one, which depends on N",
        why="m is the mass that multiplies Ẍ_i in (5.6a), and Ẋ_i is X_c/y_c times the rate of X̃_i",
        place=3324,
    ),
    tried_on="N = 50, y_c = 2",
)
def _coordinates() -> Evidence:
    """The effective mass of y from the linearised constraint (5.24) in the coordinate X."""
    ratio = 1 / (N * Y_C)
    at = instant(with_springs(lambda X, y: X / Y_C - y / (N * Y_C**2)), X0 * ratio, *ONE)
    force = force0(at.system, at.y) + ratio * force1(at.system, at.X).mean()
    found = (force / at.a).item()
    of_scaled = M * ratio**2
    return Evidence(
        f"X_c/y_c = {ratio:g}, the mass of a particle is {M:g} in X, so m = {of_scaled:.2g} in X̃: the constrained "
        f"system in X has the effective mass {found:.5f}, which is 1 + {of_scaled:.2g}, not 1 + m = {1 + M:g}.",
        printed=(equal("effective mass against 1 + m", found, 1 + M, TOL),),
        corrected=(equal("effective mass against 1 + m(X_c/y_c)²", found, 1 + of_scaled, TOL),),
    )


@claim(
    "c5.linear-mass",
    "The effective mass with the linearised constraint.",
    source="(5.26)",
    quote="for g_L = X̃_i − y: m_eff = m I + 1",
    recorded=Kind.PROVED,
)
def _linear_mass() -> Evidence:
    m, x, y = library().symbols("m x y")
    g = x - y
    phi = -g.diff(y) / g.diff(x)
    return proved(identity("1 + mΦ² = 1 + m for g = X̃ − y", lambda s: 1 + m * phi**2 - (s + m), "m − 1"))


@claim(
    "c5.linear-force",
    "The effective force with the linearised constraint.",
    source="(5.27)",
    quote="F_eff(X̃₁, …, X̃_N, y) = F₀(y) + 1/N Σ_j F₁(X̃_j)",
    recorded=Kind.PROVED,
)
def _linear_force() -> Evidence:
    """The terms of one particle: m a = f - lambda by (5.6a), and y feels -lambda by (5.6b)."""
    m, a, f = library().symbols("m a f")
    level = f - m * a
    return proved(
        identity("for g = X̃ − y (5.6b) says (1 + m)ÿ = F₀ + ⟨F₁(X̃)⟩", lambda s: -level - m * a + s * f, "−F₁")
    )
