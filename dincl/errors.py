"""The errors of this package; ``trajectory.StepFailed`` is the one that carries a result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dincl.status import Status


class InvalidProblem(ValueError):
    """Input that cannot be right; the message names the argument, its value and what is allowed."""


class _Failure(RuntimeError):
    """An error with a ``status``, which says what to try, and its ``detail``."""

    def __init__(self, status: Status, detail: str) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail

    def __reduce__(self) -> tuple[Any, ...]:
        # Errors are otherwise copied from their message alone, which fails between processes.
        return type(self), (self.status, self.detail)


class ProjectionFailed(_Failure):
    """A single projection that found no point."""


class StepFailure(_Failure):
    """A single step that could not be made; a solver turns it into the Status of its result."""


class FunctionFailed(StepFailure, InvalidProblem):
    """A function of the user that raised, or returned a wrong value; ``detail`` names it and its arguments.

    The error that it raised is the ``__cause__``. In a run it is a StepFailure, so that the results until then are
    kept; everywhere else it is an invalid argument.
    """
