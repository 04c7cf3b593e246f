"""Chapter 5, section 1: what the introduction says."""

from __future__ import annotations

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import reals
from verification.claims.formal.stated import argument
from verification.thesis.chapter5.instant import TOL, WRONG, effective_force, force1, symbolic_soft, with_springs

sp = library()
x = sp.symbols("x", positive=True)


# The straight fibre, g = X/y, and other = g(eX, y); e is the factor of X, epsilon or epsilon^2.
X, y = reals("x y")


@claim(
    "c5.generalises",
    "The results contain those for linear constraints and forces.",
    source="section 1",
    quote=(
        "This article generalises … Instead of assuming that the constraints and forces are linear, we allow nonlinear"
    ),
    correction=Correction(
        (
            "linear forces are excluded by (A1b), (A1d); with a constant Φ the bounds can be dropped, and then the "
            "linear case is included"
        ),
        Effect.CONCLUSION,
        "Theorems 5.9, 5.12 and 5.16 do not apply to the linear case of the previous work as they stand",
        why=(
            "(A1b) and (A1d) ask for bounded forces, and a linear force is not bounded unless it is 0; the bounds are "
            "needed only where Φ changes"
        ),
        place=3135,
    ),
    rests_on=("c5.reduced-model",),
    tried_on="one spring, g = X − y",
)
def _generalises() -> Evidence:
    """Linear forces and g = X - y: the size of F1, and difference quotients of the force on y, near and far."""
    system = with_springs(lambda X, y: X - y)
    near, far = (float(np.abs(force1(system, np.array([[x]]))).max()) for x in (1.0, 1e6))

    def slope(x: float) -> float:
        there, back = (effective_force(system, np.array([[x + s]]), np.ones(1), np.ones(1)).item() for s in (0.5, -0.5))
        return abs(there - back)

    return Evidence(
        printed=(at_most("‖F₁‖ of a linear force at |X| = 10⁶ over ‖F₁‖ at |X| = 1", far / near, 1.0, TOL),),
        corrected=(
            at_least("‖F₁‖ of a linear force at |X| = 10⁶", far, 1 / WRONG),
            equal("slope of F_eff at X = 10⁶ over the slope at X = 1, for a constant Φ", slope(1e6) / slope(1), 1, TOL),
        ),
    )


m, v = sp.symbols("m v")
# One particle with X' = Phi(X) y': g = X + sin(X)/2 - y, and g = X - y with Phi = 1.
RATE = (m * symbolic_soft(x) ** 2).diff(x) * symbolic_soft(x) * v

_changing_mass = argument(
    "c5.changing-mass",
    "section 1; introduction, Part III",
    "the mean-field mass is non-constant in contrast to the linear case",
    "With nonlinear constraints the effective mass changes during the motion.",
    vanishes(
        [RATE - m * symbolic_soft(x) ** 4 * sp.sin(x) * v, (1 + m * sp.Integer(1) ** 2).diff(x)],
        RATE,
        "d/dt(1 + mΦ²) is mΦ⁴ sin(X) ẏ for g = X + sin(X)/2 − y, not 0 where sin X and ẏ are not, and 0 for g = X − y",
        "0 for both",
    ),
    also=("c0.mean-field-mass",),
    rests_on=("c5.reduced-model",),
)
