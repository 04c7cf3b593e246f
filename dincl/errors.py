"""The errors of this package: two for the user, one that travels between a step and the loop around it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dincl.status import Status
    from dincl.trajectory import Trajectory


class InvalidProblem(ValueError):
    """Input that cannot be right; the message names the argument, its value and what is allowed."""


class StepFailed(RuntimeError):
    """A run that ended early; ``trajectory`` holds all that was computed until then, with its Status."""

    def __init__(self, trajectory: Trajectory) -> None:
        super().__init__(f"{trajectory.status.value} {trajectory.detail}".rstrip())
        self.trajectory = trajectory


class StepFailure(Exception):
    """Why a single step could not be made; ``solve`` turns it into the Status of the Trajectory."""

    def __init__(self, status: Status, detail: str) -> None:
        super().__init__(detail)
        self.status = status
        self.detail = detail
