"""Switches and events of numba's compiler that are not its public ones do what the kernels need."""

import numba
import numpy as np
from numba.core.event import install_recorder

from dincl.compiled import inner, kernel
from dincl.compiled.announcement import compiler_events
from dincl.compiled.dispatchers import is_dispatcher, processor_name
from dincl.compiled.functions import compile_now, compile_reordered


def chosen(one, other, k):
    view = one if k > 0 else other
    return view[1:][0]


def text(function):
    (found,) = function.inspect_llvm().values()
    return found


def test_references_are_counted_only_where_wanted():
    counting, silent = kernel(chosen), kernel(chosen, references=False)
    for one in (counting, silent):
        assert one(np.arange(3.0), np.zeros(3), 1) == 1.0
        one.recompile()
    assert "NRT_incref" in text(counting) or "NRT_decref" in text(counting)
    assert "NRT_incref" not in text(silent)
    assert "NRT_decref" not in text(silent)


def test_division_by_zero_is_that_of_numpy():
    assert kernel(quotient)(1.0, 0.0) == np.inf


def quotient(a, b):
    return inverse(b) * a


@inner
def inverse(b):
    return 1.0 / b


def test_compiling_and_loading_is_recorded():
    function = numba.njit(lambda x: x + 1)
    with compiler_events() as first:
        function(1.0)
    with compiler_events() as second:
        function(2.0)
    assert first
    assert not second


def test_compiling_is_an_event_that_names_the_function():
    def named(x):
        return x + 1

    with install_recorder("numba:compile") as found:
        numba.njit(named)(1.0)
    assert found.buffer[0][1].data["dispatcher"].py_func is named


def test_functions_of_numba_are_known():
    assert is_dispatcher(numba.njit(lambda x: x))
    assert not is_dispatcher(lambda x: x)


def test_the_processor_has_a_name():
    assert processor_name()


def test_sums_are_reordered_in_generated_loops_alone():
    def total(x):
        result = 0.0
        for k in range(len(x)):
            result += x[k]
        return result

    x = np.random.default_rng(3).normal(size=4096)
    loop, exact = compile_reordered(total), kernel(added)
    assert loop(x) != exact(x)
    assert abs(loop(x) - exact(x)) < 1e-11
    assert compile_now((float, float), float)(both)(3.0) == (4.0, 2.0)


def added(x):
    result = 0.0
    for k in range(len(x)):
        result += x[k]
    return result


def both(x):
    return x + 1.0, x - 1.0
