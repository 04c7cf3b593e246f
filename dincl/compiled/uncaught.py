"""Errors that nobody can catch, of compiled code and callbacks: the one place that hooks into Python.

Numba and ctypes pass such an error to ``sys.unraisablehook``, which is one for all threads and prints it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock, get_ident
from typing import Any

# Gets an error in the form of ``sys.unraisablehook``; returns whether it took the error.
Taker = Callable[[Any], bool]
_LOCK = Lock()
# The takers of all threads, each with the number of its thread, and the hook before the first of them.
_TAKERS: list[tuple[int, Taker]] = []
_BEFORE: list[Callable[[Any], object]] = []


@contextmanager
def uncaught_errors(take: Taker) -> Iterator[None]:
    """Offer each error of this block and thread that nobody can catch to ``take``, before it is printed.

    An error that ``take`` refuses is offered to the block around this one, and at last to the hook before.
    """
    mine = get_ident(), take
    with _LOCK:
        if not _TAKERS:
            _BEFORE[:] = [sys.unraisablehook]
            sys.unraisablehook = _offer
        _TAKERS.append(mine)
    try:
        yield
    finally:
        with _LOCK:
            _TAKERS.remove(mine)
            if not _TAKERS:
                sys.unraisablehook = _BEFORE[0]


def _offer(raised: Any) -> None:
    """Offer an error to the takers of this thread, the latest first, then to the hook that was there before."""
    if not any(thread == get_ident() and take(raised) for thread, take in reversed(_TAKERS.copy())):
        _BEFORE[0](raised)


@contextmanager
def collect_errors() -> Iterator[list[BaseException]]:
    """Collect the first error that functions of ``c_function`` raise in this block and thread; else the list is empty.

    Such a function returns an arbitrary number when it raises.
    """
    errors: list[BaseException] = []

    def take(raised: Any) -> bool:
        if not str(raised.object).startswith("<numba."):
            return False
        if not errors:
            errors.append(raised.exc_value)
        return True

    with uncaught_errors(take):
        yield errors
