"""A function of Python that compiled code calls, and an interrupt that comes while it is called."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

from dincl.compiled.raised import Listener


class Callback(Listener):
    """A context that keeps an interrupt from before the first line of ``python``, which ctypes would print."""

    python: Any = None

    @property
    def listens(self) -> bool:  # type: ignore[override]
        return self.python is not None

    @abstractmethod
    def keep(self, error: BaseException) -> None:
        """Keep what was raised, until it is raised again."""

    def hears(self, raised: Any) -> bool:
        if raised.object is not self.python:
            return False
        self.keep(raised.exc_value)
        return True
