"""Chapter 3, sections 3.1 to 3.3: damping, noise and steps of the first-order model, and whether it is well-posed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.minimise import DampedArrowHurwicz, Stationary, minimise
from tissue.files.parameters import preset
from tissue.state.cells import empty
from verification.claims import Correction, Effect, Evidence, at_most, claim, equal
from verification.claims.formal.algebra import library
from verification.claims.formal.stated import identity
from verification.thesis.chapter3.accuracy import own_hessians
from verification.thesis.chapter3.sampled import ALPHA, AX, AXB, BETA, DT, GAMMA, USUAL, C

sp = library()
mu, t, tau, delta = sp.symbols("mu t tau delta", positive=True)

Floats = NDArray[np.float64]
SEED = 36
# Of integrations with a tolerance of 1e-10, of numbers that are printed with four digits, and of rounding.
TOL, DIGITS = 1e-7, 5e-5
# Ten standard errors of a variance from that many samples. 2 alpha (1/u^2 + 1/v^2 + 1/(u v)) for straightness with u =
# v = 1, and 4 alpha max(1, |1 - l/d|)/l for both springs.
LIPSCHITZ = 2 * AXB * 3 + 2 * 4 * AX * 1.5 / 2.5

# The chain rule for z~(t) = z(t/delta).
z = sp.Function("z")
RATE, SLOPE = z(t / delta).diff(t), z(tau).diff(tau).subs(tau, t / delta)

_scaled = identity(
    "c3.time-transform",
    "(3.30)",
    "t := δτ, z̃(t) := z(τ), … δ dz̃/dt = -α∇W(z̃) for t ∈ [0, Δt]",
    "In the time of the model, t = δτ, the gradient flow of n* iterations is δ dz̃/dt = −α∇W(z̃).",
    right=delta * RATE - SLOPE,
    wrong=RATE / delta - SLOPE,
)


def daha_step() -> float:
    """Return what is left of z - a after a step of DAHA with Table 4, W = |z - a|^2, over what was there; a = 0."""
    spring = dincl.Problem([[1.0, 1.0]], lambda _t, x: -2 * x)
    method = DampedArrowHurwicz(ALPHA, BETA, GAMMA, C, 1.0, Stationary(TOL), 1)
    return float(minimise(spring, method, throw=False).x[0, 0])


@claim(
    "c3.time-scale",
    "With μ = Δt/(n* α) = 0.1333 h the first-order model does in Δt what n* = 7500 steps of DAHA do.",
    source="(3.32); section 3.4",
    also=("c3.prediction",),
    quote="μ = Δt/(n* α) = 0.1/(7500 · 10⁻⁴) = 0.1333",
    correction=Correction(
        "μ = 2Δt/(n* α) = 0.2667 h, since a step of (3.25) with Table 4 is α/2: it follows from c3.update",
        Effect.NUMBER,
        "Table 5 and the comparisons of section 3.4; 0.1333 belongs to (3.26) as printed",
        why="by c3.update a step of DAHA moves by α/2, so 7500 of them make half the way that (3.28) gives",
        place=2135,
    ),
    rests_on=("c3.time-transform", "c3.update"),
    chosen="DAHA by (3.25) with Table 4, on a spring with W'' = 2",
)
def _time_scale() -> Evidence:
    mu, what = -2 * DT / (USUAL * np.log(daha_step())), "μ with which μż = −∇W does the same as 7500 steps [h]"
    told = DT / (USUAL * ALPHA)
    return Evidence(
        printed=(equal("Δt/(n* α) [h]", told, 0.1333, DIGITS), equal(what, mu, 0.1333, 1e-3)),
        corrected=(equal("2Δt/(n* α) [h]", 2 * told, 0.2667, DIGITS), equal(what, mu, 0.2667, 1e-3)),
    )


def curvature(x: Floats, y: Floats) -> Floats:
    """Return |D^2 W| of cells from (0, 0) to (0, 8) with nuclei (K,) and springs at rest at 2.5, each by itself."""
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
    source="section 3.2",
    quote=(
        "Since the set S is uniformly prox-regular …, we obtain from Theorem 1.31 and Lemma 1.32 the well-posed of "
        "this equation."
    ),
    correction=Correction(
        (
            "the theorems need a Lipschitz ∇W: they apply as long as no nucleus comes near an end of its cell, where "
            "(3.12) has no bounded second derivative"
        ),
        Effect.PROOF,
        "well-posedness for all times; where nuclei meet an end, DAHA and PBD become unstable",
        why="(3.12) has second derivatives like 1/‖X − A‖², so ∇W is not Lipschitz near the ends of a cell",
        place=2145,
    ),
    rests_on=("c3.straight-minimum", "c1.existence"),
    chosen="one cell of 8 R^soft with the stiffnesses of Table 2; its nucleus 10⁻², 10⁻³, 10⁻⁴ R^soft from the apical "
    "point, and at random, more than 1 R^soft from both ends",
)
def _well_posed() -> Evidence:
    near = curvature(np.zeros(3), 8.0 - np.array([1e-2, 1e-3, 1e-4]))
    x, y = np.random.default_rng(SEED).uniform((-4.0, -4.0), (4.0, 12.0), (500, 2)).T
    apart = np.minimum(np.hypot(x, y), np.hypot(x, y - 8.0)) > 1.0
    power = f"power of 1/distance with which |D²W| grows, from {near[0]:.0e} to {near[2]:.0e}"
    return Evidence(
        printed=(equal(power, float(np.log10(near[2] / near[0]) / 2), 0.0, 0.1),),
        corrected=(at_most("largest |D²W| away from the ends", float(curvature(x[apart], y[apart]).max()), LIPSCHITZ),),
        seed=SEED,
    )
