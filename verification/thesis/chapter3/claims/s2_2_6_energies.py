"""Chapter 3, sections 2.2.6 to 2.2.9: the energy terms, their units, minima that are not unique, parameters."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tissue.files.parameters import preset
from tissue.frames.observables import height
from tissue.model.energy import energy
from tissue.runs.simulate import simulate
from verification.claims import Correction, Effect, Evidence, at_most, claim, equal
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument, implication
from verification.thesis.chapter3.sampled import AA, AX, AXB, R_SOFT, XX, of_mean
from verification.thesis.quasi_steady.frozen import constraints, particles

Point = tuple[float, float]
# The energy terms one by one, as they are printed, and their slopes.

# Of central differences: rounding and curvature cost about 1e-9 of the energies here.
STEP = 1e-5


def slope(f: Callable[[float], float], at: float) -> float:
    """Return f' by a central difference."""
    return (f(at + STEP) - f(at - STEP)) / (2 * STEP)


def spring(d: float, rest: float, stiffness: float, soft: float = 1.0) -> float:
    """Return (3.9) and (3.10)."""
    return stiffness / (soft + rest) * (d - soft - rest) ** 2


def junction(d: float, rest: float, stiffness: float, soft: float = 1.0) -> float:
    """Return (3.11)."""
    return stiffness / (2 * soft) * (d - rest) ** 2


def bending(a: Point, x: Point, b: Point, stiffness: float) -> float:
    """Return (3.12), the first form."""
    u, v = (a[0] - x[0], a[1] - x[1]), (b[0] - x[0], b[1] - x[1])
    return stiffness * ((u[0] * v[0] + u[1] * v[1]) / (math.hypot(*u) * math.hypot(*v)) + 1)


def repulsion(d: float, stiffness: float, soft: float = 1.0) -> float:
    """Return (3.13) without its minus."""
    return stiffness / (2 * soft) * (d - 2 * soft) ** 2 if d <= 2 * soft else 0.0


sp = library()
FEW = tuple(range(3))
# Force over overlap: (α_i + α_j)/R² with R = 2 R_soft and α = 1, in src/core/compute_forces.jl of SteffenPL/sEMTor.jl.
PUBLISHED_REPULSION = 0.5
# Figure 14: the height after 48 h over that at the start is less.
HIGHEST = 1.5
# Rounding in central differences of energies up to 1000.
TOL = 1e-5


def terms(unit: float, *, squared: bool) -> np.ndarray:
    """Return (3.9), (3.11), (3.13) of one cell for R_soft = unit, with their denominators as printed or squared."""
    d, eta = 3.0 * unit, 1.5 * unit
    values = np.array([spring(d, eta, AX, unit), junction(d, eta, AA, unit), repulsion(d / 2, XX, unit)])
    return values / [unit + eta, 2 * unit, 2 * unit] if squared else values


def scaled(point: Point, unit: float) -> Point:
    """Return a point in other units."""
    return unit * point[0], unit * point[1]


def grown(name: str) -> list[float]:
    """Return the heights after 48 h over those at the start, with the damping that is said to fit Figure 14."""
    parameters = preset(name).changed({"numerics.mu": "0.2 h", "numerics.keep": "48 h"})
    runs = [simulate(parameters, seed) for seed in FEW]
    return [height(run.final) / height(run.frames[0]) for run in runs]


def push(d: float) -> float:
    """Return the force of (3.13) with (2 R_soft)^2 between two nuclei at the distance d."""
    return -slope(lambda d: repulsion(d, XX) / 2, d)


@claim(
    "c3.dimensions",
    "The energies (3.9) to (3.13) are numbers without unit.",
    source="section 2.2.6",
    quote="We define the energy terms in their non-dimensional form as in [Fer+19]",
    correction=Correction(
        "the denominators are squares: (R^soft + η)² in (3.9), (3.10), (2R^soft)² in (3.11), (3.13)",
        Effect.MODEL,
        (
            "F^basal-cytos in section 2.2.4 of chapter 4, which needs the square, too; the weight of (3.12) against "
            "the other terms; the unit of μ (Table 5); the heights of Figures 14 and 16, which the squares improve"
        ),
        why=(
            "each of them is a length squared over a length, and (3.12) is a number: they cannot be added without "
            "units, and other units give other weights; the published program divides by squares (compute_forces.jl of"
            " sEMTor.jl)"
        ),
        place=1793,
    ),
    rests_on=("c3.repulsion", "c3.similar"),
    chosen="PBD with μ = 0.2 h, which is said to be similar, stands for DAHA; lengths in R^soft",
)
def _dimensions() -> Evidence:
    """Compare the terms of one cell in units of R_soft and in um: a number without unit is the same in both."""
    a, x, b = (0.0, 8.0), (0.5, 3.0), (0.0, 0.0)
    bent = [bending(scaled(a, unit), scaled(x, unit), scaled(b, unit), AXB) for unit in (R_SOFT, 1.0)]
    printed, right = (terms(R_SOFT, squared=squared) / terms(1.0, squared=squared) for squared in (False, True))
    off = max(abs(push(d) - PUBLISHED_REPULSION * (2 - d)) for d in (0.7, 1.0, 1.5, 1.9))
    before = float(np.mean(grown("thesis")))
    higher = f"height after 48 h over the height at the start, μ = 0.2 h (denominators as printed: {before:.2f})"
    return Evidence(
        printed=(
            equal("largest of (3.9), (3.11), (3.13) in μm over in R_soft", printed.max(), bent[0] / bent[1], TOL),
        ),
        corrected=(
            *(
                equal(f"{name} with squared denominator, in μm over in R_soft", ratio, bent[0] / bent[1], TOL)
                for name, ratio in zip(("(3.9)", "(3.11)", "(3.13)"), right, strict=True)
            ),
            at_most("force of (3.13) less the force of the published program", off, 0.0, TOL),
            of_mean(higher, grown("corrected"), at_most, HIGHEST),
        ),
        seed=FEW[0],
        runs_needed=len(FEW),
    )


