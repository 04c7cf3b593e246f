"""A point that is swept to and fro by a moving interval."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dincl.constraints import HalfSpace, Moving
from dincl.drifts import constant
from dincl.scenes.exact import Exact
from dincl.scenes.scene import Scene

START = 0.2
WIDTH = 0.5


class _SweepingInterval(Exact):
    @property
    def _shape(self) -> tuple[int, int]:
        return (1, 1)

    def _at(self, t: Any) -> list[Any]:
        import mpmath

        left, rises = mpmath.sin(t), mpmath.cos(t) > 0
        last_reversal = START if t < mpmath.pi / 2 else WIDTH - 1 if rises else 1
        return [min(max(mpmath.mpf(last_reversal), left), left + WIDTH)]


def sweeping_interval() -> Scene:
    """x' in -N(C(t), x), C(t) = [sin(t), sin(t) + w], w = 1/2, x(0) = 1/5, without any drift.

    Exact solution: while sin is monotone, from one of its reversals (2k + 1) pi/2 to the next, only one end of the
    interval can push, and x(t) = min(max(x_r, sin(t)), sin(t) + w) with x_r the place at the last reversal: the point
    rests until an end reaches it and goes with that end. At a maximum of sin the left end is at 1 and has pushed the
    point there, x_r = 1, at a minimum the right end has, x_r = w - 1, as w < 2; before the first, x_r = x(0).

    A catch-up step is exact while the interval moves one way, so the error comes from reversals inside of a step
    alone: the path that the steps see turns at most h^2/8 short of the true extremum.

    Source: Example 1.17, (1.16), (1.17).
    """
    return Scene(
        [[START]],
        constant(np.array([[0.0]])),
        [Moving(HalfSpace(normal=(1,)), _left_end), Moving(HalfSpace(normal=(-1,), offset=-WIDTH), _left_end)],
        name="sweeping_interval",
        title="A point swept by a moving interval",
        times=(1.0, 2.0, 10.0),
        radius=0.0,
        exact=_SweepingInterval(),
    )


def _left_end(t: float) -> tuple[float]:
    return (math.sin(t),)
