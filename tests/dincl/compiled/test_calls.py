"""Kernels call C functions by address, with numbers, arrays and structs, and refuse what would be read wrongly."""

import ctypes
from functools import partial
from typing import NamedTuple

import numpy as np
import pytest
from numba.core.errors import TypingError

from dincl.compiled import DOUBLES, StructPointer, c_function, call, collect_errors, kernel, signature, struct_type
from dincl.compiled.functions import _of_user


class Pair(NamedTuple):
    x: np.ndarray
    scale: float


PAIR = struct_type(Pair(np.zeros(1), 0.0))
MIXED = signature(float, float, int, DOUBLES, PAIR)
FILL = signature(None, PAIR, float)
call_mixed, call_fill = call(MIXED), call(FILL)


@partial(c_function, MIXED)
def mixed(a, n, numbers, pair):
    return a + 10.0 * n + 100.0 * numbers[1] + 1000.0 * pair.x[0] * pair.scale


@partial(c_function, FILL)
def fill(pair, value):
    for k in range(len(pair.x)):
        pair.x[k] = value


@partial(c_function, signature(int, int))
def failing(n):
    if n > 0:
        raise ValueError("n")
    return n


@partial(c_function, signature(None, PAIR, int))
def beyond(pair, k):
    pair.x[k] = 1.0


call_beyond = call(signature(None, PAIR, int))


@partial(kernel, references=False)
def gone_beyond(address, pair, k):
    call_beyond(address, pair, k)


@partial(kernel, references=False)
def asked(address, a, n, numbers, pair):
    return call_mixed(address, a, n, numbers, pair)


@partial(kernel, references=False)
def filled(address, pair, value):
    call_fill(address, pair, value)


def test_numbers_arrays_and_structs_arrive():
    pair = StructPointer(Pair(np.array([4.0, 5.0]), 0.5))
    assert asked(mixed.address, 1.5, 2, np.array([[0.0, 3.0]]), pair) == 1.5 + 20.0 + 300.0 + 2000.0
    assert asked(mixed.address, 1.5, True, np.array([0.0, 3.0]), pair) == 1.5 + 10.0 + 300.0 + 2000.0


def test_an_index_beyond_an_array_is_an_error_in_functions_of_users():
    pair = StructPointer(Pair(np.zeros(3), 0.5))
    for k, kinds in ((2, []), (3, [IndexError])):
        with collect_errors() as errors:
            gone_beyond(beyond.address, pair, k)
        assert list(map(type, errors)) == kinds
    assert pair.value.x.tolist() == [0.0, 0.0, 1.0]


def test_our_own_functions_are_not_checked():
    """Checks would make steps longer."""
    function = type(mixed.__wrapped__)(mixed.__wrapped__.__code__, {}, "mixed")
    for module, checked in (("tissue.rules.slice", False), ("mine", True)):
        function.__module__ = module
        assert _of_user(function) is checked


def test_a_function_without_a_result():
    pair = StructPointer(Pair(np.zeros(3), 0.5))
    assert filled(fill.address, pair, 7.0) is None
    assert pair.value.x.tolist() == [7.0] * 3


@pytest.mark.parametrize(
    ("place", "wrong"),
    [(0, 1), (1, 2.0), (2, np.zeros(2, np.float32)), (2, np.zeros(4)[::2]), (3, 5), (3, np.zeros(2))],
)
def test_other_arguments_are_refused_when_compiling(place, wrong):
    arguments = [1.0, 2, np.zeros(2), StructPointer(Pair(np.zeros(1), 0.0))]
    arguments[place] = wrong
    with pytest.raises(TypingError):
        asked(0, *arguments)


def test_any_c_function_can_be_called():
    function = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(lambda n: n + 1)
    number = kernel(through)(ctypes.cast(function, ctypes.c_void_p).value, 41)
    assert number == 42


call_number = call(signature(int, int))


def through(address, n):
    return call_number(address, n)


def test_what_is_raised_is_heard(capfd):
    ask = kernel(through)
    with collect_errors() as errors:
        ask(failing.address, 0)
    assert errors == []
    with collect_errors() as errors:
        ask(failing.address, 1)
        ask(failing.address, 2)
    assert [repr(error) for error in errors] == ["ValueError('n')"]
    assert capfd.readouterr().err == ""
