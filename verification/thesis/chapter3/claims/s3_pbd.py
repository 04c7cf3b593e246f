"""Chapter 3, sections 3, 3.2 and 3.3: the first-order model, whether it is well-posed, and its steps."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import minimize

from tissue.files.parameters import preset
from tissue.state.cells import empty
from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter1.sets import apart
from verification.thesis.chapter3.claims.s3_1_first_order import START, slope
from verification.thesis.chapter3.linear import own_hessians

Floats = NDArray[np.float64]
SEED = 36
# Sections 3 and 3.4: seconds of DAHA and of PBD for the same task, their iterations and substeps (Table 5).
DAHA_SECONDS, PBD_SECONDS, USUAL, SUBSTEPS = (27.0, 28.0), 0.08, 7500, 20
# Tables 3 and 5.
DT, MU = 0.1, 0.15
# Of nearest points that a solver finds with a tolerance of 1e-12.
TOL = 1e-5


@claim(
    "c3.speedup",
    "The times that are given, their ratio, and the ratio of the work.",
    source="sections 3 and 3.4",
    quote=(
        "27 s … 0.08 s, which is over 300× faster … 28 s … 300× speed-up … essentially the ratio between n* = 7500 and "
        "n^sub-steps = 20"
    ),
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
    source="section 3.2",
    quote=(
        "Since the set S is uniformly prox-regular …, we obtain from Theorem 1.31 and Lemma 1.32 the well-posed of "
        "this equation."
    ),
    recorded=Kind.CORRECTED,
    correction=Correction(
        "the theorems need a Lipschitz ∇W: they apply as long as no nucleus comes near an end of its cell, where "
        "(3.12) has no bounded second derivative",
        Effect.PROOF,
        "well-posedness for all times; where nuclei meet an end, DAHA and PBD become unstable",
        why="(3.12) has second derivatives like 1/‖X − A‖², so ∇W is not Lipschitz near the ends of a cell",
        place=2145,
    ),
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


def together(z: Floats, most: float) -> Floats:
    """(C2) for two basal points that are too far apart."""
    arrow = z[1] - z[0]
    length = float(np.linalg.norm(arrow))
    move = max(0.0, length - most) / 2 * arrow / length
    moved: Floats = z + np.stack((move, -move))
    return moved


def on_line(z: Floats) -> Floats:
    """(C3)."""
    return z * [1.0, 0.0]


def in_order(z: Floats) -> Floats:
    """(C4): points in the wrong order meet halfway."""
    middle = z[:, 0].mean()
    x = z[:, 0] if z[0, 0] <= z[1, 0] else np.full(2, middle)
    return np.stack((x, z[:, 1]), axis=1)


def nearest(z: Floats, kind: str, value: Callable[[Floats], Floats]) -> Floats:
    """The nearest state with value >= 0 (or = 0), by sequential quadratic programming."""
    rule = {"type": kind, "fun": lambda flat: value(flat.reshape(2, 2))}
    found = minimize(lambda flat: ((flat - z.ravel()) ** 2).sum(), z.ravel() + 1e-3, constraints=rule, tol=1e-12)
    return np.reshape(found.x, (2, 2))


@claim(
    "c3.projections",
    "The nearest point of each single constraint has a closed form.",
    source="section 3.3",
    quote=(
        "All these constraints have in common, that it is very easy to explicitly compute the projection for each "
        "individual constraint."
    ),
    chosen="the formulas, which the text leaves to the reader",
    recorded=Kind.NOT_REFUTED,
    tried_on="10 random pairs of each kind",
)
def _projections() -> Evidence:
    """Each formula beside a general solver, from random pairs that break the constraint."""
    rng, off = np.random.default_rng(SEED), dict.fromkeys(("C1", "C2", "C3", "C4"), 0.0)
    for z in rng.uniform(-0.3, 0.3, (10, 2, 2)):
        swapped = z[np.argsort(-z[:, 0])]
        for name, found, wanted in (
            ("C1", apart(z, 1.03), nearest(z, "ineq", lambda x: (((x[1] - x[0]) ** 2).sum(keepdims=True)) - 1.03**2)),
            ("C2", together(z, 0.1), nearest(z, "ineq", lambda x: 0.1**2 - ((x[1] - x[0]) ** 2).sum(keepdims=True))),
            ("C3", on_line(z), nearest(z, "eq", lambda x: x[:, 1])),
            ("C4", in_order(swapped), nearest(swapped, "ineq", lambda x: x[1:, 0] - x[0, 0])),
        ):
            off[name] = max(off[name], float(np.abs(found - wanted).max()))
    return Evidence(
        "the explicit formulas against a general solver, 10 random pairs: largest difference "
        + ", ".join(f"({name}) {value:.0e}" for name, value in off.items()),
        printed=tuple(at_most(f"distance from the nearest point, ({name})", value, TOL) for name, value in off.items()),
        seed=SEED,
    )


LOWEST = np.array([-np.inf, -np.inf, 1.0])


def flow() -> Floats:
    """The solution of mu dz/dt = -grad W at dt, without walls."""
    solved = solve_ivp(lambda _t, z: -slope(z) / MU, (0.0, DT), START, rtol=1e-10, atol=1e-10)
    return np.array(solved.y[:, -1])


def stepped(z: Floats, n: int) -> Floats:
    """(3.34): n steps of (dt/n)/mu down the energy, each followed by a projection onto z_3 >= 1."""
    for _ in range(n):
        z = np.maximum(z - DT / n / MU * slope(z), LOWEST)
    return z


@claim(
    "c3.substeps",
    "n substeps of Δt/n each, with Δt/μ as the weight of the gradient, cover one time step.",
    source="(3.34)",
    quote="Φ^PBD(Z) = (Φ^PBD_{Δt/n^sub-step})^{n^sub-step} (Z)",
    chosen="coordinates that do not act on each other, so that the solution is known",
    recorded=Kind.NOT_REFUTED,
    tried_on="three springs and a wall",
)
def _substeps() -> Evidence:
    """The flow with its wall: coordinates do not act on each other, so that one stops where it meets its wall."""
    exact = np.maximum(flow(), LOWEST)
    twenty, forty = (float(np.abs(stepped(START, n) - exact).max()) for n in (SUBSTEPS, 2 * SUBSTEPS))
    return Evidence(
        f"three springs and a wall, μ = {MU}: 20 substeps end {twenty:.1e} from the solution at Δt, 40 end "
        f"{forty:.1e} from it",
        printed=(
            equal("error of 20 substeps over that of 40", twenty / forty, 2.0, 0.6),
            at_most("error of 20 substeps", twenty, 0.1),
        ),
    )
