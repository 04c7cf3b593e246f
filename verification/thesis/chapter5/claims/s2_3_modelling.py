"""Chapter 5, section 2.3: whether the examples belong to the class, and how tissue deforms its cross-bridges."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from functools import partial

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter5.claims.s2_3_examples import ONE, PLANE, deformation, tissue, with_springs
from verification.thesis.chapter5.instant import Floats, omega, phi
from verification.thesis.chapter5.wavy import runge_kutta

# What rounding, complex steps and Runge-Kutta steps leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-4
# Angles between 0 and pi at which cross-bridges are tried.
ANGLES = np.linspace(0.0, np.pi, 181)[:-1]
SHEAR = 0.4
SEED = 19


def lengths(y: Floats, angles: Floats) -> Floats:
    """The lengths of cross-bridges of length 1 at y = (1, 1, 0), after a deformation to y, (5.32)."""
    X = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return np.asarray(np.linalg.norm(X @ deformation(y).T, axis=-1))


@claim(
    "c5.aligned",
    "Under shear, the stretch of a cross-bridge depends on its direction.",
    source="Figure 2",
    quote=(
        "cross-bridges which align with the directions of maximal deformation of the muscle are more extended than "
        "cross-bridges which are orthogonal"
    ),
    recorded=Kind.NOT_REFUTED,
    chosen=f"y = (1, 1, {SHEAR})",
    tried_on="one shear, 180 directions",
)
def _aligned() -> Evidence:
    y = np.array([1.0, 1.0, SHEAR])
    found = lengths(y, ANGLES)
    longest = ANGLES[found.argmax()]
    axis = np.linalg.svd(deformation(y))[2][0]
    off = float(1 - abs(axis @ [np.cos(longest), np.sin(longest)]))
    along, across = float(found.max()), lengths(y, np.array([longest + np.pi / 2])).item()
    return Evidence(
        f"A shear of {SHEAR}: of cross-bridges in {ANGLES.size} directions the longest lies in the axis of the largest "
        f"stretch (cosine off by {off:.0e}) and is {along:.2f} times as long as before, the one orthogonal to it "
        f"{across:.2f} times.",
        printed=(
            at_most("1 − cosine between the longest and the axis", off, 0.0, TOL),
            at_least("length along over length across", along / across, 1 + WRONG),
        ),
    )


@claim(
    "c5.in-class",
    "The straight fibre is an instance of the systems that the theorems are about.",
    source="section 2.3",
    quote="To motivate the class of systems, we give a few examples",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "Examples 5.2 and 5.4 are of the class only where X and the inverse of F(y) are bounded: in Example 5.2 where "
        "|X| ≤ R and y ≥ y_min > 0",
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
        f"For |X| ≤ {radius:g}, y ≥ {least:g} g = X/y has |Φ| up to {size:.2f} ≤ R/y_min = {bound:g}, difference "
        f"quotients up to {steep:.2f} ≤ {slope:g}, Ω = 0. Beyond, (A4b) fails: |Φ| is {beyond:.0e} at |X| = 10⁶, and "
        "g has no value at y = 0.",
        printed=(at_most("|Φ| at |X| = 10⁶ over |Φ| at |X| = R", beyond / near, 1.0, TOL),),
        corrected=(
            at_most("|Φ| where |X| ≤ R and y ≥ y_min", size, bound, TOL),
            at_most("difference quotient of Φ there", steep, slope, TOL),
            at_most("|Ω|", bent, 0.0, TOL),
        ),
        seed=SEED,
    )


def placed(y: Floats, p: Floats) -> Floats:
    """Where the points p of the tissue are after a deformation from (1, 1, 0) to y."""
    return np.asarray(p @ deformation(y).T)


@claim(
    "c5.position",
    "The deformed cross-bridge depends on its vector only, not on its place.",
    source="section 2.3",
    quote=(
        "Since we consider a homogeneous deformation of the muscle tissue, the position p of the cross-bridge is "
        "irrelevant"
    ),
    recorded=Kind.NOT_REFUTED,
    tried_on="20 places, one deformation",
)
def _position() -> Evidence:
    """Both ends of a cross-bridge at several places, and in a tissue that is bent as well."""
    p, X = np.random.default_rng(SEED).normal(size=(20, 2)), np.array([0.3, -0.5])
    spans = placed(PLANE[0], p + X) - placed(PLANE[0], p)
    bent = spans + 0.1 * ((p + X) ** 2 - p**2)
    same, differ = (float(np.ptp(span, axis=0).max()) for span in (spans, bent))
    return Evidence(
        f"A cross-bridge at 20 places p: after a homogeneous deformation the spans differ by {same:.0e}, with a "
        f"bending of 0.1|p|² they would by {differ:.2f}.",
        printed=(
            at_most("spans apart, homogeneous deformation", same, 0.0, TOL),
            at_least("spans apart, bent as well", differ, WRONG),
        ),
        seed=SEED,
    )


@claim(
    "c5.needs-nonlinear",
    "With linear constraints all directions are shifted alike.",
    source="before Example 5.4",
    quote=(
        "the deformation of cross-bridges is larger if they align with the axis … such dynamics require nonlinear "
        "constraints"
    ),
    recorded=Kind.NOT_REFUTED,
    tried_on="one linear constraint, one tissue element",
)
def _nonlinear() -> Evidence:
    """How much faster one angle is than another: the shear element, and a linear constraint G y - X."""
    X, v = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=-1), PLANE[1]
    G = np.array([[0.3, -0.2, 0.7], [0.5, 0.1, -0.4]])
    bent = phi(tissue().system, X, PLANE[0]) @ v
    straight = phi(with_springs(lambda x, y: G @ y - x), X, PLANE[0]) @ v
    spread, none = (float(np.ptp(U, axis=0).max()) for U in (bent, straight))
    return Evidence(
        f"Cross-bridges of length 1 in {ANGLES.size} directions: their velocities differ by up to {spread:.2f} in "
        f"Example 5.4, by {none:.0e} for a linear constraint Gy − X, which shifts all alike.",
        printed=(
            at_least("velocities of Example 5.4 apart", spread, WRONG),
            at_most("velocities of a linear constraint apart", none, 0.0, TOL),
        ),
    )


@claim(
    "c5.tissue-level",
    "The constraint carries each cross-bridge with the deformation gradient.",
    source="(5.32)",
    quote="This constraint ensures that the cross-bridges deform exactly like the tissue",
    recorded=Kind.NOT_REFUTED,
    tried_on="three cross-bridges, one way of y",
)
def _deforms_like_tissue() -> Evidence:
    """(5.33) integrated along y(t) = y + v t, against F(y(1)) F(y(0))^{-1} X(0)."""
    at, steps = tissue(), 50

    def rate(z: Floats) -> Floats:
        y = at.y + z[-1] * at.v
        X = z[:-1].reshape(at.X.shape)
        return np.append((phi(at.system, X, y) @ at.v).ravel(), 1.0)

    end = runge_kutta(rate, np.append(at.X.ravel(), 0.0), 0.5, steps)[-1]
    carried = at.X @ (deformation(at.y + 0.5 * at.v) @ np.linalg.inv(deformation(at.y))).T
    off, moved = float(np.abs(end[:-1].reshape(at.X.shape) - carried).max()), float(np.abs(carried - at.X).max())
    return Evidence(
        f"Three cross-bridges that follow Φ[ẏ] while y changes by ẏ/2 move by up to {moved:.2f} and end where "
        f"F(y)F(yⁱⁿⁱᵗ)⁻¹ takes them, to {off:.0e}.",
        printed=(
            equal("end of the motion against F(y)F(yⁱⁿⁱᵗ)⁻¹Xⁱⁿⁱᵗ", off, 0.0, 10 * TOL),
            at_least("distance moved", moved, WRONG),
        ),
    )
