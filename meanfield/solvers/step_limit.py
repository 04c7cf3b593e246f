"""Limit of the number of steps, applied early to runs that would exceed it by far."""

from __future__ import annotations

from dincl.errors import StepFailure
from dincl.status import Status

# The first steps of a run say little about its length: step lengths grow by up to a factor of ten from step to step.
WARM_UP_STEPS = 200


def check_step_limit(steps: int, most: int, now: float, end: float) -> None:
    """Stop a run from time 0 to ``end`` that has reached ``now`` and will not reach ``end`` within ``most`` steps.

    After k steps, a run may still become ``most``/k times as fast as its average so far. A run over 1e30 periods thus
    stops after some hundreds of steps; a run that needs slightly more than ``most`` steps stops after almost ``most``.

    Raises
    ------
    StepFailure
        TOO_MANY_STEPS, with the number of steps made and the number that the run would take.
    """
    if steps >= min(most, WARM_UP_STEPS) and now / end < (steps / most) ** 2:
        total = f"{steps / (now / end):.1e}" if now > 0 else "infinitely many"
        detail = f"{steps} steps until t = {now:.6g}; at this rate the run takes {total}, at most {most} are allowed."
        raise StepFailure(Status.TOO_MANY_STEPS, detail)
