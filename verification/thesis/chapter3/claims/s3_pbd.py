"""Chapter 3, sections 3, 3.2 and 3.3: the first-order model, whether it is well-posed, and its steps."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tissue.files.parameters import preset
from tissue.state.cells import empty
from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter3.linear import own_hessians
from verification.thesis.text.quoted import claim

Floats = NDArray[np.float64]
SEED = 36
# Sections 3 and 3.4: seconds of DAHA and of PBD for the same task, their iterations and substeps (Table 5).
DAHA_SECONDS, PBD_SECONDS, USUAL, SUBSTEPS = (27.0, 28.0), 0.08, 7500, 20


@claim(
    "c3.speedup",
    "The times that are given, their ratio, and the ratio of the work.",
    "sections 3 and 3.4",
)
def _speedup() -> Evidence:
    least, most = (seconds / PBD_SECONDS for seconds in DAHA_SECONDS)
    work = USUAL / SUBSTEPS
    return Evidence(
        f"27 s over 0.08 s is {least:.1f}, 28 s over 0.08 s is {most:.0f}; 7500 iterations over 20 substeps are "
        f"{work:.0f}, {100 * (work / most - 1):.0f} % more",
        printed=(
            at_least("27 s over 0.08 s", least, 300.0),
            at_least("28 s over 0.08 s", most, 300.0),
            equal("iterations over substeps, over the ratio of times", work / most, 1.0, 0.15),
        ),
    )


def curvature(x: Floats, y: Floats) -> Floats:
    """|D^2 W| of cells from (0, 0) to (0, 8) with nuclei (K,) and springs at rest at 2.5, for each cell by itself."""
    numbers, cells = preset("thesis").numbers(), empty(len(x))
    values = {"x": x, "y": y, "ay": 8.0, "rest_ax": 1.5, "rest_bx": 1.5}
    values |= {f"stiff_{name}": getattr(numbers, f"alpha_{name}") for name in ("ax", "bx", "axb")}
    for name, value in values.items():
        getattr(cells, name)[:] = value
    norms: Floats = np.abs(np.linalg.eigvalsh(own_hessians(cells, numbers))).max(axis=1)
    return norms


@claim(
    "c3.well-posed",
    "By the theorems of chapter 1 the first-order model has one solution from each start, for all times.",
    "section 3.2",
    Verdict.CORRECTED,
    chosen="one cell of 8 R_soft with the stiffnesses of Table 2",
)
def _well_posed() -> Evidence:
    """Nuclei nearer and nearer to the apical point, and random ones that keep away from both ends."""
    near = curvature(np.zeros(3), 8.0 - np.array([1e-2, 1e-3, 1e-4]))
    power = float(np.log10(near[2] / near[0]) / 2)
    x, y = np.random.default_rng(SEED).uniform((-4.0, -4.0), (4.0, 12.0), (500, 2)).T
    apart = np.minimum(np.hypot(x, y), np.hypot(x, y - 8.0)) > 1.0
    far = float(curvature(x[apart], y[apart]).max())
    return Evidence(
        f"one cell, nucleus 10⁻², 10⁻³, 10⁻⁴ R_soft from its apical point: ∇W changes {near[0]:.0e}, {near[1]:.0e}, "
        f"{near[2]:.0e} times as much as the state: not Lipschitz, as Theorem 1.31 asks; for nuclei more than 1 R_soft "
        f"from both ends it is {far:.0f} times at most",
        printed=(equal("power of 1/distance with which |D²W| grows", power, 0.0, 0.1),),
        corrected=(at_most("largest |D²W| away from the ends", far, LIPSCHITZ),),
        seed=SEED,
    )


# 2 alpha (1/u^2 + 1/v^2 + 1/(u v)) for straightness with u = v = 1, and 4 alpha max(1, |1 - l/d|)/l for both springs.
LIPSCHITZ = 2 * 15 * 3 + 2 * 4 * 2 * 1.5 / 2.5


@claim(
    "c3.projections",
    "The nearest point of each single constraint has a closed form.",
    "section 3.3",
    Verdict.PROVED,
    chosen="the formulas, which the text leaves to the reader",
)
def _projections() -> Evidence:
    """b, a: the distance of the pair before and in any other state, p = their product of differences, m = |move|^2."""
    return proved(
        identity(
            "both moves x, y of a pair have |x|² + |y|² = |x − y|²/2 + |x + y|²/2",
            lambda s, x, y: x**2 + y**2 - (x - y) ** 2 / 2 - s * (x + y) ** 2 / 2,
            "−|x + y|²/2",
        ),
        implication(
            "(C1) b < D ≤ a, (C2) a ≤ D < b: the way has m ≥ (a − b)²/2 ≥ (D − b)²/2, as moving each by |D − b|/2",
            lambda s, a, b, p, m, D: (
                [a >= 0, b >= 0, D >= 0, p <= a * b, 2 * m >= a * a + b * b - 2 * p, (a - D) * (D - b) >= 0],
                2 * m >= s * (D - b) * (D - b),
            ),
            "twice that",
            2,
        ),
        implication(
            "(C3): y = 0 is nearest at the same x; (C4): both at the mean if they are in the wrong order",
            lambda s, x, y, z, u, v, w: (
                [u > v, x <= y],
                [(x - z) ** 2 + w**2 >= w**2, (x - u) ** 2 + (y - v) ** 2 >= s * (u - v) ** 2 / 2],
            ),
            "twice that distance",
            2,
        ),
    )


@claim(
    "c3.substeps",
    "n substeps of Δt/n each, with Δt/μ as the weight of the gradient, cover one time step.",
    "(3.34)",
    Verdict.PROVED_INSTANCE,
    chosen="coordinates that do not act on each other, so that the solution is known",
    tried_on="a spring of any stiffness",
)
def _substeps() -> Evidence:
    """n substeps of the explicit Euler method for z' = -k z/mu, with n to infinity."""
    sp = library()
    n, k, mu, h = sp.symbols("n k mu h", positive=True)
    return proved(
        identity(
            "(1 − (Δt/n)k/μ)ⁿ → e^{−kΔt/μ}: n substeps of Δt/n with the weight Δt/(nμ) cover Δt",
            lambda s: sp.limit((1 - s * h / n * k / mu) ** n, n, sp.oo) - sp.exp(-h * k / mu),
            "with a weight of the other sign",
        )
    )
