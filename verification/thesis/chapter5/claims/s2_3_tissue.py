"""Chapter 5, section 2.3: the tissue element (Example 5.4), and what the examples model."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.claims.formal.algebra import library, matrices, vanishes
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter5.instant import TOL, omega, phi, with_springs

sp = library()
t, p, q, f1, f2 = sp.symbols("t p q f1 f2")
stretch, thinner, w, turn = sp.symbols("a b w u", positive=True)
y3, v3, z3 = (sp.Matrix(sp.symbols(f"{name}:3")) for name in "yvz")
X2, Z2, S2 = (sp.Matrix(sp.symbols(f"{name}:2")) for name in "XZx")
H, K = sp.Matrix(2, 2, sp.symbols("h:4")), sp.Matrix(2, 3, sp.symbols("k:6"))

# y and its velocity.
ONE = np.array([1.4]), np.array([0.6])
SEED = 19

F, place = matrices("F X")

_level = identity(
    "c5.initial-level",
    "(5.19)",
    "F(y)⁻¹ X_i = F(yⁱⁿⁱᵗ) X_iⁱⁿⁱᵗ",
    "The constraint is F(y)⁻¹X_i = F(yⁱⁿⁱᵗ)X_iⁱⁿⁱᵗ: cross-bridges keep their place in the undeformed tissue.",
    right=F**-1 * place - F**-1 * place,
    wrong=F**-1 * place - F * place,
    correction=Correction(
        "F(y)⁻¹ X_i = F(yⁱⁿⁱᵗ)⁻¹ X_iⁱⁿⁱᵗ",
        Effect.MODEL,
        "(5.20) and (5.32), which have it right",
        why="at t = 0 both sides must agree for all X_iⁱⁿⁱᵗ; (5.32) has the inverse",
        place=3294,
    ),
)


def flow(g: Any) -> Any:
    """Return Phi[v] of a constraint."""
    return -g.jacobian(X2).inv() * g.jacobian(y3) * v3


def F_of(y: Any) -> Any:
    """Return F(y) of Example 5.4, which is linear in y."""
    return sp.Matrix([[y[0], y[2]], [y[2], y[1]]])


SHEAR = flow(F_of(y3).inv() * X2)
CARRIED = F_of(y3) * F_of(z3).inv() * S2

_shear_flow = identity(
    "c5.shear-flow",
    "(5.33), (5.34)",
    "Ẋ_i = F(ẏ)F(y)⁻¹X_i = F(ẏ)F(yⁱⁿⁱᵗ)⁻¹X_iⁱⁿⁱᵗ",
    "In a tissue element a cross-bridge has the velocity F(ẏ)F(y)⁻¹X_i = F(ẏ)F(yⁱⁿⁱᵗ)⁻¹X_iⁱⁿⁱᵗ.",
    right=[
        SHEAR - F_of(v3) * F_of(y3).inv() * X2,
        (F_of(v3) * F_of(y3).inv() * X2).subs(dict(zip(X2, CARRIED, strict=True))) - F_of(v3) * F_of(z3).inv() * S2,
    ],
    wrong=SHEAR + F_of(v3) * F_of(y3).inv() * X2,
    rests_on=("c5.derivation-constraint",),
)

# A density that is carried along keeps f det F(y); its rate at a fixed point, by the product rule.
path = sp.Matrix([sp.Function(f"y{k}")(t) for k in range(3)])
rate, f = F_of(path.diff(t)) * F_of(path).inv(), sp.Function("f")(p, q)
u = rate * sp.Matrix([p, q])
DIVERGENCE = (f * u[0]).diff(p) + (f * u[1]).diff(q) - f * rate.trace()

_shear_transport = argument(
    "c5.shear-transport",
    "(5.35), (5.36)",
    "∂_t f = −div_x(f F(ẏ)F(y)⁻¹x) = −f tr(F(ẏ)F(y)⁻¹) − ∂_x f F(ẏ)F(y)⁻¹x",
    "In a tissue element the density of cross-bridges is carried, and thinned where volume grows.",
    vanishes(
        F_of(path).det().diff(t) - F_of(path).det() * rate.trace(),
        F_of(path).det().diff(t) + F_of(path).det() * rate.trace(),
        "d/dt det F(y) = det F(y) tr(F(ẏ)F(y)⁻¹): volumes grow at the rate tr(F(ẏ)F(y)⁻¹)",
        "−tr",
    ),
    vanishes(
        DIVERGENCE - f.diff(p) * u[0] - f.diff(q) * u[1],
        DIVERGENCE + f.diff(p) * u[0] + f.diff(q) * u[1],
        "div(f F(ẏ)F(y)⁻¹x) = f tr(F(ẏ)F(y)⁻¹) + ∂_x f F(ẏ)F(y)⁻¹x for every f",
        "−∂_x f",
    ),
    rests_on=("c5.shear-flow", "c5.transport"),
    chosen="f(x, t) on the right side, too, see c5.density-time",
)

axes = sp.Matrix([[sp.cos(turn), -sp.sin(turn)], [sp.sin(turn), sp.cos(turn)]])
bridge = axes * sp.diag(stretch, thinner) * sp.Matrix([sp.cos(w), sp.sin(w)])
LENGTH, SINE = bridge.dot(bridge) - stretch**2, (stretch**2 - thinner**2) * sp.sin(w) ** 2

_aligned = identity(
    "c5.aligned",
    "Figure 2",
    "cross-bridges which align with the directions of maximal deformation of the muscle are more extended than "
    "cross-bridges which are orthogonal",
    "Under stretches a > b |F X|² = a² − (a² − b²) sin²w for a cross-bridge of length 1 at the angle w to the axis of "
    "a.",
    right=LENGTH + SINE,
    wrong=LENGTH - SINE,
)


@claim(
    "c5.in-class",
    "The straight fibre is an instance of the systems that the theorems are about.",
    source="section 2.3",
    quote="To motivate the class of systems, we give a few examples",
    correction=Correction(
        (
            "Examples 5.2 and 5.4 are of the class only where X and the inverse of F(y) are bounded: in Example 5.2 "
            "where |X| ≤ R and y ≥ y_min > 0"
        ),
        Effect.CONCLUSION,
        "Theorems 5.9, 5.12 and 5.16 do not apply to Examples 5.2 and 5.4 as they stand",
        why="(5.5) and (A3) to (A5) are asked for all X and y, but X/y has no value at y = 0, and Φ = X/y has no bound",
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


SHIFT = flow(H * X2 + K * y3)
OTHER = dict(zip(X2, Z2, strict=True))

_nonlinear = identity(
    "c5.needs-nonlinear",
    "before Example 5.4",
    "the deformation of cross-bridges is larger if they align with the axis … such dynamics require nonlinear "
    "constraints",
    "With linear constraints HX + Ky all directions are shifted alike: Φ[ẏ] is the same for all X.",
    right=SHIFT - SHIFT.subs(OTHER),
    wrong=SHEAR - SHEAR.subs(OTHER),
    rests_on=("c5.derivation-constraint", "c5.aligned"),
)
