"""The errors of this package; ``trajectory.StepFailed`` is the one that carries a result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dincl.status import Status


class InvalidProblem(ValueError):
    """Input that cannot be right; the message names the argument, its value and what is allowed."""


class ProjectionFailed(RuntimeError):
    """A single projection that found no point; ``status`` says why and what to try."""

    def __init__(self, status: Status, detail: str) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail

    def __reduce__(self) -> tuple[Any, ...]:
        # As it is made: an error is otherwise made anew from its message alone, which fails between processes.
        return type(self), (self.status, self.detail)


class StepFailure(RuntimeError):
    """Why a single step could not be made; a solver turns it into the Status of its result."""

    def __init__(self, status: Status, detail: str) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.status, self.detail)


class FunctionFailed(StepFailure, InvalidProblem):
    """A function of the user that raised, or returned what it must not; ``detail`` names it and its arguments.

    What it raised is the ``__cause__``. In a run it is a StepFailure, so that what was computed is kept, with its
    ``status``; everywhere else it is an argument that cannot be right.
    """
