"""Chapter 5, section 2.3: the straight fibre (Example 5.2), linearised (Example 5.3), and linear constraints."""

from __future__ import annotations

from verification.claims import Correction, Effect, Evidence, FormalProof, Verdict, claim, proved, put_right
from verification.formal.algebra import identity, library, matrices

NO_INTERACTION = "no interaction between the particles, as in all examples"


@claim(
    "c5.straight-flow",
    "A straight fibre has Φ = X_i/y and Ω = 0.",
    source="(5.21)",
    quote="Φ(X_i, y) = X_i/y and Ω(X_i, y) = X_i/y² + −X_i/y² = 0",
    recorded=Verdict.PROVED,
    rests_on=("c5.velocity",),
)
def _straight_flow() -> Evidence:
    x, y = library().symbols("x y", positive=True)
    g = x / y
    phi = -g.diff(y) / g.diff(x)
    return proved(
        identity(
            "Φ = X/y and Ω = ∂_XΦ Φ + ∂_yΦ = 0", lambda s: [phi - x / y, phi.diff(x) * phi + s * phi.diff(y)], "−∂_yΦ"
        )
    )


@claim(
    "c5.straight-mass",
    "A straight fibre has the effective mass m + ⟨X_j²⟩/y².",
    source="(5.22)",
    quote="m_eff = m I + 1/N Σ_j X_j²/y²",
    correction=Correction(
        "m_eff = 1 + m/N Σ_j X_j²/y²",
        Effect.MODEL,
        "the motion of Example 5.2",
        why="(5.13) with Φ = X/y: the mass of the macroscopic component is 1, and m multiplies Φ²",
        place=3310,
    ),
    rests_on=("c5.straight-flow", "c5.effective"),
    chosen=NO_INTERACTION,
)
def _straight_mass() -> Evidence:
    """The terms of one particle: lambda = y (f - m Phi y'') by (5.6a), y'' = F0 + lambda X/y^2 by (5.6b), Phi = X/y."""
    x, y, m, a, f = library().symbols("x y m a f", positive=True)
    force0 = a - y * (f - m * x / y * a) * x / y**2
    return put_right(
        identity(
            "m_eff ÿ = F₀ + ⟨X F₁⟩/y with m_eff = 1 + m⟨X²⟩/y²",
            lambda s: ((1 + m * x**2 / y**2) if s == 1 else (m + x**2 / y**2)) * a - force0 - x / y * f,
            "with m_eff = m + ⟨X²⟩/y²",
        )
    )


@claim(
    "c5.straight-force",
    "A straight fibre has the effective force F₀ + ⟨X_j F₁(X_j)⟩/y.",
    source="(5.23)",
    quote="F_eff = F₀(y) + 1/N Σ_j X_j/y F₁(X_j)",
    recorded=Verdict.PROVED,
    rests_on=("c5.straight-flow", "c5.effective"),
    chosen=NO_INTERACTION,
)
def _straight_force() -> Evidence:
    """The terms of one particle: lambda/y = F1 - m x'' by (5.6a), and y feels lambda X/y^2 by (5.6b)."""
    x, y, m, a, f = library().symbols("x y m a f", positive=True)
    phi = x / y
    level = y * (f - m * phi * a)
    return proved(
        identity(
            "for g = X/y, where Ω = 0, (5.6b) says ÿ + m⟨X²⟩/y² ÿ = F₀ + ⟨X F₁(X)⟩/y",
            lambda s: level * x / y**2 + m * phi**2 * a - s * phi * f,
            "−X F₁",
        )
    )


