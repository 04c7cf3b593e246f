"""Switches and events of numba's compiler that are not its public ones do what kernels and their parts need."""

import io
import re
import sys
from types import SimpleNamespace

import numba
import numpy as np
import pytest
from numba.core.event import install_recorder

from dincl.compiled import allocating, inner, kernel
from dincl.compiled.calls import is_dispatcher, processor_name
from dincl.compiled.functions import CompilerMessages, compile_now, compile_reordered, compiler_events


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


@inner
def inverse(b):
    return 1.0 / b


def quotient(a, b):
    return inverse(b) * a


def chosen(one, other, k):
    view = one if k > 0 else other
    return view[1:][0]


def added(x):
    result = 0.0
    for k in range(len(x)):
        result += x[k]
    return result


def both(x):
    return x + 1.0, x - 1.0


def test_an_inlined_function_is_machine_code_only_within_kernels():
    added_powers(3.0)
    added_powers.recompile()  # code from the cache would need no inlined functions
    assert added_powers(3.0) == 13.0
    for part in (power, powers):
        (compiled,) = part.overloads.values()
        assert compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name) == 0
    (compiled,) = added_powers.overloads.values()
    assert compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name) != 0


def test_python_runs_the_text_of_an_inlined_function_compiled_or_not():
    assert power(3, 2) == 9.0
    added_powers(1.0)
    assert power(3, 2) == 9.0
    assert powers(2.0).tolist() == [1.0, 2.0, 4.0]


def test_references_are_counted_only_on_request():
    texts = []
    for one in (kernel(chosen), kernel(chosen, references=False)):
        assert one(np.arange(3.0), np.zeros(3), 1) == 1.0
        one.recompile()
        (text,) = one.inspect_llvm().values()
        texts.append(text)
    assert "NRT_incref" in texts[0] or "NRT_decref" in texts[0]
    assert "NRT_incref" not in texts[1]
    assert "NRT_decref" not in texts[1]


def test_division_by_zero_gives_inf_as_in_numpy():
    assert kernel(quotient)(1.0, 0.0) == np.inf


def test_sums_are_reordered_in_generated_loops_alone():
    x = np.random.default_rng(3).normal(size=4096)
    loop, exact = compile_reordered(added), kernel(added)
    assert loop(x) != exact(x)
    assert abs(loop(x) - exact(x)) < 1e-11
    assert compile_now((float, float), float)(both)(3.0) == (4.0, 2.0)


def test_compiling_and_loading_is_recorded():
    function = numba.njit(lambda x: x + 1)
    with compiler_events() as first:
        function(1.0)
    with compiler_events() as second:
        function(2.0)
    assert first
    assert not second


def test_functions_of_numba_and_the_processor_are_known():
    assert is_dispatcher(numba.njit(lambda x: x))
    assert not is_dispatcher(lambda x: x)
    assert processor_name()


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def event(function: object) -> SimpleNamespace:
    return SimpleNamespace(data={"dispatcher": SimpleNamespace(py_func=function)})


MESSAGES = [f"Compiling {__name__}.quotient; its machine code is cached.", f"{__name__}.quotient: SECONDS"]


def test_compiling_is_an_event_that_names_the_function():
    def named(x):
        return x + 1

    with install_recorder("numba:compile") as found:
        numba.njit(named)(1.0)
    assert found.buffer[0][1].data["dispatcher"].py_func is named


def test_the_outermost_function_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    messages, terminal = CompilerMessages(), Terminal()

    def lines():
        return re.sub(r"[\d.]+ s$", "SECONDS", terminal.getvalue(), flags=re.M).splitlines()

    monkeypatch.setattr(sys, "stderr", terminal)
    messages.on_start(event(quotient))
    for _ in range(2):
        messages.on_start(event(added))
        messages.on_end(event(added))
    messages.on_end(event(quotient))
    assert lines() == MESSAGES
    with messages.naming(added):
        pass  # its code is in the cache: nothing is compiled
    with messages.naming(quotient):
        messages.on_start(event(added))
        messages.on_end(event(added))
    assert lines() == MESSAGES * 2


def test_no_message_without_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    text, messages = io.StringIO(), CompilerMessages()
    monkeypatch.setattr(sys, "stderr", text)
    with messages.naming(quotient):
        messages.on_start(event(added))
        messages.on_end(event(added))
    assert text.getvalue() == ""
