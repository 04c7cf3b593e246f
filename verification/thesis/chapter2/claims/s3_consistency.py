"""Chapter 2, section 3: consistency, and the proof that PBD has it."""

from __future__ import annotations

import numpy as np

import dincl
from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument
from verification.thesis.chapter1.sets import RADIUS, ROUNDING, Floats, points_of_step, row

z3 = solver_library()
x, y, h, n, d, q, power, f, way, last, first = reals("x y h n d q P f way last first")

SEED = 23
# The wall x >= 0, a point on it that is pulled away by F = 1, and the ball and direction of the support functions.
DT, R, W = 1e-3, 3.0, 1.0
# Steps that go to 0.
STEPS = (1e-2, 1e-3, 1e-4)
DISCS = 5
# For states that move with the step, whose cones turn by √Δt; and how far from contact rounding leaves discs of a row.
FINER, TOUCH = (1e-2, 1e-4, 1e-6), 1e-12
# Discs that a single one is kicked along by, see ``kicked``.
KICKS = 12


def trapped(x: float, dt: float) -> bool:
    """Say whether the flow of the counterexample stands still at x: on a set that leaves every fixed x as dt → 0."""
    return 1 - dt <= x < 1


def flow(x: float, dt: float) -> float:
    """Make a step of explicit Euler for F = 1, but for the trap."""
    return x if trapped(x, dt) else x + dt


def stopped(dt: float) -> float:
    """Return where the flow is at t = 2, from 0."""
    x = 0.0
    for _step in range(round(2 / dt)):
        x = flow(x, dt)
    return x


def touching_discs(x: Floats) -> dincl.Problem:
    """Return discs without a drift."""
    return dincl.Problem(x, lambda _t, x: 0 * x, [dincl.NonOverlap(RADIUS)])


def beside_normals() -> list[float]:
    """Measure how far a step of PBD without its drift is from -N(S, x) for x_n → x, for each of FINER.

    The states x_n come to the row of discs x: they are turned by √dt, with overlaps of the size of dt.
    """
    x, rng = row(DISCS), np.random.default_rng(SEED)
    cone = dincl.geometry.normal_cone(touching_discs(x), 0.0, x, TOUCH)
    forces, far = rng.uniform(-1.0, 1.0, (20, DISCS, 2)), []
    for dt in FINER:
        c, s = np.cos(dt**0.5), np.sin(dt**0.5)
        turned = [x @ [[c, s], [-s, c]] + dt * rng.uniform(-0.2, 0.2, x.shape) for _ in forces]
        far.append(max(cone.distance(-shares(at, force, dt)) for at, force in zip(turned, forces, strict=True)))
    return far


@claim(
    "c2.limits",
    "Each limit of a consistent method is a solution.",
    source="sections 3 and 5",
    quote=(
        "the PBD method is a numerically consistent method. This … shows that each limit of the PBD method would be a "
        "solution."
    ),
    correction=Correction(
        (
            "consistency as in Definition 2.7, at a fixed x, does not show it; the bound is needed along x_n → x, with"
            " Δt → 0, as in (1.71), which PBD has while its overlaps are of the size of Δt"
        ),
        Effect.PROOF,
        (
            "“uses exactly this concept” after Definition 2.7, and “all convergent limits … will solve” in section 5; "
            "that overlaps stay small is left open in the conclusions of the thesis"
        ),
        why=(
            "a flow can be consistent at every fixed x, and fail on sets that move to x as Δt → 0; limits of its steps"
            " are then no solutions"
        ),
        place=1381,
    ),
    rests_on=("c2.definition", "c2.lemma"),
    tried_on="PBD with a row of five discs",
    chosen="the flow that stands still on [1 − Δt, 1), S = ℝ; Definition 2.7 as corrected",
)
def _limits() -> Evidence:
    """S = R for the counterexample: -N = {0}; and PBD for a row of discs."""
    local = max(abs((flow(x, DT / 10) - x) / (DT / 10) - 1) for x in (0.0, 0.5, 0.99, 1.0, 1.5))
    ends = [stopped(dt) for dt in STEPS]
    along = min(abs((flow(1 - dt / 2, dt) - (1 - dt / 2)) / dt - 1) for dt in STEPS)
    far = beside_normals()
    return Evidence(
        printed=(
            at_most("inconsistency of the flow at fixed x", local, 0.0, 1e-9),
            at_most("t = 2: change of its end from the step 10⁻³ to a tenth", abs(ends[-1] - ends[-2]), 2 * STEPS[-2]),
            at_most("t = 2: distance of this limit from the solution", abs(2.0 - ends[-1]), 0.0, 0.01),
        ),
        corrected=(
            at_least("x_n = 1 − Δt/2 → 1: inconsistency of the flow along x_n", along, 0.5),
            at_most("Δt = 10⁻⁶: inconsistency of PBD along x_n → x over that at 100 Δt,", far[2] / far[1], 0.2),
            at_most("Δt = 10⁻⁶: inconsistency of PBD along x_n → x", far[2], 0.01),
        ),
        seed=SEED,
    )