@claim(
    "c5.coordinates",
    "In the scaled coordinate the effective mass of y is 1 + m.",
    source="Example 5.3",
    quote="we apply the coordinate change X̃_i = y_c/X_c X_i = N y_c X_i … m_eff = m I + 1",
    correction=Correction(
        ("m_eff = 1 + m(X_c/y_c)² = 1 + m/(N y_c)², and (X_c/y_c)F₁ for F₁; or m and F₁ are said to be those of X̃"),
        Effect.MODEL,
        "(5.26) to (5.30): by the letter they are another model than the linearised one, which depends on N",
        why="m is the mass that multiplies Ẍ_i in (5.6a), and Ẋ_i is X_c/y_c times the rate of X̃_i",
        place=3324,
    ),
    rests_on=("c5.effective",),
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
    "With the linearised constraint the effective mass is m + 1.",
    source="(5.26)",
    quote="for g_L = X̃_i − y: m_eff = m I + 1",
    recorded=Verdict.PROVED,
    rests_on=("c5.effective",),
)
def _linear_mass() -> Evidence:
    m, x, y = library().symbols("m x y")
    g = x - y
    phi = -g.diff(y) / g.diff(x)
    return proved(identity("1 + mΦ² = 1 + m for g = X̃ − y", lambda s: 1 + m * phi**2 - (s + m), "m − 1"))


@claim(
    "c5.linear-force",
    "With the linearised constraint the effective force is F₀ + ⟨F₁(X̃_j)⟩.",
    source="(5.27)",
    quote="F_eff(X̃₁, …, X̃_N, y) = F₀(y) + 1/N Σ_j F₁(X̃_j)",
    recorded=Verdict.PROVED,
    rests_on=("c5.effective",),
)
def _linear_force() -> Evidence:
    """The terms of one particle: m a = f - lambda by (5.6a), and y feels -lambda by (5.6b)."""
    m, a, f = library().symbols("m a f")
    level = f - m * a
    return proved(
        identity("for g = X̃ − y (5.6b) says (1 + m)ÿ = F₀ + ⟨F₁(X̃)⟩", lambda s: -level - m * a + s * f, "−F₁")
    )


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
    "With the linearised constraint mÿ = F₀ + ⟨F₁(X̃_j)⟩.",
    source="(5.28); (5.30)",
    also=("c5.linear-limit",),
    quote="mÿ = F₀(y) + 1/N Σ_j F₁(X̃_j)",
    correction=Correction(
        "(1 + m)ÿ = F₀(y) + 1/N Σ_j F₁(X̃_j)",
        Effect.MODEL,
        "the motion of Example 5.3; (5.26) is right",
        why="(5.11a) with the effective mass 1 + m of (5.26)",
        place=3330,
    ),
    rests_on=("c5.linear-mass", "c5.linear-force"),
)
def _linear_newton() -> Evidence:
    return put_right(newton())


@claim(
    "c5.linear-transport",
    "With the linearised constraint the density is shifted.",
    source="(5.31)",
    quote="∂_t f(x, t) = −∂_x(f(x, t) ẏ(t))",
    recorded=Verdict.PROVED,
    rests_on=("c5.linear-velocity", "c5.transport"),
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
    "With the linearised constraint X̃_i = ẏ.",
    source="(5.29)",
    quote="X̃_i = ẏ",
    correction=Correction(
        "dX̃_i/dt = ẏ",
        Effect.MODEL,
        "the motion of Example 5.3; (5.31) is right",
        why="(5.11b) with Φ = 1: the constraint is differentiated in time, and a position is no velocity",
        place=3332,
    ),
    rests_on=("c5.velocity",),
)
def _linear_velocity() -> Evidence:
    sp = library()
    t, start = sp.symbols("t x")
    y = sp.Function("y")(t)
    path = start + y - y.subs(t, 0)
    return put_right(
        identity(
            "X̃ − y = const gives dX̃/dt = ẏ", lambda s: (path.diff(t) if s == 1 else path) - y.diff(t), "gives X̃ = ẏ"
        )
    )


@claim(
    "c5.linear-map",
    "With linear constraints the positions are an explicit function of the macroscopic state.",
    source="after (5.31)",
    quote="g = Gy − X_i imply that Φ = G is constant and Ω = 0 … X_i(t) = X_iⁱⁿⁱᵗ + G(y(t) − yⁱⁿⁱᵗ)",
    recorded=Verdict.PROVED,
    rests_on=("c5.velocity",),
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
