"""The errors of this package; ``trajectory.StepFailed`` is the one that carries a result."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dincl.status import Status


class InvalidProblem(ValueError):
    """Input that cannot be right; the message names the argument, its value and what is allowed."""


class ProjectionFailed(RuntimeError):
    """A single projection that found no point; ``status`` says why and what to try."""

    def __init__(self, status: Status, detail: str) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status


class StepFailure(RuntimeError):
    """Why a single step could not be made; a solver turns it into the Status of its result."""

    def __init__(self, status: Status, detail: str) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail
