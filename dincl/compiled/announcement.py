"""What is compiled, and for how long, said to who sits at a terminal: a first run takes half a minute longer."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core.event import Listener, register

MAKES_NO_NUMBERS = True


class Announcement(Listener):
    """Names a function when its compilation begins, and says its time at the end; of its parts it says nothing."""

    def __init__(self) -> None:
        self._under_way: list[str] = []
        self._since, self._said = 0.0, False

    def on_start(self, event: Any) -> None:
        """Numba compiles a function."""
        self._begin(event.data["dispatcher"].py_func)
        if not self._said:
            _say(f"Compiling {self._under_way[0]}; its machine code is kept.")
            self._said = True

    def on_end(self, event: Any) -> None:
        """Numba has compiled it."""
        self._end()

    @contextmanager
    def of(self, function: Callable[..., Any]) -> Iterator[None]:
        """What is compiled meanwhile are parts of this function, of which itself numba says nothing."""
        self._begin(function)
        try:
            yield
        finally:
            self._end()

    def _begin(self, function: Callable[..., Any]) -> None:
        if not self._under_way:
            self._since, self._said = time.perf_counter(), False
        self._under_way.append(f"{function.__module__}.{function.__qualname__}")

    def _end(self) -> None:
        name = self._under_way.pop()
        if self._said and not self._under_way:
            _say(f"{name}: {time.perf_counter() - self._since:.1f} s")


def _say(text: str) -> None:
    if sys.stderr.isatty():
        print(text, file=sys.stderr, flush=True)


ANNOUNCEMENT = Announcement()
register("numba:compile", ANNOUNCEMENT)
