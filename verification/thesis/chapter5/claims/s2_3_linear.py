"""Chapter 5, section 2.3: the linearised constraint (Example 5.3)."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

from verification.claims import Evidence, Verdict, proved, put_right
from verification.formal.algebra import identity, library
from verification.thesis.text.quoted import claim


@claim(
    "c5.characteristic-length",
    "The point of the linearisation and the scaled coordinate lead to X̃ − y.",
    "Example 5.3",
    Verdict.PROVED,
    chosen="y_c is a number of order 1, so that O(y_c/N) contains 1/N",
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
    "(5.24)",
    Verdict.CORRECTED,
    chosen="X_c = 1/N, as printed",
)
def _linearised() -> Evidence:
    x, y, n, c = library().symbols("x y N y_c", positive=True)
    at = {x: 1 / n, y: c}

    def residuals(s: Any) -> Any:
        off = x / y - (x / c - y / (n * c**2) + s / (n * c))
        return [each.subs(at) for each in (off, off.diff(x), off.diff(y))]

    return put_right(
        identity(
            "X/y_c − y/(N y_c²) + 1/(N y_c) has the value and the slopes of X/y at X = 1/N, y = y_c",
            residuals,
            "without 1/(N y_c)",
            0,
        )
    )


@claim(
    "c5.coordinates",
    "In the scaled coordinate the effective mass of y is 1 + m.",
    "Example 5.3",
    Verdict.CORRECTED,
)
def _coordinates() -> Evidence:
    """Phi of (5.24) in the coordinate X."""
    x, y, m, n, c = library().symbols("x y m N y_c", positive=True)
    g = x / c - y / (n * c**2)
    phi = -g.diff(y) / g.diff(x)
    return put_right(
        identity(
            "1 + mΦ² = 1 + m/(N y_c)² for (5.24) and a mass m of X",
            lambda s: 1 + m * phi**2 - (1 + m / (n * c) ** (2 * s)),
            "1 + mΦ² = 1 + m",
            0,
        )
    )


@claim(
    "c5.linear-mass",
    "The effective mass with the linearised constraint.",
    "(5.26)",
    Verdict.PROVED,
)
def _linear_mass() -> Evidence:
    m, x, y = library().symbols("m x y")
    g = x - y
    phi = -g.diff(y) / g.diff(x)
    return proved(identity("1 + mΦ² = 1 + m for g = X̃ − y", lambda s: 1 + m * phi**2 - (s + m), "m − 1"))


@claim(
    "c5.linear-force",
    "The effective force with the linearised constraint.",
    "(5.27)",
    Verdict.PROVED,
)
def _linear_force() -> Evidence:
    """The terms of one particle: m a = f - lambda by (5.6a), and y feels -lambda by (5.6b)."""
    m, a, f = library().symbols("m a f")
    level = f - m * a
    return proved(
        identity("for g = X̃ − y (5.6b) says (1 + m)ÿ = F₀ + ⟨F₁(X̃)⟩", lambda s: -level - m * a + s * f, "−F₁")
    )
