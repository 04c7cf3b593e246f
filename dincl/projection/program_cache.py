"""Compiled programs, kept for the next time that the same rows are near."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

Program = TypeVar("Program")


class ProgramCache(Generic[Program]):
    """At most ``most`` programs by key; the least recently used one makes room."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._programs: OrderedDict[Hashable, Program] = OrderedDict()

    def get(self, key: Hashable, make: Callable[[], Program]) -> Program:
        """The program of this key, made if it is not there."""
        if key not in self._programs:
            self._programs[key] = make()
            if len(self._programs) > self._most:
                self._programs.popitem(last=False)
        self._programs.move_to_end(key)
        return self._programs[key]
