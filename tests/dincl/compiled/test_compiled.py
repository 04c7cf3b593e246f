"""Compiled functions, C functions by address, structs by address, and errors that nobody can catch.

Where a private part of numba is used, a test here holds what is expected of it.
"""

import ctypes
import sys
from functools import partial
from threading import Barrier, Thread
from types import SimpleNamespace
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba.core.datamodel import default_manager
from numba.core.errors import TypingError

from dincl.compiled import (
    DOUBLES,
    StructPointer,
    allocating,
    c_function,
    call,
    collect_errors,
    inner,
    kernel,
    reader,
    signature,
    struct_type,
)
from dincl.compiled.cache import is_ours
from dincl.compiled.calls import is_dispatcher
from dincl.compiled.functions import compiler_events
from dincl.compiled.structs import struct_after
from dincl.compiled.uncaught import uncaught_errors

lean = partial(kernel, references=False)


@inner
def power(x: float, n: int) -> float:
    """x^n."""
    result = 1.0
    for _ in range(n):
        result *= x
    return result


@allocating
def powers(x: float) -> np.ndarray:
    """1, x, x^2."""
    found = np.empty(3)
    for n in range(3):
        found[n] = power(x, n)
    return found


@kernel
def added_powers(x: float) -> float:
    """1 + x + x^2."""
    found = powers(x)
    return float(found[0] + found[1] + found[2])


def chosen(one, other, k):
    view = one if k > 0 else other
    return view[1:][0]


def quotient(a, b):
    return a / b


def test_an_inlined_function_is_machine_code_only_within_kernels_and_text_for_python():
    assert power(3, 2) == 9.0
    added_powers(3.0)
    added_powers.recompile()  # code from the cache would need no inlined functions
    assert added_powers(3.0) == 13.0
    for part in (power, powers):
        (compiled,) = part.overloads.values()
        assert compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name) == 0
    assert power(3, 2) == 9.0
    assert powers(2.0).tolist() == [1.0, 2.0, 4.0]


def test_references_are_counted_only_on_request():
    for one, counted in ((kernel(chosen), True), (lean(chosen), False)):
        assert one(np.arange(3.0), np.zeros(3), 1) == 1.0
        one.recompile()
        (text,) = one.inspect_llvm().values()
        assert ("NRT_incref" in text or "NRT_decref" in text) is counted


def test_what_numba_says_of_functions_and_compiling():
    assert kernel(quotient)(1.0, 0.0) == np.inf  # as in NumPy
    function = numba.njit(lambda x: x + 1)
    for expected in (True, False):
        with compiler_events() as found:
            function(1.0)
        assert bool(found) is expected
    assert is_dispatcher(function)
    assert not is_dispatcher(lambda x: x)


def test_what_takes_long_to_compile_is_named_once_and_what_does_not_is_not(monkeypatch, caplog):
    def named(x):
        return called(x) + other(x)

    called, other = numba.njit(lambda x: x + 1), numba.njit(lambda x: x + 2)
    called(1.0)
    assert not caplog.messages
    monkeypatch.setattr("dincl.compiled.cache.EACH", 2.0)
    numba.njit(named)(1.0)
    name = f"{__name__}.{named.__qualname__}"
    assert caplog.messages == [f"Compiling {name}, about 6 s, once: its machine code is cached."]


class Pair(NamedTuple):
    x: np.ndarray
    scale: float


PAIR = struct_type(Pair(np.zeros(1), 0.0))
MIXED = signature(float, float, int, DOUBLES, PAIR)
call_mixed, call_put, call_number = call(MIXED), call(signature(None, PAIR, int)), call(signature(int, int))


@partial(c_function, MIXED)
def mixed(a, n, numbers, pair):
    return a + 10.0 * n + 100.0 * numbers[1] + 1000.0 * pair.x[0] * pair.scale


@partial(c_function, signature(int, int))
def failing(n):
    if n > 0:
        raise ValueError("n")
    return n


@partial(c_function, signature(None, PAIR, int))
def put(pair, k):
    pair.x[k] = 1.0


@lean
def put_by(address, pair, k):
    call_put(address, pair, k)


@lean
def mixed_by(address, a, n, numbers, pair):
    return call_mixed(address, a, n, numbers, pair)


@kernel
def number_by(address, n):
    return call_number(address, n)


def test_numbers_arrays_and_structs_arrive():
    pair = StructPointer(Pair(np.array([4.0, 5.0]), 0.5))
    assert mixed_by(mixed.address, 1.5, 2, np.array([[0.0, 3.0]]), pair) == 1.5 + 20.0 + 300.0 + 2000.0
    assert mixed_by(mixed.address, 1.5, True, np.array([0.0, 3.0]), pair) == 1.5 + 10.0 + 300.0 + 2000.0
    function = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)(lambda n: n + 1)
    assert number_by(ctypes.cast(function, ctypes.c_void_p).value, 41) == 42


def test_an_index_beyond_an_array_is_an_error_in_functions_of_users_alone():
    pair = StructPointer(Pair(np.zeros(3), 0.5))
    for k, kinds in ((2, []), (3, [IndexError])):
        with collect_errors() as errors:
            put_by(put.address, pair, k)
        assert list(map(type, errors)) == kinds
    assert pair.value.x.tolist() == [0.0, 0.0, 1.0]
    function = type(mixed.__wrapped__)(mixed.__wrapped__.__code__, {}, "mixed")
    for module, checked in (("tissue.rules.slice", False), ("mine", True)):
        function.__module__ = module
        assert is_ours(function) is not checked


