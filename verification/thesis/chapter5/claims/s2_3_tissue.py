"""Chapter 5, section 2.3: the tissue element (Example 5.4), and what the examples model."""

from __future__ import annotations

from functools import partial

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_most, claim
from verification.thesis.chapter5.instant import TOL, omega, phi, with_springs

# y and its velocity.
ONE = np.array([1.4]), np.array([0.6])
SEED = 19


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
