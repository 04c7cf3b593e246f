"""Chapter 2, section 3: what consistency is, and that PBD has it."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

import dincl
from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter1.sets import Floats
from verification.thesis.chapter2.discs import RADIUS, ROUNDING, points_of_step, row
from verification.thesis.text.quoted import claim

SEED = 23
# The wall x >= 0, a point on it that is pulled away by F = 1, and the ball and direction of the support functions.
DT, R, W = 1e-3, 3.0, 1.0
# Steps that go to 0.
STEPS = (1e-2, 1e-3, 1e-4)
DISCS = 5
# For states that move with the step, whose cones turn by √Δt; and how far from contact rounding leaves discs of a row.
FINER, TOUCH = (1e-2, 1e-4, 1e-6), 1e-12


def trapped(x: float, dt: float) -> bool:
    """Where the flow of the counterexample stands still: a set that leaves every fixed x as dt → 0."""
    return 1 - dt <= x < 1


def flow(x: float, dt: float) -> float:
    """Explicit Euler for F = 1, but for the trap."""
    return x if trapped(x, dt) else x + dt


def stopped(dt: float) -> float:
    """Where the flow is at t = 2, from 0."""
    x = 0.0
    for _step in range(round(2 / dt)):
        x = flow(x, dt)
    return x


def turning(dt: float, rng: np.random.Generator) -> Floats:
    """States x_n that come to the row of discs as dt → 0: turned by √dt, with overlaps of the size of dt."""
    c, s = np.cos(dt**0.5), np.sin(dt**0.5)
    return np.asarray(row(DISCS) @ [[c, s], [-s, c]] + dt * rng.uniform(-0.2, 0.2, (DISCS, 2)))


def beside_normals() -> list[float]:
    """How far a step of PBD without its drift is from -N(S, x) for x_n → x, over random forces, for each of FINER."""
    x, rng = row(DISCS), np.random.default_rng(SEED)
    cone = dincl.geometry.normal_cone(dincl.Problem(x, lambda _t, x: 0 * x, [dincl.NonOverlap(RADIUS)]), 0.0, x, TOUCH)
    forces = rng.uniform(-1.0, 1.0, (20, DISCS, 2))
    return [max(cone.distance(-shares(turning(dt, rng), force, dt)) for force in forces) for dt in FINER]


@claim(
    "c2.limits",
    "Limits of a method that is consistent are solutions.",
    "sections 3 and 5",
    Verdict.CORRECTED,
    chosen="the flow that stands still on [1 − Δt, 1), S = ℝ; Definition 2.7 as corrected; a row of discs",
    tried_on="PBD with a row of five discs",
)
def _limits() -> Evidence:
    """S = R for the counterexample: -N = {0}; and PBD for a row of discs."""
    local = max(abs((flow(x, DT / 10) - x) / (DT / 10) - 1) for x in (0.0, 0.5, 0.99, 1.0, 1.5))
    ends = [stopped(dt) for dt in STEPS]
    along = min(abs((flow(1 - dt / 2, dt) - (1 - dt / 2)) / dt - 1) for dt in STEPS)
    far = beside_normals()
    return Evidence(
        f"A flow that stands still on [1 − Δt, 1) is consistent by Definition 2.7 (to {local:.0e} at fixed x), but its "
        f"limit min(t, 1) is {2 - ends[-1]:.2f} from the solution at t = 2. Along x_n = 1 − Δt/2 → 1 it is off by "
        f"{along:g}; PBD, for {DISCS} discs that turn into a row, by {', '.join(f'{value:.1e}' for value in far)} at "
        f"Δt = {', '.join(f'{dt:g}' for dt in FINER)}.",
        printed=(
            at_most("inconsistency of the flow at fixed x", local, 0.0, 1e-9),
            at_most("change of its end with Δt", abs(ends[-1] - ends[-2]), 0.0, 2 * STEPS[-2]),
            at_most("distance of its limit from the solution", abs(2.0 - ends[-1]), 0.0, 0.01),
        ),
        corrected=(
            at_least("inconsistency of the flow along x_n → x", along, 0.5),
            at_most("inconsistency of PBD along x_n → x, over that at 100 Δt", far[2] / far[1], 0.2),
            at_most("inconsistency of PBD along x_n → x", far[2], 0.01),
        ),
        seed=SEED,
    )


@claim(
    "c2.not-sufficient",
    "A method can be consistent at every point and yet not converge.",
    "(2.10)",
    Verdict.PROVED,
)
def _not_sufficient() -> Evidence:
    """F = 1, y = Phi(x) = x + h, but Phi(x) = x on [1 - h, 1)."""
    z3 = solver_library()
    return proved(
        implication(
            "at each x ≠ 1 the quotient (Φ(x) − x)/h is 1 for all h < |1 − x|, and at x = 1 for all h: consistent",
            lambda s, x, y, h: (
                [h > 0, z3.Or(x >= 1, h < s * (1 - x)), y == z3.If(z3.And(x >= 1 - h, x < 1), x, x + h)],
                y - x == h,
            ),
            "for all h < 2|1 − x|",
            2,
        ),
        implication(
            "but from x < 1 no step leads to 1 or beyond, while the solution is at t = 2 at 2",
            lambda s, x, y, h: ([h > 0, x < 1, y == z3.If(z3.And(x >= 1 - h, x < 1), x, x + s * h)], y < 1),
            "with steps of 2h",
            2,
        ),
    )


def leaving() -> tuple[float, float]:
    """Both sides of the definition for S = [0, ∞), x = 0, F = 1, w = 1: PBD leaves the wall, −N = [0, ∞) has σ = R."""
    problem = dincl.Problem([[0.0]], lambda _t, _x: np.array([[1.0]]), [dincl.HalfSpace(normal=(1,))])
    left = W * (float(dincl.solve(problem, dincl.PBD(dt=DT), t=DT).final[0, 0]) / DT - 1.0)
    return left, dincl.geometry.support(problem, 0.0, [[0.0]], [[W]], tol=ROUNDING, radius=R)


@claim(
    "c2.definition",
    "Consistent is a method whose support functions tend to those of the normal cone.",
    "Definition 2.7",
    Verdict.CORRECTED,
)
def _definition() -> Evidence:
    left, right = leaving()
    return Evidence(
        f"A point on a wall that is pulled away: the left side is {abs(left):.0e}, the right side R = {right:g}. With "
        "“≤” for “→”, which is what the proof of Lemma 2.8 shows, it holds.",
        printed=(equal("left side", left, right, 1e-9),),
        corrected=(at_most("left side", left, right, 1e-9),),
    )


def shares(x: Floats, force: Floats, dt: float) -> Floats:
    """(Φ(x) - x)/Δt - F(x)."""
    return (points_of_step(x, force, dt)[-1] - x) / dt - force


@claim(
    "c2.lemma",
    "A step of PBD without its drift tends to the normals of S, and stays bounded.",
    "Lemma 2.8",
    Verdict.CORRECTED,
    chosen="a row of discs, where a step crosses several contacts",
    tried_on="a row of five discs, 20 random forces",
)
def _lemma() -> Evidence:
    """How far it is from -N(S, x), for a row of discs and random forces, as the step goes to 0."""
    x = row(DISCS)
    problem = dincl.Problem(x, lambda _t, x: 0 * x, [dincl.NonOverlap(RADIUS)])
    cone = dincl.geometry.normal_cone(problem, 0.0, x, ROUNDING)
    rng = np.random.default_rng(SEED)
    forces = rng.uniform(-1.0, 1.0, (20, *x.shape))
    far = [max(cone.distance(-shares(x, force, dt)) for force in forces) for dt in STEPS]
    size = max(float(np.linalg.norm(shares(x, force, STEPS[-1])) / np.linalg.norm(force)) for force in forces)
    left, right = leaving()
    return Evidence(
        f"{DISCS} discs in a row, 20 random forces: the distance from −N(S, x) is at most "
        f"{', '.join(f'{value:.1e}' for value in far)} at Δt = {', '.join(f'{dt:g}' for dt in STEPS)}; the length is "
        f"at most {size:.2f} ‖F‖: the lemma with “≤” in Definition 2.7. A wall that a point leaves refutes “→”: "
        f"{left:.0e} for {right:g}.",
        printed=(equal("support function of the step from a wall", left, right, 1e-9),),
        corrected=(
            equal("distance over that at a tenth of the step", far[1] / far[2], 10.0, 1.0),
            at_most("distance at the smallest step", far[2], 1e-3),
            at_most("length over (2^M + 1) ‖F‖", size / (2 ** (DISCS * (DISCS - 1) / 2) + 1), 1.0),
        ),
        seed=SEED,
    )