@pytest.mark.parametrize(
    ("place", "wrong"),
    [(0, 1), (1, 2.0), (2, np.zeros(2, np.float32)), (2, np.zeros(4)[::2]), (3, 5), (3, np.zeros(2))],
)
def test_other_arguments_are_refused_when_compiling(place, wrong):
    arguments = [1.0, 2, np.zeros(2), StructPointer(Pair(np.zeros(1), 0.0))]
    arguments[place] = wrong
    with pytest.raises(TypingError):
        mixed_by(0, *arguments)


class Inside(NamedTuple):
    partner: np.ndarray
    count: int


class Whole(NamedTuple):
    x: np.ndarray
    flags: np.ndarray
    weight: float
    pairs: Inside
    grid: np.ndarray
    number: int


def whole(n: int = 4) -> Whole:
    inside = Inside(np.arange(n), 7)
    return Whole(np.arange(float(n)), np.ones(n, np.bool_), 0.25, inside, np.arange(6.0).reshape(2, 3), -3)


WHOLE, whole_at = struct_type(whole()), reader(whole())


@inner
def total(one):
    """A sum over all fields."""
    result = one.weight + one.number + one.pairs.count
    for k in range(len(one.x)):
        result += one.x[k] * one.flags[k] + 100.0 * one.pairs.partner[k]
    for i in range(one.grid.shape[0]):
        for k in range(one.grid.shape[1]):
            result += 1000.0 * one.grid[i, k]
    return result


@lean
def of_pointer(one):
    return total(one)


@lean
def of_address(address):
    return total(whole_at(address))


@lean
def of_second(one):
    return total(struct_after(one, 1))


@lean
def doubled(one):
    for k in range(len(one.x)):
        one.x[k] *= 2.0


EXPECTED = 0.25 - 3 + 7 + 6 + 600 + 15_000


def test_the_layout_of_arrays_is_that_of_numba():
    """Written are: who counts references, who owns it, entries, bytes of one, address, shape, steps in bytes."""
    model = default_manager.lookup(numba.typeof(np.zeros((2, 3))))
    assert model._fields == ("meminfo", "parent", "nitems", "itemsize", "data", "shape", "strides")
    context = numba.core.registry.cpu_target.target_context
    assert context.get_abi_sizeof(context.get_value_type(numba.typeof(np.zeros((2, 3))))) == 8 * (5 + 2 + 2)


def test_fields_are_read_and_written_where_they_are_and_may_be_replaced():
    several = StructPointer((whole(), whole()._replace(number=4)), WHOLE)
    assert (of_pointer(several), of_second(several)) == (EXPECTED, EXPECTED + 7)
    pointer = StructPointer(whole())
    address = pointer.address
    assert of_pointer(pointer) == of_address(address) == EXPECTED
    doubled(pointer)
    assert pointer.value.x.tolist() == [0.0, 2.0, 4.0, 6.0]
    pointer.replace({"pairs.partner": np.arange(10, 20), "x": np.ones(2)})
    assert pointer.address == address
    assert of_pointer(pointer) == EXPECTED - 6 - 600 + 2 + 100 * (10 + 11)
    pointer.replace({"pairs": Inside(np.zeros(2, np.int64), 8)})
    assert of_pointer(pointer) == EXPECTED - 6 - 600 + 2 + 1


@pytest.mark.parametrize(
    ("path", "array"),
    [("x", np.zeros(3, np.int64)), ("grid", np.zeros(3)), ("number", np.zeros(1)), ("pairs", Inside(np.zeros(2), 8))],
)
def test_an_array_of_another_type_is_refused(path, array):
    pointer = StructPointer(whole())
    with pytest.raises(TypeError, match=path):
        pointer.replace({path: array})
    assert of_pointer(pointer) == EXPECTED


def test_arrays_and_numbers_that_a_struct_cannot_have_are_refused():
    fixed = np.zeros(3)
    fixed.flags.writeable = False
    for array in (fixed, np.zeros(6)[::2]):
        with pytest.raises((TypeError, BufferError, ValueError)):
            StructPointer(Inside(array, 1))
    with pytest.raises(TypeError, match="count is bool"):
        struct_type(Inside(np.zeros(1), True))


OF_NUMBA = "<numba.core.cpu.CPUContext object at 0x1>"


def raised(by, error):
    return SimpleNamespace(object=by, exc_value=error, exc_type=type(error), exc_traceback=None, err_msg=None)


def test_each_error_goes_to_the_first_block_that_takes_it(monkeypatch, capfd):
    passed, errors, taken = [], [ValueError(k) for k in range(4)], []
    monkeypatch.setattr(sys, "unraisablehook", lambda one: passed.append(one.exc_value))
    hook = sys.unraisablehook

    def taking(one):
        return one.object == "mine" and not taken.append(one.exc_value)

    with uncaught_errors(taking), collect_errors() as found:
        for by, error in zip((OF_NUMBA, OF_NUMBA, "mine", "a file"), errors, strict=True):
            sys.unraisablehook(raised(by, error))
        with collect_errors() as inside:
            number_by(failing.address, 0)
            number_by(failing.address, 1)
    assert sys.unraisablehook is hook
    assert (found, taken, passed) == ([errors[0]], [errors[2]], [errors[3]])
    assert [repr(error) for error in inside] == ["ValueError('n')"]
    assert capfd.readouterr().err == ""


def test_threads_get_their_own_errors(monkeypatch):
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
    assert sys.unraisablehook is hook
