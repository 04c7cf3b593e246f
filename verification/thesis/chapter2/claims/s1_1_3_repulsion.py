"""Chapter 2, section 1.1.3: the penalty method."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import dincl
from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_most, equal
from verification.thesis.chapter2.claims.s1_1_reference_methods import END, HALVED, error

# A point that is pressed onto the wall x >= 0 with force 1, g(x) = x [length / time, time].
PRESSED, DT, STRENGTH = -1.0, 0.01, 20.0
STIFF = (10.0, 100.0)
# Strengths, and a step whose error is below what they leave.
STRENGTHS, FINE = (20.0, 40.0), 2e-3


def printed_push(x: float) -> float:
    """∇g where g < 0, for g(x) = x."""
    return 1.0 if x < 0 else 0.0


def spring(x: float) -> float:
    """max(0, -g) ∇g."""
    return max(0.0, -x)


def repulsive(dt: float, strength: float) -> dincl.Scheme:
    """The penalty method with springs."""
    return dincl.Penalty(dt=dt, strength=strength)


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
    source="section 1.1.3",
    quote="smoothening approach … F_ℓ(x) := ∇g_ℓ(x) if g_ℓ(x) < 0 … one might apply any numerical scheme for ODEs",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "with F_ℓ = −g_ℓ ∇g_ℓ where g_ℓ < 0 it is an ODE whose right-hand side is Lipschitz continuous while no "
        "centres coincide; as printed (2.2) is a differential inclusion again",
        Effect.MODEL,
        "“any numerical scheme for ODEs”; the stiffness for large ε of the next paragraph, which is that of −g∇g",
        why=(
            "∇g does not grow from 0 with the overlap: it jumps where contact begins, so the right-hand side is "
            "not continuous"
        ),
        place=1223,
    ),
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
    source="(2.2)",
    quote="For ε → ∞ the dynamics converge to the non-smooth behaviour.",
    chosen="the force as corrected in c2.printed-penalty",
    recorded=Kind.NOT_REFUTED,
    tried_on="two discs in contact",
)
def _limit() -> Evidence:
    weak, strong = (error(repulsive(FINE, strength)) for strength in STRENGTHS)
    return Evidence(
        f"Two discs in contact, t = {END:g}: springs of strength {STRENGTHS[0]:g} and {STRENGTHS[1]:g} miss the exact "
        f"solution by {weak:.2e} and {strong:.2e}: first order in 1/ε.",
        (equal("error over that of twice the strength", weak / strong, 2.0, HALVED),),
    )


def _explodes(strength: float, dt: float) -> bool:
    """Explicit Euler for a point between two walls at 0 that push back."""
    x = 0.0
    for _ in range(2000):
        x += dt * (PRESSED + strength * (spring(x) - spring(-x)))
        if abs(x) > 100.0:
            return True
    return False


def longest_step(strength: float) -> float:
    """By bisection, the longest step that stays bounded."""
    low, high = 0.0, 10.0
    for _ in range(12):
        middle = (low + high) / 2
        low, high = (low, middle) if _explodes(strength, middle) else (middle, high)
    return low


@claim(
    "c2.stiffness",
    "The longest stable step of an explicit method falls as the penalty parameter grows.",
    source="section 1.1.3",
    quote="the stiffness typically also increases dramatically for large penalty parameters which forces small …",
    chosen="the force as corrected in c2.printed-penalty",
    recorded=Kind.NOT_REFUTED,
    tried_on="a point between two walls, by explicit Euler",
)
def _stiffness() -> Evidence:
    limits = [longest_step(strength) for strength in STIFF]
    return Evidence(
        f"A point held by two walls with springs: explicit Euler stays bounded up to dt = {limits[0]:.3f} at strength "
        f"{STIFF[0]:g} and {limits[1]:.4f} at {STIFF[1]:g}, in both cases 2/ε.",
        tuple(
            equal(f"longest step · ε at ε = {strength:g}", limit * strength, 2.0, 0.2)
            for strength, limit in zip(STIFF, limits, strict=True)
        ),
    )
