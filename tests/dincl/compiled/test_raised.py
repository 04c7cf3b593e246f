"""Errors that nobody can catch reach the listeners of their thread, and else the hook that was there before."""

import sys
from threading import Barrier, Thread
from types import SimpleNamespace

import pytest

from dincl.compiled.raised import Listener, heard


def raised(by: object, error: BaseException) -> SimpleNamespace:
    return SimpleNamespace(object=by, exc_value=error, exc_type=type(error), exc_traceback=None, err_msg=None)


OF_NUMBA = "<numba.core.cpu.CPUContext object at 0x1>"


class Named(Listener):
    """A listener for the errors of one object."""

    def __init__(self, name: str) -> None:
        self.name, self.found = name, []

    def hears(self, one: object) -> bool:
        if one.object != self.name:
            return False
        self.found.append(one.exc_value)
        return True


@pytest.fixture
def passed(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """What comes to the hook that was there before."""
    found: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda one: found.append(one.exc_value))
    return found


def test_the_first_error_of_compiled_code_is_kept(passed: list[object]) -> None:
    hook, errors = sys.unraisablehook, [ValueError(k) for k in range(4)]
    with heard() as found:
        sys.unraisablehook(raised(OF_NUMBA, errors[0]))
        sys.unraisablehook(raised(OF_NUMBA, errors[1]))
        sys.unraisablehook(raised("a file", errors[2]))
        with heard() as inside:
            sys.unraisablehook(raised(OF_NUMBA, errors[3]))
    assert (found, inside, passed) == ([errors[0]], [errors[3]], [errors[2]])
    assert sys.unraisablehook is hook


def test_each_listener_gets_its_own(passed: list[object]) -> None:
    errors = [ValueError(k) for k in range(3)]
    with Named("one") as one, Named("two") as two, heard() as found:
        for name, error in zip(("two", "one", "three"), errors, strict=True):
            sys.unraisablehook(raised(name, error))
    assert (one.found, two.found, found, passed) == ([errors[1]], [errors[0]], [], [errors[2]])


def test_threads_do_not_hear_each_other(passed: list[object]) -> None:
    hook, together, found = sys.unraisablehook, Barrier(2, timeout=10), {}

    def listen(name: str) -> None:
        with heard() as errors:
            together.wait()
            sys.unraisablehook(raised(OF_NUMBA, ValueError(name)))
            together.wait()
            found[name] = [str(error) for error in errors]

    threads = [Thread(target=listen, args=(name,)) for name in "ab"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {"a": ["a"], "b": ["b"]}
    assert passed == []
    assert sys.unraisablehook is hook


def test_the_hook_comes_back_after_an_error(passed: list[object]) -> None:
    hook = sys.unraisablehook
    with pytest.raises(KeyError), heard():
        raise KeyError
    assert sys.unraisablehook is hook
