"""XPBD whose multipliers are carried from step to step: contacts stick, and compliant contacts sink in."""

from __future__ import annotations

from collections.abc import Callable

from verification.thesis.chapter2.stability.case import Case, Found, within

DT = 1e-3
COMPLIANCE = 2e-3
# A particle is pressed for this time, and then pulled off as strongly [time].
PRESSED = 1.0


def carried(velocity: Callable[[float], float], compliance: float, end: float) -> list[float]:
    """Return the states of a particle on a wall, x >= 0, by steps of one row whose multiplier is never reset.

    One row is solved by one correction, so the number of sweeps does not matter.
    """
    x, multiplier, states = 0.0, 0.0, []
    for k in range(round(end / DT)):
        x += DT * velocity(k * DT)
        change = -(x + compliance / DT * multiplier) / (1 + compliance / DT)
        change = max(change, -multiplier)
        multiplier, x = multiplier + change, x + change
        states.append(x)
    return states


def _sticks() -> Found:
    states = carried(lambda t: -1.0 if t < PRESSED else 1.0, 0.0, 3 * PRESSED)
    left = next(k for k, x in enumerate(states) if x > DT / 2) * DT
    return within(PRESSED, left - PRESSED, 3 * DT, "time that the particle stays on the wall after the pull begins")


def _sinks() -> Found:
    states = carried(lambda _t: -1.0, COMPLIANCE, PRESSED)
    speed = (states[0] - states[-1]) / (PRESSED - DT)
    words = f"speed into the wall; with multipliers reset it rests at a depth of {COMPLIANCE:g}"
    return within(COMPLIANCE / (COMPLIANCE + DT), speed, 1e-6, words)


CASES = (
    Case(
        "carried-sticks",
        "XPBD, multipliers not reset: a contact sticks",
        "the multiplier summed up while pressed is spent before the contact opens: as long as it was pressed",
        _sticks,
    ),
    Case(
        "carried-sinks",
        "XPBD, multipliers not reset: a compliant contact sinks",
        "the load is carried by growth of the multiplier only: speed c / (c + dt) times the free one",
        _sinks,
    ),
)
