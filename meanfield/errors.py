"""The errors that only this package has; bad input raises dincl's InvalidProblem."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from dincl.status import Status


class NotClosed(InvalidProblem):
    """A reduction asked for that does not hold for this model; the message says what stands against it."""


class SolveFailed(RuntimeError):
    """A run that ended early: ``result`` holds what was computed until then, ``status`` why and what to try."""

    def __init__(self, status: Status, detail: str, result: Any) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail
        self.result = result

    def __reduce__(self) -> tuple[Any, ...]:
        # As it is made: an exception is otherwise made anew from its message alone, which fails between processes.
        return type(self), (self.status, self.detail, self.result)
