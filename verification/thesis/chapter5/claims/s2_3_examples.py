"""Chapter 5, section 2.3: the straight fibre (Example 5.2) and the tissue element (Example 5.4)."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from verification.claims import Evidence, Verdict, proved, put_right
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.instant import (
    Floats,
    Instant,
    System,
    instant,
)
from verification.thesis.text.quoted import claim

M = 0.7
X0 = np.array([[0.5], [1.2], [-0.8]])
ONE = np.array([1.4]), np.array([0.6])
NO_INTERACTION = "no interaction between the particles, as in all examples"


def symbolic_deformation(y: Any) -> Any:
    """F(y) of Example 5.4 for symbols."""
    return library().Matrix([[y[0], y[2]], [y[2], y[1]]])


def with_springs(g: Callable[[Floats, Floats], Floats]) -> System:
    """A constraint with linear forces F0 = 1 - y, F1 = -0.6 X and no interaction."""
    return System(M, g, lambda y: ((y - 1.0) ** 2).sum() / 2, lambda X: 0.3 * (X**2).sum(-1), lambda r: 0 * r[..., 0])


def shifted() -> Instant:
    """Example 5.3, (5.25)."""
    return instant(with_springs(lambda X, y: X - y), X0, *ONE)


@claim(
    "c5.initial-level",
    "The cross-bridges keep their place in the undeformed tissue.",
    "(5.19)",
    Verdict.CORRECTED,
)
def _level() -> Evidence:
    """At the start y = y_init and X = X_init."""
    return put_right(
        identity(
            "F(y)⁻¹X = F(yⁱⁿⁱᵗ)⁻¹Xⁱⁿⁱᵗ holds at the start",
            lambda s, F, X: F**-1 * X - F**-s * X,
            "F(y)⁻¹X = F(yⁱⁿⁱᵗ)Xⁱⁿⁱᵗ holds at the start",
            words=True,
        )
    )


@claim(
    "c5.straight-slopes",
    "The derivatives of the constraint of a straight fibre.",
    "(5.20)",
    Verdict.PROVED,
)
def _straight_slopes() -> Evidence:
    x, y = library().symbols("x y", positive=True)
    return proved(
        identity(
            "the slopes of X/y are 1/y and −X/y²",
            lambda s: [(x / y).diff(x) - 1 / y, (x / y).diff(y) + s * x / y**2],
            "+X/y²",
        )
    )


@claim(
    "c5.straight-flow",
    "Velocities and curvature of the motion of a straight fibre.",
    "(5.21)",
    Verdict.PROVED,
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
    "The effective mass of a straight fibre.",
    "(5.22)",
    Verdict.CORRECTED,
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
    "The effective force of a straight fibre.",
    "(5.23)",
    Verdict.PROVED,
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
    "c5.shear-flow",
    "The velocity of a cross-bridge in a deforming tissue element, in two forms.",
    "(5.33), (5.34)",
    Verdict.PROVED,
)
def _shear_flow() -> Evidence:
    """F(y) is linear in y; X = F(y) F(y_init)^-1 X_init."""
    sp = library()
    y, v, y0, X0 = (sp.Matrix(sp.symbols(f"{name}:3")) for name in ("y", "v", "z", "x"))
    X0 = X0[:2, :]
    X = sp.Matrix(sp.symbols("X:2"))
    g = symbolic_deformation(y).inv() * X
    U = -g.jacobian(X).inv() * g.jacobian(y) * v

    def residuals(s: Any) -> Any:
        carried = symbolic_deformation(y) * symbolic_deformation(y0).inv() * X0
        first = symbolic_deformation(v) * symbolic_deformation(y).inv() * X
        return [
            U - s * first,
            first.subs(dict(zip(X, carried, strict=True)))
            - symbolic_deformation(v) * symbolic_deformation(y0).inv() * X0,
        ]

    return proved(
        identity("Φ[ẏ] = F(ẏ)F(y)⁻¹X = F(ẏ)F(yⁱⁿⁱᵗ)⁻¹Xⁱⁿⁱᵗ for all y, ẏ, X of Example 5.4", residuals, "−F(ẏ)")
    )


@claim(
    "c5.shear-transport",
    "How the density of cross-bridges in a tissue element changes.",
    "(5.35), (5.36)",
    Verdict.PROVED,
    chosen="f(x, t) on the right side, too, see c5.density-time",
)
def _shear_transport() -> Evidence:
    """A density that is carried along keeps f det F(y); its rate at a fixed point, by the product rule."""
    sp = library()
    t, a, b = sp.symbols("t a b")
    y = sp.Matrix([sp.Function(f"y{k}")(t) for k in range(3)])
    F = symbolic_deformation(y)
    A, f, x = symbolic_deformation(y.diff(t)) * F.inv(), sp.Function("f")(a, b), sp.Matrix([a, b])
    flow = A * x

    def printed(s: Any) -> Any:
        return f * A.trace() + s * (f.diff(a) * flow[0] + f.diff(b) * flow[1])

    return proved(
        identity(
            "d/dt det F(y) = det F(y) tr(F(ẏ)F(y)⁻¹): volumes grow at the rate tr(F(ẏ)F(y)⁻¹)",
            lambda s: F.det().diff(t) - s * F.det() * A.trace(),
            "−tr",
        ),
        identity(
            "div(f F(ẏ)F(y)⁻¹x) = f tr(F(ẏ)F(y)⁻¹) + ∂_x f F(ẏ)F(y)⁻¹x for every f",
            lambda s: (f * flow[0]).diff(a) + (f * flow[1]).diff(b) - printed(s),
            "−∂_x f",
        ),
    )
