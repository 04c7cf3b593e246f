"""When an integration is given up because it would take too many steps."""

from __future__ import annotations

from dincl.errors import StepFailure
from dincl.status import Status

# A run is not judged by its first steps: their length is still being found, and grows at most tenfold from one to the
# next.
UNJUDGED = 200


def check_pace(steps: int, most: int, now: float, end: float) -> None:
    """End a run from 0 to ``end`` that has come to ``now`` and will not reach ``end`` within ``most`` steps.

    After k steps a run may still become ``most``/k times as fast as it was on average. Runs that are far from that, as
    those over 10^30 periods, end after some hundreds of steps; those that need few more than ``most`` make nearly all.

    Raises
    ------
    StepFailure
        TOO_MANY_STEPS, with the steps made and those that the run would take.
    """
    if steps >= min(most, UNJUDGED) and now / end < (steps / most) ** 2:
        whole = f"{steps / (now / end):.1e}" if now > 0 else "infinitely many"
        raise StepFailure(
            Status.TOO_MANY_STEPS, f"{steps} steps until t = {now:.6g}; at this pace {whole}, and {most} are allowed."
        )
