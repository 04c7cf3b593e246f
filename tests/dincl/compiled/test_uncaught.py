"""Errors that nobody can catch are offered in their thread, and else go to the hook that was there before."""

import sys
from threading import Barrier, Thread
from types import SimpleNamespace

import pytest

from dincl.compiled.uncaught import collect_errors, uncaught_errors


def raised(by: object, error: BaseException) -> SimpleNamespace:
    return SimpleNamespace(object=by, exc_value=error, exc_type=type(error), exc_traceback=None, err_msg=None)


OF_NUMBA = "<numba.core.cpu.CPUContext object at 0x1>"


@pytest.fixture
def passed(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """What comes to the hook that was there before."""
    found: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda one: found.append(one.exc_value))
    return found


def test_the_first_error_of_compiled_code_is_collected(passed: list[object]) -> None:
    hook, errors = sys.unraisablehook, [ValueError(k) for k in range(4)]
    with collect_errors() as found:
        sys.unraisablehook(raised(OF_NUMBA, errors[0]))
        sys.unraisablehook(raised(OF_NUMBA, errors[1]))
        sys.unraisablehook(raised("a file", errors[2]))
        with collect_errors() as inside:
            sys.unraisablehook(raised(OF_NUMBA, errors[3]))
    assert (found, inside, passed) == ([errors[0]], [errors[3]], [errors[2]])
    assert sys.unraisablehook is hook


def test_an_error_that_is_refused_goes_to_the_block_around(passed: list[object]) -> None:
    errors, taken = [ValueError(k) for k in range(3)], []

    def taking(name):
        return lambda one: one.object == name and not taken.append((name, one.exc_value))

    with uncaught_errors(taking("one")), uncaught_errors(taking("two")), collect_errors() as found:
        for name, error in zip(("two", "one", "three"), errors, strict=True):
            sys.unraisablehook(raised(name, error))
    assert (taken, found, passed) == ([("two", errors[0]), ("one", errors[1])], [], [errors[2]])


def test_threads_get_their_own_errors(passed: list[object]) -> None:
    hook, together, found = sys.unraisablehook, Barrier(2, timeout=10), {}

    def listen(name: str) -> None:
        with collect_errors() as errors:
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
    with pytest.raises(KeyError), collect_errors():
        raise KeyError
    assert sys.unraisablehook is hook