d, eta = sp.symbols("d eta", positive=True)


# c = u.v, k = u x v, n = |u||v| for u = A - X, v = B - X: n^2 = c^2 + k^2, W = alpha (c/n + 1).
a, b, x, y = sp.symbols("a b x y")
LENGTHS, CROSS = (a**2 + b**2) * (x**2 + y**2) - (a * x + b * y) ** 2, (a * y - b * x) ** 2
c, k, n, W, weight = reals("c k n W alpha")
BENT = [n > 0, weight > 0, n * n == c * c + k * k, W * n == weight * (c + n)]
z3 = solver_library()

_straight = argument(
    "c3.straight-minimum",
    "(3.12)",
    "The equilibrium of W_i^axb corresponds to the case when the angle … is 180°, i.e. if X_i lies on the straight "
    "line joining the apical and the basal points",
    "The bending energy is least where the nucleus lies between its two points on a straight line.",
    vanishes(LENGTHS - CROSS, LENGTHS + CROSS, "|u|²|v|² = (u·v)² + (u × v)²", "−(u × v)²"),
    follows(
        BENT,
        [W >= 0, (W == 0) == z3.And(k == 0, c < 0)],
        (W == 0) == z3.And(k == 0, c > 0),
        "W ≥ 0, and W = 0 if and only if u × v = 0 and u·v < 0, X between A and B on their line",
        "u·v > 0",
    ),
)


# The force f = -dW/dd of two nuclei at the distance d < 2R; W = alpha (d - 2R)^2/(2R), or its negative.
apart, size, stiff, push_away = reals("d R alpha f")
OVERLAP = [size > 0, stiff > 0, apart > 0, apart < 2 * size]

_repulsion = implication(
    "c3.repulsion",
    "(3.13)",
    "the repulsive energy W_ij^xx = −α^xx/(2R^soft) (‖X_i − X_j‖ − 2R^soft)² if ‖X_i − X_j‖ ≤ 2R^soft",
    "By the energy W^xx nuclei with overlapping soft discs push each other apart.",
    given=[*OVERLAP, push_away * size == stiff * (2 * size - apart)],
    then=push_away > 0,
    wrong=([*OVERLAP, push_away * size == -stiff * (2 * size - apart)], push_away > 0),
    correction=Correction(
        "W_ij^xx = +α^xx/(2R^soft) (‖X_i − X_j‖ − 2R^soft)²",
        Effect.MODEL,
        (
            "(3.14), the forces of all models of chapters 3 and 4: as printed nuclei attract each other until their "
            "hard discs touch"
        ),
        why="−∇ of the printed energy points from each nucleus to the other; the text calls it repulsive",
        place=1821,
    ),
)


SMALL = 1e-6


def moving() -> tuple[str, ...]:
    """Return the coordinates that a shift along the basal layer moves."""
    return "x", "ax", "bx"


@claim(
    "c3.not-unique",
    "Minima of the energy over the feasible states need not be unique.",
    source="Remark 3.2",
    quote="The local minimisation in the QSS model might not be unique in some circumstances",
    chosen="60 cells after 1 h, all moved by 0.7 R^soft along the basal layer",
)
def _not_unique() -> Evidence:
    """Move the whole tissue along the basal layer."""
    parameters = preset("thesis").changed({"numerics.t_end": "1 h"})
    frame, numbers = simulate(parameters, 0).final, parameters.numbers()
    cells, by = frame.cells, 0.7
    moved = cells._replace(**{name: getattr(cells, name) + by for name in moving()})
    change = abs(energy(moved, frame.layers, numbers) / energy(cells, frame.layers, numbers) - 1)
    before, after = (
        np.concatenate([part.select(z, 0.0).values(z) for part in constraints(at, frame.layers, numbers)])
        for at in (cells, moved)
        for z in (particles(at),)
    )
    worse = float(np.minimum(before, 0.0).min() - np.minimum(after, 0.0).min())
    return Evidence(
        printed=(
            at_most("relative change of W by the move", change, 0.0, SMALL),
            at_most("growth of the largest violation of (C1) to (C4) by the move [R_soft]", worse, 0.0, SMALL),
        ),
        seed=0,
    )
