"""Chapter 5, section 2.3: the straight fibre (Example 5.2), linearised (Example 5.3), and linear constraints."""

from __future__ import annotations

from verification.claims import Correction, Effect
from verification.claims.formal.algebra import library, matrices
from verification.claims.formal.stated import identity

sp = library()
x, y, m, a, f, n, c = sp.symbols("x y m a f N y_c", positive=True)
t, z = sp.symbols("t z")
height, start, density = sp.Function("y")(t), sp.Symbol("start"), sp.Function("f0")
phi = x / y
# The multiplier by (5.6a): for g = X/y lambda/y = F1 - m X'', and for g = X - y lambda = F1 - m y''.
level, linear_level = y * (f - m * phi * a), f - m * a
GM, Y, Y0, X0 = matrices("G y y0 X0")

NO_INTERACTION = "no interaction between the particles, as in all examples"

_straight_flow = identity(
    "c5.straight-flow",
    "(5.21)",
    "Φ(X_i, y) = X_i/y and Ω(X_i, y) = X_i/y² + −X_i/y² = 0",
    "A straight fibre has Φ = X_i/y and Ω = 0.",
    right=phi.diff(x) * phi + phi.diff(y),
    wrong=phi.diff(x) * phi - phi.diff(y),
    rests_on=("c5.derivation-constraint",),
)

_straight_mass = identity(
    "c5.straight-mass",
    "(5.22)",
    "m_eff = m I + 1/N Σ_j X_j²/y²",
    "A straight fibre has the effective mass m + ⟨X_j²⟩/y².",
    right=(1 + m * phi**2) * a - (a - level * x / y**2) - phi * f,
    wrong=(m + phi**2) * a - (a - level * x / y**2) - phi * f,
    correction=Correction(
        "m_eff = 1 + m/N Σ_j X_j²/y²",
        Effect.MODEL,
        "the motion of Example 5.2",
        why="(5.13) with Φ = X/y: the mass of the macroscopic component is 1, and m multiplies Φ²",
        place=3310,
    ),
    rests_on=("c5.straight-flow", "c5.reduced-model"),
    chosen=NO_INTERACTION,
)

_straight_force = identity(
    "c5.straight-force",
    "(5.23)",
    "F_eff = F₀(y) + 1/N Σ_j X_j/y F₁(X_j)",
    "A straight fibre has the effective force F₀ + ⟨X_j F₁(X_j)⟩/y.",
    right=level * x / y**2 + m * phi**2 * a - phi * f,
    wrong=level * x / y**2 + m * phi**2 * a + phi * f,
    rests_on=("c5.straight-flow", "c5.reduced-model"),
    chosen=NO_INTERACTION,
)

# (5.24) in the coordinate X.
near = x / c - y / (n * c**2)
near_phi = -near.diff(y) / near.diff(x)

_coordinates = identity(
    "c5.coordinates",
    "Example 5.3",
    "we apply the coordinate change X̃_i = y_c/X_c X_i = N y_c X_i … m_eff = m I + 1",
    "In the scaled coordinate the effective mass of y is 1 + m.",
    right=1 + m * near_phi**2 - (1 + m / (n * c) ** 2),
    wrong=1 + m * near_phi**2 - (1 + m),
    correction=Correction(
        "m_eff = 1 + m(X_c/y_c)² = 1 + m/(N y_c)², and (X_c/y_c)F₁ for F₁; or m and F₁ are said to be those of X̃",
        Effect.MODEL,
        "(5.26) to (5.30): by the letter they are another model than the linearised one, which depends on N",
        why="m is the mass that multiplies Ẍ_i in (5.6a), and Ẋ_i is X_c/y_c times the rate of X̃_i",
        place=3324,
    ),
    rests_on=("c5.reduced-model",),
)

_linear_mass = identity(
    "c5.linear-mass",
    "(5.26)",
    "for g_L = X̃_i − y: m_eff = m I + 1",
    "With the linearised constraint the effective mass is m + 1.",
    right=1 + m * (x - y).diff(y) ** 2 - (1 + m),
    wrong=1 + m * (x - y).diff(y) ** 2 - (m - 1),
    rests_on=("c5.reduced-model",),
)

_linear_force = identity(
    "c5.linear-force",
    "(5.27)",
    "F_eff(X̃₁, …, X̃_N, y) = F₀(y) + 1/N Σ_j F₁(X̃_j)",
    "With the linearised constraint the effective force is F₀ + ⟨F₁(X̃_j)⟩.",
    right=linear_level + m * a - f,
    wrong=linear_level + m * a + f,
    rests_on=("c5.reduced-model",),
)

_linear_newton = identity(
    "c5.linear-newton",
    "(5.28); (5.30)",
    "mÿ = F₀(y) + 1/N Σ_j F₁(X̃_j)",
    "With the linearised constraint mÿ = F₀ + ⟨F₁(X̃_j)⟩.",
    right=(1 + m) * a - (a - linear_level) - f,
    wrong=m * a - (a - linear_level) - f,
    also=("c5.linear-limit",),
    correction=Correction(
        "(1 + m)ÿ = F₀(y) + 1/N Σ_j F₁(X̃_j)",
        Effect.MODEL,
        "the motion of Example 5.3; (5.26) is right",
        why="(5.11a) with the effective mass 1 + m of (5.26)",
        place=3330,
    ),
    rests_on=("c5.linear-mass", "c5.linear-force"),
)

_linear_transport = identity(
    "c5.linear-transport",
    "(5.31)",
    "∂_t f(x, t) = −∂_x(f(x, t) ẏ(t))",
    "With the linearised constraint the density is shifted.",
    right=density(z - height).diff(t) + (density(z - height) * height.diff(t)).diff(z),
    wrong=density(z - height).diff(t) - (density(z - height) * height.diff(t)).diff(z),
    rests_on=("c5.linear-velocity", "c5.transport"),
)

_linear_velocity = identity(
    "c5.linear-velocity",
    "(5.29)",
    "X̃_i = ẏ",
    "With the linearised constraint X̃_i = ẏ.",
    right=(start + height).diff(t) - height.diff(t),
    wrong=start + height - height.diff(t),
    correction=Correction(
        "dX̃_i/dt = ẏ",
        Effect.MODEL,
        "the motion of Example 5.3; (5.31) is right",
        why="(5.11b) with Φ = 1: the constraint is differentiated in time, and a position is no velocity",
        place=3332,
    ),
    rests_on=("c5.derivation-constraint",),
)

_linear_map = identity(
    "c5.linear-map",
    "after (5.31)",
    "g = Gy − X_i imply that Φ = G is constant and Ω = 0 … X_i(t) = X_iⁱⁿⁱᵗ + G(y(t) − yⁱⁿⁱᵗ)",
    "With linear constraints G y − X the positions are an explicit function of y, so Φ = G is constant and Ω = 0.",
    right=GM * Y - (X0 + GM * (Y - Y0)) - (GM * Y0 - X0),
    wrong=GM * Y - (X0 - GM * (Y - Y0)) - (GM * Y0 - X0),
    rests_on=("c5.derivation-constraint",),
)
