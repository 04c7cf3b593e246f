"""Errors that nobody can catch, of compiled code and callbacks: the one place that hooks into Python.

Numba and ctypes pass such an error to ``sys.unraisablehook``, which is one for all threads and prints it.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock, get_ident
from typing import Any

MAKES_NO_NUMBERS = True
# Gets an error in the form of ``sys.unraisablehook``; returns whether it took the error.
Taker = Callable[[Any], bool]
_LOCK = Lock()
# By number of the thread: its takers, the latest last.
_TAKERS: defaultdict[int, list[Taker]] = defaultdict(list)
# One entry for each block of any thread that installed our hook; the first one is the hook that was there before.
_HOOKS: list[Callable[[Any], object]] = []


@contextmanager
def uncaught_errors(take: Taker) -> Iterator[None]:
    """Offer each error of this block and thread that nobody can catch to ``take``, before it is printed.

    An error that ``take`` refuses is offered to the block around this one, and at last to the hook before.
    """
    takers = _TAKERS[get_ident()]
    installs = not takers or sys.unraisablehook is not _offer
    takers.append(take)
    if installs:
        with _LOCK:
            _HOOKS.append(sys.unraisablehook)
            sys.unraisablehook = _offer
    try:
        yield
    finally:
        takers.pop()
        if installs:
            with _LOCK:
                earliest = _HOOKS[0]
                _HOOKS.pop()
                if not _HOOKS:
                    sys.unraisablehook = earliest


def _offer(raised: Any) -> None:
    """Offer an error to the takers of this thread, the latest first, then to the hook that was there before."""
    if not any(take(raised) for take in reversed(_TAKERS.get(get_ident(), ()))):
        (_HOOKS[0] if _HOOKS else sys.__unraisablehook__)(raised)


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
