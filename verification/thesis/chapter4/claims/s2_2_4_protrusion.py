"""Chapter 4, sections 2.1 and 2.2.4: how a basal point runs, and how it pulls its cell."""

from __future__ import annotations

import math

import numpy as np

from tissue.state.cells import Floats
from verification.claims import Correction, Effect, Evidence, Verdict, at_least, at_most, claim, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication, solver_library

# Units of R_soft; v^run has no value in the thesis: 1 R_soft/h, and with (4.1) only the time scale depends on it.
SPEED, ALPHA, STEP = 1.0, 2.0, 1e-3
DEPTH = 2.0
# A basal point this near to the depth has arrived.
# Where a nucleus rests; k^bx of Table 2 [1/h]; for how long; a rise in a step of 1e-3 h that is none: 50 steps to full.
CENTRE, RATE, HOURS, SMOOTH = 3.0, 5.0, 2.0, 0.02
# The rate of a rest length that is set to zero.
AT_ONCE = math.inf
# What rounding leaves.
TOL = 1e-7


def velocity(B: Floats, X: Floats) -> Floats:
    """(4.1)."""
    away = B - X
    return SPEED * away / np.hypot(*away) if B[1] > -DEPTH else np.zeros(2)


def run(B: Floats, X: Floats, hours: float) -> tuple[Floats, float]:
    """Where the basal point is after some hours while the nucleus rests, and how long its path was."""
    length = 0.0
    for _ in range(round(hours / STEP)):
        by = STEP * velocity(B, X)
        B, length = B + by, length + float(np.hypot(*by))
    return B, length


@claim(
    "c4.protrusion-law",
    (
        "A basal point runs away from its nucleus at one speed and stops 2 R_soft below the basal layer; one "
        "that begins above its nucleus never gets there."
    ),
    source="(4.1)",
    quote="Ḃ_i = v^run (B_i − X_i)/‖B_i − X_i‖ if y(B_i) > −2R^soft, 0 else",
    recorded=Verdict.PROVED,
    chosen="the nucleus rests; v^run = 1 R_soft/h, for the thesis gives no value",
)
def _law() -> Evidence:
    """B = X + (r + v t) e, e a unit vector, X at rest; e1 = e.y < 0 for a point that begins below its nucleus."""
    sp, z3 = library(), solver_library()
    t, r, v, turn = sp.symbols("t r v w", positive=True)
    e = sp.Matrix([sp.cos(turn), sp.sin(turn)])

    return proved(
        identity(
            "B = X + (r + vt)e, |B − X| = r + vt, solves (4.1) above the depth: one speed, one direction",
            lambda s: [
                ((r + v * t) * e).diff(t) - s * v * e,
                ((r + v * t) * e).dot((r + v * t) * e) - (r + v * t) ** 2,
            ],
            "towards X",
        ),
        implication(
            "if e points down, y(B) = −2R^soft at t = (y(X) + 2R^soft + r e_y)/(−v e_y); if not, y(B) ≥ y(X) > "
            "−2R^soft for "
            "all t",
            lambda s, x, e1, r, v, t, R, y: (
                [r > 0, v > 0, R > 0, x > 0, t >= 0, y == x + (r + v * t) * e1],
                [
                    z3.Implies(e1 < 0, z3.Implies(-v * e1 * t == s * (x + 2 * R + r * e1), y == -2 * R)),
                    z3.Implies(e1 >= 0, y > -2 * R),
                ],
            ),
            "at the negative of that time",
        ),
    )


def energy(X: Floats, B: Floats, eta: float) -> float:
    """W^bx of (3.10), in R_soft."""
    return float(ALPHA / (1.0 + eta) * (np.hypot(*(X - B)) - 1.0 - eta) ** 2)


def pull(X: Floats, B: Floats, eta: float) -> Floats:
    """The force on the nucleus, as printed before the rule of η^bx."""
    d = np.hypot(*(B - X))
    return np.asarray(2 * ALPHA / (1.0 + eta) * (d - 1.0 - eta) * (B - X) / d)


@claim(
    "c4.basal-force",
    "The force of the basal spring on the nucleus is the one that its energy (3.10) gives.",
    source="section 2.2.4",
    quote="F = 2α^bx/(R^soft + η) (‖B − X‖ − R^soft − η) (B − X)/‖B − X‖",
    recorded=Verdict.PROVED,
)
def _force() -> Evidence:
    sp = library()
    X, B = (sp.Matrix(sp.symbols(f"{name}:2", real=True)) for name in "xb")
    alpha, R, eta = sp.symbols("alpha R eta", positive=True)
    d = sp.sqrt((B - X).dot(B - X))
    energy = alpha / (R + eta) * (d - R - eta) ** 2
    return proved(
        identity(
            "the printed force is −∂W^bx/∂X of (3.10), for all places and rest lengths",
            lambda s: (
                s * 2 * alpha / (R + eta) * (d - R - eta) * (B - X) / d + sp.Matrix([energy.diff(each) for each in X])
            ),
            "+∂W/∂X",
        )
    )


