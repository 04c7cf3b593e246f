"""The errors of this package."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from meanfield.status import Status


class InvalidModel(ValueError):
    """Input that cannot be right; the message names the argument, its value and what is allowed."""


class NotClosed(InvalidModel):
    """A reduction asked for that does not hold for this model; the message says what stands against it."""


class SolveFailed(RuntimeError):
    """A run that ended early: ``result`` holds what was computed until then, ``status`` why and what to try."""

    def __init__(self, status: Status, detail: str, result: Any) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail
        self.result = result


class Breakdown(RuntimeError):
    """Why a single step could not be made; a solver turns it into the Status of its result."""

    def __init__(self, status: Status, detail: str) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail
