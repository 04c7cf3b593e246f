"""Errors that compiled code and callbacks raise, where nobody can catch them: the one place that hooks into Python.

Numba and ctypes pass such an error to ``sys.unraisablehook``, which is one for all threads and prints it.
"""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock, get_ident
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing import Self

MAKES_NO_NUMBERS = True
_LOCK = Lock()
# By number of the thread: its listeners, the latest last, and of each whether it installed the hook.
_HERE: defaultdict[int, list[tuple[Listener, bool]]] = defaultdict(list)
# One entry for each listener of any thread that installed ours; the first one is the hook that was there before.
_HOOKS: list[Callable[[Any], object]] = []


class Listener(ABC):
    """A context that is offered each error of its thread that nobody can catch, before it is printed.

    Attributes
    ----------
    listens
        Whether there is anything to hear; the same at the end of the context as at its beginning.
    """

    listens = True

    @abstractmethod
    def hears(self, raised: Any) -> bool:
        """Keep an error, in the form of ``sys.unraisablehook``, and return True; False for one to be passed on."""

    def __enter__(self) -> Self:
        if self.listens:
            listeners = _HERE[get_ident()]
            installs = not listeners or sys.unraisablehook is not _offer
            listeners.append((self, installs))
            if installs:
                with _LOCK:
                    _HOOKS.append(sys.unraisablehook)
                    sys.unraisablehook = _offer
        return self

    def __exit__(self, *_: object) -> None:
        if self.listens and _HERE[get_ident()].pop()[1]:
            with _LOCK:
                earliest = _HOOKS[0]
                _HOOKS.pop()
                if not _HOOKS:
                    sys.unraisablehook = earliest


def _offer(raised: Any) -> None:
    """Offer an error to the listeners of this thread, the latest first, then to the hook that was there before."""
    if not any(listener.hears(raised) for listener, _ in reversed(_HERE.get(get_ident(), ()))):
        (_HOOKS[0] if _HOOKS else sys.__unraisablehook__)(raised)


class _OfCompiledCode(Listener):
    """A listener that keeps the first error of compiled code."""

    def __init__(self) -> None:
        self.errors: list[BaseException] = []

    def hears(self, raised: Any) -> bool:
        if not str(raised.object).startswith("<numba."):
            return False
        if not self.errors:
            self.errors.append(raised.exc_value)
        return True


@contextmanager
def heard() -> Iterator[list[BaseException]]:
    """Collect the first error that functions of ``c_function`` raise in this block and thread; else the list is empty.

    Such a function returns an arbitrary number when it raises.
    """
    with _OfCompiledCode() as listener:
        yield listener.errors
