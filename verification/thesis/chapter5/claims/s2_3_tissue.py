"""Chapter 5, section 2.3: the tissue element (Example 5.4), and what the examples model."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, Verdict, at_most, claim, proved, put_right
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.instant import TOL, omega, phi, with_springs

# y and its velocity.
ONE = np.array([1.4]), np.array([0.6])
SEED = 19


def symbolic_deformation(y: Any) -> Any:
    """Return F(y) of Example 5.4 for symbols."""
    return library().Matrix([[y[0], y[2]], [y[2], y[1]]])


@claim(
    "c5.initial-level",
    ("The constraint is F(y)⁻¹X_i = F(yⁱⁿⁱᵗ)X_iⁱⁿⁱᵗ: cross-bridges keep their place in the undeformed tissue."),
    source="(5.19)",
    quote="F(y)⁻¹ X_i = F(yⁱⁿⁱᵗ) X_iⁱⁿⁱᵗ",
    correction=Correction(
        "F(y)⁻¹ X_i = F(yⁱⁿⁱᵗ)⁻¹ X_iⁱⁿⁱᵗ",
        Effect.MODEL,
        "(5.20) and (5.32), which have it right",
        why="at t = 0 both sides must agree for all X_iⁱⁿⁱᵗ; (5.32) has the inverse",
        place=3294,
    ),
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
    "c5.shear-flow",
    "In a tissue element a cross-bridge has the velocity F(ẏ)F(y)⁻¹X_i = F(ẏ)F(yⁱⁿⁱᵗ)⁻¹X_iⁱⁿⁱᵗ.",
    source="(5.33), (5.34)",
    quote="Ẋ_i = F(ẏ)F(y)⁻¹X_i = F(ẏ)F(yⁱⁿⁱᵗ)⁻¹X_iⁱⁿⁱᵗ",
    recorded=Verdict.PROVED,
    rests_on=("c5.velocity",),
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
    "In a tissue element the density of cross-bridges is carried, and thinned where volume grows.",
    source="(5.35), (5.36)",
    quote="∂_t f = −div_x(f F(ẏ)F(y)⁻¹x) = −f tr(F(ẏ)F(y)⁻¹) − ∂_x f F(ẏ)F(y)⁻¹x",
    recorded=Verdict.PROVED,
    rests_on=("c5.shear-flow", "c5.transport"),
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


@claim(
    "c5.aligned",
    "Under shear, the stretch of a cross-bridge depends on its direction.",
    source="Figure 2",
    quote=(
        "cross-bridges which align with the directions of maximal deformation of the muscle are more extended"
        " than cross-bridges which are orthogonal"
    ),
    recorded=Verdict.PROVED,
)
def _aligned() -> Evidence:
    """F(y) in its axes, with the stretches a > b, and a cross-bridge of length 1 at the angle w to the first axis."""
    sp = library()
    a, b, w, turn = sp.symbols("a b w u", positive=True)
    axes = sp.Matrix([[sp.cos(turn), -sp.sin(turn)], [sp.sin(turn), sp.cos(turn)]])
    F = axes * sp.diag(a, b) * axes.T
    X = axes * sp.Matrix([sp.cos(w), sp.sin(w)])
    return proved(
        identity(
            "for every symmetric F(y) with stretches a, b |F X|² = a² − (a² − b²) sin²w at the angle w to the "
            "axis of a",
            lambda s: (F * X).dot(F * X) - a**2 + s * (a**2 - b**2) * sp.sin(w) ** 2,
            "+(a² − b²)",
        )
    )


@claim(
    "c5.in-class",
    "The straight fibre is an instance of the systems that the theorems are about.",
    source="section 2.3",
    quote="To motivate the class of systems, we give a few examples",
    correction=Correction(
        (
            "Examples 5.2 and 5.4 are of the class only where X and the inverse of F(y) are bounded: in Example "
            "5.2 where |X| ≤ R and y ≥ y_min > 0"
        ),
        Effect.CONCLUSION,
        "Theorems 5.9, 5.12 and 5.16 do not apply to Examples 5.2 and 5.4 as they stand",
        why=(
            "(5.5) and (A3) to (A5) are asked for all X and y, but X/y has no value at y = 0, and Φ = X/y has no bound"
        ),
        place=3284,
    ),
    tried_on="Example 5.2, |X| ≤ 2, y ≥ 0.5",
)
def _in_class() -> Evidence:
    """Bounds and difference quotients of Phi of Example 5.2 where |X| <= R, y >= y_min, and its size beyond."""
    system, rng = with_springs(lambda X, y: X / y), np.random.default_rng(SEED)
    moved = partial(phi, system)
    radius, least, size, steep = 2.0, 0.5, 0.0, 0.0
    for far in np.repeat([1e-3, 1.0], 100):
        X, y = radius * np.clip(2 * rng.normal(size=(2, 1, 1)), -1, 1), least + far * rng.exponential(1.0, (2, 1))
        one, other = moved(X[0], y[0]), moved(X[1], y[1])
        size = max(size, float(np.abs(one).max()), float(np.abs(other).max()))
        apart = float(np.abs(X[0] - X[1]).sum() + np.abs(y[0] - y[1]).sum())
        steep = max(steep, float(np.abs(one - other).max()) / apart)
    bent = float(np.abs(omega(system, X[0], y[0], *[ONE[1]] * 2)).max())
    near, beyond = (float(np.abs(moved(np.array([[x]]), ONE[0])).max()) for x in (radius, 1e6))
    bound, slope = radius / least, max(1 / least, radius / least**2)
    return Evidence(
        printed=(at_most("|Φ| of g = X/y at |X| = 10⁶ over |Φ| at |X| = 2", beyond / near, 1.0, TOL),),
        corrected=(
            at_most("|Φ| where |X| ≤ R = 2 and y ≥ y_min = 0.5, bound R/y_min", size, bound, TOL),
            at_most("difference quotient of Φ there, bound R/y_min²", steep, slope, TOL),
            at_most("|Ω| of g = X/y", bent, 0.0, TOL),
        ),
        seed=SEED,
    )


@claim(
    "c5.needs-nonlinear",
    "With linear constraints all directions are shifted alike.",
    source="before Example 5.4",
    quote=(
        "the deformation of cross-bridges is larger if they align with the axis … such dynamics require "
        "nonlinear constraints"
    ),
    recorded=Verdict.PROVED,
    rests_on=("c5.velocity", "c5.aligned"),
)
def _nonlinear() -> Evidence:
    """Phi[v] at two positions: for any linear constraint H X + K y, and for Example 5.4."""
    sp = library()
    X, Z, y, v = (sp.Matrix(sp.symbols(f"{name}:{size}")) for name, size in (("X", 2), ("Z", 2), ("y", 3), ("v", 3)))
    H, K = sp.Matrix(2, 2, sp.symbols("h:4")), sp.Matrix(2, 3, sp.symbols("k:6"))

    def apart(s: Any) -> Any:
        g = H * X + K * y if s == 1 else symbolic_deformation(y).inv() * X
        U = -g.jacobian(X).inv() * g.jacobian(y) * v
        return U - U.subs(dict(zip(X, Z, strict=True)))

    return proved(
        identity(
            "for every linear constraint HX + Ky Φ[ẏ] is the same for all X, so all directions are shifted alike",
            apart,
            "the same for Example 5.4",
        )
    )
