"""What is said while machine code is made."""

import io
import re
import sys
from types import SimpleNamespace

import pytest

from dincl.compiled.announcement import Announcement


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def whole() -> None:
    """Stands for a function that is compiled."""


def part() -> None:
    """Stands for one of its parts."""


def event(function: object) -> SimpleNamespace:
    return SimpleNamespace(data={"dispatcher": SimpleNamespace(py_func=function)})


def lines(terminal: Terminal) -> list[str]:
    return re.sub(r"[\d.]+ s$", "SECONDS", terminal.getvalue(), flags=re.M).splitlines()


NAMED = [f"Compiling {__name__}.whole; its machine code is kept.", f"{__name__}.whole: SECONDS"]


def test_the_outermost_function_is_named_and_its_parts_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    announcement, terminal = Announcement(), Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    announcement.on_start(event(whole))
    for _ in range(2):
        announcement.on_start(event(part))
        announcement.on_end(event(part))
    announcement.on_end(event(whole))
    assert lines(terminal) == NAMED
    with announcement.of(part):
        pass  # it was kept: nothing is compiled
    with announcement.of(whole):
        announcement.on_start(event(part))
        announcement.on_end(event(part))
    assert lines(terminal) == NAMED * 2


def test_nothing_is_said_where_nobody_sits(monkeypatch: pytest.MonkeyPatch) -> None:
    made = io.StringIO()
    monkeypatch.setattr(sys, "stderr", made)
    with Announcement().of(whole):
        pass
    announcement = Announcement()
    announcement.on_start(event(whole))
    announcement.on_end(event(whole))
    assert made.getvalue() == ""
