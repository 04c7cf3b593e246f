"""A function of Python that compiled code calls, and an interrupt that comes while it is called."""

from __future__ import annotations

import sys
import threading
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing import Self


class Callback(ABC):
    """A context that keeps an interrupt from before the first line of ``python``, which ctypes would print.

    Only the main thread is interrupted. Others leave ``sys.unraisablehook``, which is one for all threads, as it is.
    """

    python: Any = None

    @abstractmethod
    def keep(self, error: BaseException) -> None:
        """Keep what was raised, until it is raised again."""

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._before = sys.unraisablehook
            sys.unraisablehook = self._before if self.python is None else self._unraisable
        return self

    def __exit__(self, *_: object) -> None:
        if threading.current_thread() is threading.main_thread():
            sys.unraisablehook = self._before

    def _unraisable(self, found: Any) -> None:
        if found.object is self.python:
            self.keep(found.exc_value)
        else:
            self._before(found)
