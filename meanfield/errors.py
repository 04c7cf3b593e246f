"""Errors of this package alone; invalid input raises dincl's InvalidProblem."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from dincl.status import Status


class NotClosed(InvalidProblem):
    """Moment equations that do not close for the model; the message says why."""


class SolveFailed(RuntimeError):
    """A run that ended early.

    ``result`` holds the output times reached, ``status`` says why the run ended and what to try, ``detail`` where.
    """

    def __init__(self, status: Status, detail: str, result: Any) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail
        self.result = result

    def __reduce__(self) -> tuple[Any, ...]:
        # By default an exception is rebuilt from its message alone, which fails between processes.
        return type(self), (self.status, self.detail, self.result)
