"""Chapter 5, section 2.3: motion with the linearised constraint (Example 5.3) and with linear ones."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from verification.claims import Correction, Effect, Evidence, FormalProof, Kind, claim, proved, put_right
from verification.formal.algebra import identity, library, matrices


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
)
def _linear_newton() -> Evidence:
    return put_right(newton())


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
)
def _linear_limit() -> Evidence:
    """The mean over particles or over a density."""
    return put_right(newton())


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