# F = 1, y = Phi(x) = x + h, but Phi(x) = x on [1 - h, 1).
STUCK = z3.And(x >= 1 - h, x < 1)
STEP = y == z3.If(STUCK, x, x + h)

_not_sufficient = argument(
    "c2.not-sufficient",
    "(2.10)",
    "We note, that this property alone does not imply convergence of the numerical method.",
    "A consistent method need not converge.",
    follows(
        [h > 0, z3.Or(x >= 1, h < 1 - x), STEP],
        y - x == h,
        ([h > 0, z3.Or(x >= 1, h < 2 * (1 - x)), STEP], y - x == h),
        "at each x ≠ 1 the quotient (Φ(x) − x)/h is 1 for all h < |1 − x|, and at x = 1 for all h: consistent",
        "for all h < 2|1 − x|",
    ),
    follows(
        [h > 0, x < 1, STEP],
        y < 1,
        ([h > 0, x < 1, y == z3.If(STUCK, x, x + 2 * h)], y < 1),
        "but from x < 1 no step leads to 1 or beyond, while the solution is at t = 2 at 2",
        "with steps of 2h",
    ),
)


def leaving() -> tuple[float, float]:
    """Return both sides of Definition 2.7 for S = [0, ∞), x = 0, F = 1, w = 1: PBD leaves the wall, σ is R."""
    problem = dincl.Problem([[0.0]], lambda _t, _x: np.array([[1.0]]), [dincl.HalfSpace(normal=(1,))])
    left = W * (float(dincl.solve(problem, dincl.PBD(dt=DT), t=DT).final[0, 0]) / DT - 1.0)
    return left, dincl.geometry.support(problem, 0.0, [[0.0]], [[W]], tol=ROUNDING, radius=R)


@claim(
    "c2.definition",
    "A method is consistent if its support functions tend to those of the normal cone.",
    source="Definition 2.7",
    quote="lim sup σ((Φ(x) − x)/Δt − F(x), w) → σ(−N(S, x) ∩ B_R(0), w)",
    correction=Correction(
        "lim sup σ(…, w) ≤ σ(−N(S, x) ∩ B_R(0), w), as in Definition 1.27",
        Effect.MODEL,
        "Lemma 2.8: with the printed arrow PBD is not consistent, where a force leads away from contact",
        why=(
            "upper semicontinuity bounds the support functions from above; where F leads away from contact the left "
            "side is 0 and the right side is R"
        ),
        place=1401,
    ),
)
def _definition() -> Evidence:
    left, right = leaving()
    name = "left side of Definition 2.7, a point that is pulled off a wall"
    return Evidence(printed=(equal(name, left, right, 1e-9),), corrected=(at_most(name, left, right, 1e-9),))


def shares(x: Floats, force: Floats, dt: float) -> Floats:
    """Return (Φ(x) - x)/Δt - F(x)."""
    return (points_of_step(x, force, dt)[-1] - x) / dt - force


