"""Chapter 5, section 2.3: motion with the linearised constraint (Example 5.3) and with linear ones."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from verification.claims import Evidence, FormalProof, Verdict, proved, put_right
from verification.formal.algebra import identity, library, matrices
from verification.thesis.text.quoted import claim


def newton() -> FormalProof:
    """Prove (5.28) as corrected: lambda = f - m y'' by (5.6a), y'' = F0 + lambda by (5.6b), means over particles."""
    return identity(
        "(1 + m)ÿ = F₀ + ⟨F₁⟩ for g = X̃ − y",
        lambda s, m, a, f: (s + m) * a - (a - (f - m * a)) - f,
        "mÿ = F₀ + ⟨F₁⟩",
        0,
    )


@claim(
    "c5.linear-newton",
    "The equation of motion with the linearised constraint.",
    "(5.28)",
    Verdict.CORRECTED,
)
def _linear_newton() -> Evidence:
    return put_right(newton())


@claim(
    "c5.linear-limit",
    "The mean-field equation of motion with the linearised constraint.",
    "(5.30)",
    Verdict.CORRECTED,
)
def _linear_limit() -> Evidence:
    """The mean over particles or over a density."""
    return put_right(newton())


@claim(
    "c5.linear-transport",
    "With the linearised constraint the density is shifted.",
    "(5.31)",
    Verdict.PROVED,
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
    "(5.29)",
    Verdict.CORRECTED,
)
def _linear_velocity() -> Evidence:
    sp = library()
    t, start = sp.symbols("t x")
    y = sp.Function("y")(t)
    path = start + y - y.subs(t, 0)
    return put_right(
        identity(
            "X̃ − y = const gives dX̃/dt = ẏ",
            lambda s: (path.diff(t) if s == 1 else path) - y.diff(t),
            "gives X̃ = ẏ",
        )
    )


@claim(
    "c5.linear-map",
    "With linear constraints the positions are an explicit function of the macroscopic state.",
    "after (5.31)",
    Verdict.PROVED,
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
