"""Chapter 3, sections 2.3.1 and 2.3.2: what DAHA becomes with the parameters of Table 4, and where it stops."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.minimise import DampedArrowHurwicz, Stationary, minimise
from verification.claims import Evidence, Verdict, at_most, equal, proved
from verification.formal.algebra import identity
from verification.thesis.chapter3.claims.s2_3_1_daha import damped
from verification.thesis.text.quoted import claim

Floats = NDArray[np.float64]
TOL = 1e-8
# Table 4.
ALPHA, BETA, GAMMA, C, EPS = 1e-4, 0.25, 1e-3, 2.0, 1e-6
# Stiffnesses W'' of springs; the iteration bears 40,000.
SPRINGS = (1.0, 100.0, 5000.0, 19000.0)


REST = np.array([1.0, 2.0])


def pulled() -> dincl.Problem:
    """One particle without constraints, W = |x - REST|^2/2; at the start grad W is a fortieth of x."""
    return dincl.Problem([1.025 * REST], lambda _t, x: REST - x)


@claim(
    "c3.update",
    "What a step of DAHA becomes with Table 4.",
    "(3.26)",
    Verdict.CORRECTED,
)
def _update() -> Evidence:
    problem = pulled()
    step = minimise(problem, DampedArrowHurwicz(ALPHA, BETA, GAMMA, C, 1.0, Stationary(TOL), 1), throw=False)
    ratio = float((step.x - problem.x0)[0, 0] / (ALPHA * problem.drift(0.0, problem.x0)[0, 0]))
    return Evidence(
        f"the formula above it divides by 1 + cΔτ/2 = 2: the step of (3.25) with Table 4 is {ratio:.4f} times the "
        "printed one",
        printed=(equal("step of (3.25) over that of (3.26)", ratio, 1.0, 1e-6),),
        corrected=(equal("step of (3.25) over α∇W", ratio, 0.5, 1e-6),),
    )


def turns(path: Floats) -> int:
    """How often a path (K,) around 0 changes sign."""
    side = np.sign(path[np.abs(path) > TOL])
    return int((side[1:] != side[:-1]).sum())


def step(now: float, before: float, push: float) -> float:
    """(3.25) solved for z_{n+1}, dtau = 1."""
    return (2 * now - (1 - C / 2) * before - push) / (1 + C / 2)


def relaxed(stiff: float) -> Floats:
    """z_n of a spring without constraints."""
    before, path = 1.0, [1.0]
    for _ in range(1000):
        before, now = path[-1], step(path[-1], before, ALPHA * stiff * path[-1])
        path.append(now)
    return np.array(path)


def landed(weight: float) -> Floats:
    """z_n of a weight a little above the floor z >= 0, with the multiplier that holds it."""
    before, lam, path = 1e-3, weight, [1e-3]
    for _ in range(5000):
        now = path[-1]
        path.append(step(now, before, ALPHA * (weight - lam) + GAMMA * lam * now))
        before, lam = now, max(0.0, lam - BETA * now)
    return np.array(path)


@claim(
    "c3.overdamped",
    "With Table 4 the states run into their rest without swinging around it.",
    "section 2.3.1",
    Verdict.CORRECTED,
    chosen="a weight on a floor; the multiplier as corrected in c3.daha-multiplier",
)
def _overdamped() -> Evidence:
    crossed = max(turns(relaxed(stiff)) for stiff in SPRINGS)
    swung = turns(landed(1.0))
    return Evidence(
        f"springs with W'' from {SPRINGS[0]:g} to {SPRINGS[-1]:g}, Table 4: the path crosses its rest {crossed} times. "
        f"With a constraint the multiplier swings: a weight on a floor crosses it {swung} times in 5000 iterations",
        printed=(
            equal("crossings of the rest, without constraints", crossed, 0.0),
            equal("crossings of the rest, at a contact", swung, 0.0),
        ),
        corrected=(equal("crossings of the rest, without constraints", crossed, 0.0),),
    )


@claim(
    "c3.descent",
    "Without constraints and with c = 2/Δτ DAHA is plain gradient descent.",
    "Remark 3.6",
    Verdict.PROVED,
    chosen="the step size is not asked for: it is α/2, see c3.update",
)
def _descent() -> Evidence:
    return proved(
        identity(
            "without constraints and with c = 2/Δτ (3.25) is z_{n+1} = z_n − ½Δτ²α∇W(z_n)",
            lambda s, z, before, slope, alpha, h: (
                damped(z, before, alpha * slope, 2 / h, h) - z + s * h**2 * alpha * slope / 2
            ),
            "+½Δτ²α∇W",
        )
    )


@claim(
    "c3.stopping",
    "How much of the gradient is left where DAHA stops.",
    "Remark 3.6",
    Verdict.CORRECTED,
)
def _stopping() -> Evidence:
    found = minimise(pulled(), DampedArrowHurwicz.published())
    gradient = float(np.linalg.norm(found.x - REST) / np.linalg.norm(found.x))
    bound = EPS / ALPHA
    return Evidence(
        f"W = ‖z - a‖²/2 with Table 4: after {found.iterations} steps ‖∇W‖/‖z‖ = {gradient:.4f}: the bound is 2ε/α = "
        f"{2 * bound:.2f}, since the step is α/2 (with Δτ: 2ε/(αΔτ))",
        printed=(at_most("‖∇W‖/‖z‖ where it stops", gradient, bound),),
        corrected=(at_most("‖∇W‖/‖z‖ where it stops", gradient, 2 * bound),),
    )