def rest_length(X: Floats, B: Floats) -> float:
    """η^bx(t) of section 2.2.4."""
    return float(np.hypot(*(X - B)) - 1.0) if B[1] > 0 else 0.0


@claim(
    "c4.grip",
    "With this rest length the spring has no force above the basal layer and pulls once below.",
    source="section 2.2.4",
    quote="η^bx := ‖X − B‖ − R^soft if y(B) > 0, 0 if y(B) ≤ 0",
    correction=Correction(
        (
            "… and pulls once below, as long as ‖X − B‖ > R^soft; a nucleus that is nearer to its basal point is "
            "pushed away"
        ),
        Effect.MODEL,
        (
            "where a nucleus rests beside a basal point below the layer: its disc touches the point, it does not "
            "reach it"
        ),
        why=(
            "with η^bx = 0 the printed force is 2α^bx/R^soft (‖B − X‖ − R^soft) towards B: below 0 if ‖B − X‖ < R^soft"
        ),
        place=2454,
    ),
    rests_on=("c4.basal-force",),
)
def _grip() -> Evidence:
    """The pull towards B for rest lengths d - R above the layer and 0 below it, for nuclei at the distance d from B."""
    distance = 0.5
    near = float(pull(np.array([0.0, distance]), np.zeros(2), rest_length(np.array([0.0, distance]), np.zeros(2)))[1])
    d, R, alpha = library().symbols("d R alpha", positive=True)
    above = identity(
        "with η^bx = ‖X − B‖ − R^soft, above the layer, the force is 0",
        lambda s: 2 * alpha / (R + d - s * R) * (d - R - (d - s * R)),
        "‖X − B‖ + R^soft",
    )
    below = implication(
        "with η^bx = 0, below it, the force pulls towards B if ‖X − B‖ > R^soft",
        lambda s, d, R, alpha, f: ([R > 0, alpha > 0, s * (d - R) > 0, d > 0, f * R == 2 * alpha * (d - R)], f > 0),
        "if ‖X − B‖ < R^soft",
    )
    return Evidence(
        printed=(above, at_least("pull towards B below the line, ‖X − B‖ = R^soft/2, α^bx = 2", -near, TOL)),
        corrected=(above, below),
    )


def gripping(rate: float) -> Floats:
    """The pull over that of a spring with rest length 0, in each step after the basal point came below the line."""
    X, B = np.array([0.0, CENTRE]), np.zeros(2)
    eta = CENTRE - 1.0
    steps = np.arange(1, round(HOURS / STEP) + 1) * STEP
    full = np.hypot(*pull(X, B, 0.0))
    return np.array([np.hypot(*pull(X, B, eta * math.exp(-rate * t))) / full for t in steps])


@claim(
    "c4.grip-at-once",
    "The rule of 2.2.4 is that of 2.1, by which the desired rest length is zero and the pull grows.",
    source="sections 2.1, 2.2.4",
    quote=(
        "as soon as the basal point is below the basal layer, we set the desired rest length of the "
        "basal-nuclei spring to zero … η^bx(t) := 0 if y(B) ≤ 0. This equation replaces (3.3)."
    ),
    correction=Correction(
        "below the layer η^bx* := 0 and (3.3) goes on to hold; only above it the rule for η^bx replaces (3.3)",
        Effect.MODEL,
        (
            "how suddenly [P] pulls: the two sections contradict each other; in the published program the rest "
            "length relaxes below the layer (time_step_springs! in src/core/simulate.jl of SteffenPL/sEMTor.jl)"
        ),
        why=(
            "section 2.1 sets the desired rest length to zero and section 2.2.4 the rest length itself; with the "
            "latter the pull jumps to its full size within one step"
        ),
        place=2456,
    ),
    rests_on=("c4.grip",),
    chosen="the nucleus and the basal point rest; k^bx of Table 2",
)
def _at_once() -> Evidence:
    shares = [gripping(rate) for rate in (AT_ONCE, RATE)]
    jumps = [float(np.diff(each, prepend=0.0).max()) for each in shares]
    what = f"largest rise of the pull within {STEP:g} h below the line, over the full one,"
    return Evidence(
        printed=(at_most(f"{what} η := 0", jumps[0], SMOOTH),),
        corrected=(
            at_most(f"{what} η* := 0 and (3.3)", jumps[1], SMOOTH),
            at_least(f"pull {HOURS:g} h after crossing, over the full one", float(shares[1][-1]), 1.0, SMOOTH),
        ),
    )
