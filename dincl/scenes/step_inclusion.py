"""The step inclusion: one number that falls to zero and stays there."""

from __future__ import annotations

from typing import Any

import numpy as np

from dincl.constraints import HalfSpace
from dincl.drifts import constant
from dincl.scenes.exact import Exact
from dincl.scenes.scene import Scene

# sqrt(1/2), so that the fall never ends at the end of a time step.
START = 0.7071067811865476


class _StepInclusion(Exact):
    @property
    def _shape(self) -> tuple[int, int]:
        return (1, 1)

    def _at(self, t: Any) -> list[Any]:
        return [max(START - t, 0 * t)]


def step_inclusion() -> Scene:
    """x' in -sign(x), sign(0) = [-1, 1], x(0) = c = sqrt(1/2), written as x' in -1 - N([0, oo), x).

    Exact solution: x(t) = max(c - t, 0). The two right-hand sides are the same for x > 0. At x = 0 they are [-1, 1]
    and -1 - (-oo, 0] = [-1, oo): both hold the velocity 0 with which the solution goes on. Both inclusions have one
    solution only, the first as -sign is one-sided Lipschitz, the second as [0, oo) is convex: so it is the same.

    Source: Example 1.9, (1.13), Remark 1.14.
    """
    return Scene(
        [[START]],
        constant(np.array([[-1.0]])),
        [HalfSpace(normal=(1,))],
        name="step_inclusion",
        title="The step inclusion",
        times=(0.5, 1.0),
        radius=0.0,
        exact=_StepInclusion(),
    )
