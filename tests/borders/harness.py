"""Generated calls of public functions, and what may come of them; a call is made again from its seed and number.

A file of calls lists functions, and values that are right by the names of arguments; the generator takes the arguments
from the signatures, and mixes right values with absurd ones. Allowed are answers without a NaN, and the errors that are
documented. Nothing else may be raised, no warning given, and no call may last.
"""

import dataclasses
import inspect
import signal
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import contextmanager
from copy import deepcopy
from typing import Any, NamedTuple

import numpy as np

from dincl.checks import describe
from tests.borders.values import ABSURD, FUNCTIONS

# A call that lasts longer [s] hangs: right ones end within a fraction of a second, but the first may compile.
PATIENCE = 60.0
# Of the arguments, these parts get a right value; of those that may be left out, are.
RIGHT, LEFT_OUT = (0.4, 0.7, 0.9), 0.5
# Depth to which an answer is searched for a NaN.
DEPTH = 4


class Call(NamedTuple):
    """A function with right values for its arguments by name; those in ``optional`` may be left out."""

    name: str
    function: Callable[..., Any]
    arguments: Mapping[str, Sequence[Any]]
    optional: frozenset[str]


def calls(pool: Mapping[str, Sequence[Any]], *functions: Any) -> list[Call]:
    """Return the calls of functions, each alone or with right values of its own, which go before those of the pool.

    An argument with a default may be left out, and is where there are no values for it.
    """
    found = []
    for one in functions:
        function, own = one if isinstance(one, tuple) else (one, {})
        shape, values = inspect.signature(function).parameters, pool | own
        optional = frozenset(name for name, argument in shape.items() if argument.default is not argument.empty)
        arguments = {name: values[name] for name in shape if name in values or name not in optional}
        name = getattr(function, "__qualname__", None) or getattr(function, "func", function).__class__.__name__
        found.append(Call(name, function, arguments, optional))
    return found


class Made(NamedTuple):
    """One generated call."""

    call: Call
    arguments: dict[str, Any]
    seed: int
    number: int

    def __str__(self) -> str:
        given = ", ".join(f"{name} = {described(value)}" for name, value in self.arguments.items())
        return f"{self.call.name}({given})  [seed {self.seed}, number {self.number}]"


class TooLong(BaseException):
    """A call that does not end."""


def described(value: Any) -> str:
    """A value, and which function of the pool it is."""
    found = next((k for k, function in enumerate(FUNCTIONS) if function is value), None)
    return describe(value) if found is None else f"FUNCTIONS[{found}]"


def generated(calls: Sequence[Call], seed: int, number: int) -> Made:
    """One call: every function comes as often as any other."""
    rng = np.random.default_rng((seed, number))
    call, right = calls[number % len(calls)], RIGHT[rng.integers(len(RIGHT))]
    chosen = {}
    for name, values in call.arguments.items():
        if name in call.optional and rng.random() < LEFT_OUT:
            continue
        pool = values if rng.random() < right else FUNCTIONS if callable(values[0]) and rng.random() < 0.7 else ABSURD
        value = pool[rng.integers(len(pool))]
        # Each call gets a random generator as it was at first, so that none depends on those before it.
        chosen[name] = deepcopy(value) if isinstance(value, np.random.Generator) else value
    return Made(call, chosen, seed, number)


def complaint(made: Made, allowed: tuple[type[Exception], ...]) -> str:
    """What is wrong with how a call ended; nothing if it is ``allowed``."""
    with warnings.catch_warnings(record=True) as heard, np.errstate(all="warn", under="ignore"):
        warnings.simplefilter("always")
        # Of how a library is written, which is said when it is first compiled.
        warnings.filterwarnings("ignore", "invalid escape sequence")
        try:
            with limited():
                answer = made.call.function(**made.arguments)
            found = "NaN in the answer" if holds_nan(answer) else ""
        except allowed as error:
            found = "" if str(error) else f"{type(error).__name__} without a message"
        except TooLong:
            found = "does not end"
        except Exception as error:  # noqa: BLE001  # that is what is looked for
            found = type(error).__name__
    return found or (f"warning {heard[0].category.__name__}: {heard[0].message}" if heard else "")


def complaints(calls: Sequence[Call], allowed: tuple[type[Exception], ...], seed: int, count: int) -> list[str]:
    """All complaints of ``count`` generated calls, each with the call that it is about."""
    found = []
    for number in range(count):
        made = generated(calls, seed, number)
        wrong = complaint(made, allowed)
        if wrong:
            found.append(f"{wrong}: {made}")
    return found


@contextmanager
def limited():
    """Raise TooLong if what is inside lasts; only in the main thread, which is where tests run."""

    def end(*_):
        raise TooLong

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def holds_nan(value: Any, depth: int = DEPTH) -> bool:
    """Whether there is a NaN in a number, an array, or in what a list, a mapping or a dataclass holds."""
    if isinstance(value, (float, np.floating, np.ndarray)):
        numbers = np.asarray(value)
        return numbers.dtype.kind == "f" and bool(np.isnan(numbers).any())
    if depth == 0:
        return False
    if isinstance(value, Mapping):
        inside = list(value.values())
    elif isinstance(value, (list, tuple)):
        inside = list(value)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        inside = [getattr(value, field.name) for field in dataclasses.fields(value)]
    else:
        return False
    return any(holds_nan(part, depth - 1) for part in inside)
