"""Chapter 2, section 1.1.3: the penalty method."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from verification.claims import Evidence, Verdict, at_most, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication, solver_library
from verification.thesis.text.quoted import claim

# A point that is pressed onto the wall x >= 0 with force 1, g(x) = x [length / time, time].
PRESSED, DT, STRENGTH = -1.0, 0.01, 20.0


def printed_push(x: float) -> float:
    """∇g where g < 0, for g(x) = x."""
    return 1.0 if x < 0 else 0.0


def spring(x: float) -> float:
    """max(0, -g) ∇g."""
    return max(0.0, -x)


def implicit_residual(push: Callable[[float], float]) -> float:
    """How far the nearest y is from solving y = x + dt (F + ε push(y)), for x half a step above the wall."""
    start = -PRESSED * DT / 2
    return min(float(abs(y - start - DT * (PRESSED + STRENGTH * push(y)))) for y in np.linspace(-0.1, 0.1, 4001))


def chattering(dt: float) -> float:
    """The extent of the places of the last of many explicit Euler steps of (2.2) with the printed force, from x = 0."""
    path = [0.0]
    for _ in range(2000):
        path.append(path[-1] + dt * (PRESSED + STRENGTH * printed_push(path[-1])))
    return float(np.ptp([*path[-500:], 0.0]))


def steepest(push: Callable[[float], float]) -> float:
    """The largest slope of a force between places 10^-6 apart."""
    h = 1e-6
    return max(abs(push(x + h) - push(x)) / h for x in h * np.arange(-2000.5, 2000.0))


@claim(
    "c2.printed-penalty",
    "With a force ∇g at overlap the inclusion is smoothed to an ordinary differential equation.",
    "section 1.1.3",
    Verdict.CORRECTED,
    chosen="one constraint, g(x) = x",
)
def _printed_penalty() -> Evidence:
    """The jump of the force where contact begins, and whether an implicit step has a solution."""
    h = 1e-9
    jumps = [push(-h) - push(0.0) for push in (printed_push, spring)]
    left = [implicit_residual(push) for push in (printed_push, spring)]
    chatter = chattering(DT / 4) / (STRENGTH * DT / 4)
    return Evidence(
        f"Wall x ≥ 0, force −1, ε = {STRENGTH:g}: the printed force jumps by ε at g = 0, so (2.2) is an inclusion, the "
        f"exact penalty (1.7): it rests at x = 0 for this ε; there explicit Euler chatters by {chatter:.2f} ε Δt, "
        f"and an implicit step misses by {left[0]:.3f}. −g∇g has the slope {steepest(spring):.0f}, an implicit step "
        f"misses by {left[1]:.0e}.",
        printed=(at_most("jump / ε", jumps[0], 0.0, 1e-6), at_most("implicit step misses by", left[0], 1e-4)),
        corrected=(
            at_most("jump / ε", jumps[1], 0.0, 1e-6),
            at_most("implicit step misses by", left[1], 1e-4),
            at_most("Lipschitz constant / ε", steepest(spring), 1.0, 1e-6),
        ),
    )


@claim(
    "c2.penalty-limit",
    "The stronger the repulsion, the nearer is the penalty method to the inclusion.",
    "(2.2)",
    Verdict.PROVED_INSTANCE,
    chosen="the force as corrected in c2.printed-penalty",
    tried_on="two discs that a constant force presses together along their line",
)
def _limit() -> Evidence:
    """r, the distance of the centres, has r' = 2 (-f + e (L - r)), L = 2R, from r = L; the inclusion keeps r = L."""
    sp = library()
    t, f, e, L = sp.symbols("t f epsilon L", positive=True)

    def residuals(s: Any) -> Any:
        r = L - s * f / e * (1 - sp.exp(-2 * e * t))
        return [r.diff(t) - 2 * (-f + e * (L - r)), r.subs(t, 0) - L]

    return proved(
        identity(
            "the overlap of the penalty method is (f/ε)(1 − e^{−2εt}), which tends to 0 with 1/ε", residuals, "−f/ε"
        )
    )


@claim(
    "c2.stiffness",
    "The longest stable step of an explicit method falls as the penalty parameter grows.",
    "section 1.1.3",
    Verdict.PROVED_INSTANCE,
    chosen="the force as corrected in c2.printed-penalty",
    tried_on="a point between two walls, by explicit Euler",
)
def _stiffness() -> Evidence:
    """Outside of a wall x' = -e x, x the overlap: a step multiplies x by 1 - dt e; k, e: two strengths."""
    z3 = solver_library()
    return proved(
        implication(
            "|1 − Δt ε| ≤ 1 if and only if 0 ≤ Δt ≤ 2/ε",
            lambda s, h, e: ([e > 0], ((1 - h * e) * (1 - h * e) <= 1) == z3.And(h >= 0, h * e <= s * 2)),
            "Δt ≤ 1/ε",
            0.5,
        ),
        implication(
            "2/ε falls as ε grows",
            lambda s, h, g, e, k: ([e > 0, s * k > s * e, k > 0, h * e == 2, g * k == 2], g < h),
            "as ε falls",
        ),
    )