@claim(
    "c2.lemma",
    "With bounded forces PBD is consistent in the sense of Definition 2.7.",
    source="Lemma 2.8",
    quote="For F bounded, i.e., ‖F‖_∞ < ∞, the PBD method is consistent in the sense of Definition 2.7.",
    correction=Correction(
        "… in the sense of Definition 2.7 with “≤” in place of “→”",
        Effect.PROOF,
        "nothing else: the proof shows “≤”, and that is what section 3 uses",
        why=(
            "where a force leads away from contact the left side of the definition is 0 and the right side is R; see "
            "c2.definition"
        ),
        place=1409,
    ),
    rests_on=("c2.definition", "c2.induction"),
    tried_on="a row of five discs, 20 random forces",
)
def _lemma() -> Evidence:
    """How far a step is from -N(S, x), for a row of discs and random forces, as it goes to 0."""
    x = row(DISCS)
    cone = dincl.geometry.normal_cone(touching_discs(x), 0.0, x, ROUNDING)
    forces = np.random.default_rng(SEED).uniform(-1.0, 1.0, (20, *x.shape))
    far = [max(cone.distance(-shares(x, force, dt)) for force in forces) for dt in STEPS]
    size = max(float(np.linalg.norm(shares(x, force, STEPS[-1])) / np.linalg.norm(force)) for force in forces)
    left, right = leaving()
    return Evidence(
        printed=(equal("left side of Definition 2.7, a point that is pulled off a wall", left, right, 1e-9),),
        corrected=(
            equal("Δt = 10⁻³: largest distance from −N(S, x) over that at Δt/10,", far[1] / far[2], 10.0, 1.0),
            at_most("Δt = 10⁻⁴: largest distance from −N(S, x)", far[2], 1e-3),
            at_most("largest length over (2^M + 1) ‖F‖", size / (2 ** (DISCS * (DISCS - 1) / 2) + 1), 1.0),
        ),
        seed=SEED,
    )


def kicked(count: int) -> tuple[Floats, Floats]:
    """Return a state of S and a prediction in which disc 0 meets, one after another, ``count`` discs just behind it."""
    width, place = 1e-3 * RADIUS, 0.0
    x, predicted = np.zeros((2, count + 1, 2))
    x[0] = -1.9 * RADIUS, 0.0
    for k in range(1, count + 1):
        predicted[k] = place - width, 0.0
        x[k] = RADIUS * (k - 1), RADIUS * (0.87 if k % 2 else -0.87)
        place += (2 * RADIUS - width) / 2
    return x, predicted


# x is in all S_j: n = |p_j - p_(j-1)| <= |x - p_(j-1)| = d, q = |p_j - x|, P = 2^(j-1) dt |F|; then P = 2^M, f = dt
# |F|.
DOUBLED = follows(
    [d >= 0, n <= d, q <= n + d, d <= power],
    q <= 2 * power,
    q <= power,
    "‖p_j − x‖ ≤ ‖p_j − p_{j−1}‖ + ‖p_{j−1} − x‖ ≤ 2‖p_{j−1} − x‖, so 2^j Δt‖F‖ by induction, for any sets S_j ∋ x",
    "no factor 2",
)
BOUND = follows(
    [power >= 1, f >= 0, last <= power * f, first == f, way <= last + first],
    way <= (power + 1) * f,
    way <= power * f,
    "‖p_M − x‖ ≤ 2^M Δt‖F‖ and ‖x − p_0‖ = Δt‖F‖ give ‖p_M − p_0‖ ≤ (2^M + 1) Δt‖F‖",
    "≤ 2^M Δt‖F‖",
)


@claim(
    "c2.induction",
    "The rate of a step without its drift is at most (2^j + 1) ‖F‖_∞.",
    source="after (2.13)",
    also=("c2.steps",),
    quote="‖(Φ(x) − x)/Δt − F(x)‖ ≤ (2^j + 1) ‖F‖_∞",
    correction=Correction(
        "≤ (2^M + 1) ‖F‖_∞ and R = (2^M + 1) ‖F‖_∞ + 1: the bound is (2.13) at j = M",
        Effect.PROOF,
        "the constant R of the proof, which needs only to exist",
        why="j is the index of the points; the step ends at p_M",
        place=1458,
    ),
    chosen="j = 1 for the free index",
)
def _induction() -> Evidence:
    x, predicted = kicked(KICKS)
    moved = predicted - x
    gap = min(float(np.linalg.norm(x[i] - x[j])) for i in range(len(x)) for j in range(i)) - 2 * RADIUS
    ratio = float(np.linalg.norm(points_of_step(x, moved, 1.0)[-1] - predicted) / np.linalg.norm(moved))
    return Evidence(
        printed=(
            at_least(f"least gap of the {len(x)} discs at the start", gap, 0, ROUNDING),
            at_most("rate of a step without its drift over ‖F‖, a disc passed on by the others", ratio, 3.0),
        ),
        corrected=(DOUBLED(), BOUND()),
    )
