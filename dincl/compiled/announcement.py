"""Events of numba's compiler: a message at a terminal, where a first run takes half a minute longer, and a record."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core.event import Listener, install_recorder, register

MAKES_NO_NUMBERS = True


class Announcement(Listener):
    """A message with the name of a function when its compilation begins, and with its time at the end.

    Nothing is written of its parts.
    """

    def __init__(self) -> None:
        self._under_way: list[str] = []
        self._since, self._said = 0.0, False

    def on_start(self, event: Any) -> None:
        """Note the function that numba begins to compile."""
        self._begin(event.data["dispatcher"].py_func)
        if not self._said:
            _say(f"Compiling {self._under_way[0]}; its machine code is kept.")
            self._said = True

    def on_end(self, event: Any) -> None:
        """Note that it is compiled."""
        self._end()

    @contextmanager
    def of(self, function: Callable[..., Any]) -> Iterator[None]:
        """Name this function for all that is compiled in the block: numba reports its parts, but not itself."""
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


@contextmanager
def compiler_events() -> Iterator[list[Any]]:
    """Make a list that is empty after the block if nothing in it was compiled or loaded from the disk.

    Numba holds a lock for either, and calls of code that is there do not take it.
    """
    with install_recorder("numba:compiler_lock") as found:
        yield found.buffer
