"""Scenes in one dimension, all with exact solutions: the step inclusion, the swept point, the row of intervals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dincl.constraints import HalfSpace, Moving, NonOverlap
from dincl.drifts import attraction, constant
from dincl.scenes.base import Exact, Scene

# sqrt(1/2), so that the fall never ends at the end of a time step.
FALL_START = 0.7071067811865476
SWEPT_START, WIDTH = 0.2, 0.5
STACK_RADII = (0.5, 0.25, 0.375, 0.5, 0.25, 0.375)
STACK_START = (1.23, 5.08, 5.84, 8.05, 9.17, 15.1)


def step_inclusion() -> Scene:
    """x' in -sign(x), sign(0) = [-1, 1], x(0) = c = sqrt(1/2), written as x' in -1 - N([0, oo), x).

    Exact solution: x(t) = max(c - t, 0). The two right-hand sides are the same for x > 0. At x = 0 they are [-1, 1]
    and -1 - (-oo, 0] = [-1, oo): both contain the velocity 0 with which the solution goes on. Both inclusions have one
    solution only, the first as -sign is one-sided Lipschitz, the second as [0, oo) is convex: so it is the same.

    Source: Example 1.9, (1.13), Remark 1.14.
    """
    return Scene(
        [[FALL_START]],
        constant(np.array([[-1.0]])),
        [HalfSpace(normal=(1,))],
        name="step_inclusion",
        title="The step inclusion",
        times=(0.5, 1.0),
        radius=0.0,
        exact=Exact((1, 1), _step_inclusion),
    )


def _step_inclusion(t: Any) -> list[Any]:
    return [max(FALL_START - t, 0 * t)]


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
        [[SWEPT_START]],
        constant(np.array([[0.0]])),
        [Moving(HalfSpace(normal=(1,)), _left_end), Moving(HalfSpace(normal=(-1,), offset=-WIDTH), _left_end)],
        name="sweeping_interval",
        title="A point swept by a moving interval",
        times=(1.0, 2.0, 10.0),
        radius=0.0,
        exact=Exact((1, 1), _sweeping_interval),
    )


def _left_end(t: Any) -> tuple[Any]:
    """Return sin(t), for balls and series of Arb, too."""
    return (math.sin(t) if isinstance(t, (float, int)) else t.sin(),)


def _sweeping_interval(t: Any) -> list[Any]:
    import mpmath

    left, rises = mpmath.sin(t), mpmath.cos(t) > 0
    last_reversal = SWEPT_START if t < mpmath.pi / 2 else WIDTH - 1 if rises else 1
    return [min(max(mpmath.mpf(last_reversal), left), left + WIDTH)]


def stack() -> Scene:
    r"""x_i' in -x_i - N_i, six intervals of radii r_i on a line that may not overlap, behind a wall at 0: x_0 >= r_0.

    Exact solution: let c be the packed row, c_0 = r_0, c_i = c_{i-1} + r_{i-1} + r_i, and K the convex cone
    0 <= z_0 <= z_1 <= ... Then x - c lies in K. For z = e^t (x - c), with N(K, .) the same along a ray,

        z' in -e^t c - N(K, z),   and, in the time s = e^t - 1,   dz/ds in -c - N(K, z).

    This is solved by z = P_K(p), p = z(0) - s c. Indeed p - z lies in N(K, z), with the multipliers
    lambda_k = sum_{i <= k} (p_i - z_i) between i = k and k + 1, summed over the cluster of touching intervals that
    contains k. There z_i is the mean of p, so lambda_k grows at the rate sum_{i <= k} (mean(c) - c_i), or z_i = 0 at
    the wall, lambda_k = -sum_{i > k} p_i and the rate is sum_{i > k} c_i. Both are positive, since c increases. So
    contacts stay once made, and -c - dz/ds = d(p - z)/ds, with these rates as multipliers, lies in N(K, z). Hence

        x(t) = c + e^{-t} P_K(x(0) - c - (e^t - 1) c).

    P_K is isotonic regression (pooling of adjacent violators) followed by max(., 0).

    Source: the stack mentioned in section 4.1 of chapter 2.
    """
    return Scene(
        np.array(STACK_START)[:, None],
        attraction(0),
        [NonOverlap(STACK_RADII), HalfSpace(normal=(1,), radius=STACK_RADII)],
        name="stack",
        title="A row of intervals pressed against a wall",
        times=(0.5, 1.0, 1.5),
        radius=STACK_RADII,
        exact=Exact((len(STACK_START), 1), _stack),
    )


def _stack(t: Any) -> list[Any]:
    import mpmath

    # c without rounding: the radii are multiples of 1/8.
    packed = [mpmath.mpf(c) for c in np.cumsum(2 * np.array(STACK_RADII)) - STACK_RADII]
    growth = mpmath.exp(t)
    free = [x - c - (growth - 1) * c for x, c in zip(STACK_START, packed, strict=True)]
    return [c + max(z, mpmath.mpf(0)) / growth for c, z in zip(packed, _isotonic(free), strict=True)]


def _isotonic(values: list[Any]) -> list[Any]:
    """Find the nearest increasing sequence, in any precision: adjacent blocks are pooled while their means decrease."""
    blocks: list[tuple[Any, int]] = []
    for value in values:
        mean, size = value, 1
        while blocks and blocks[-1][0] >= mean:
            left, count = blocks.pop()
            mean, size = (left * count + mean * size) / (count + size), count + size
        blocks.append((mean, size))
    return [mean for mean, size in blocks for _ in range(size)]
