"""Python functions that compiled code calls by their addresses; the drift of a problem as such a function."""

from __future__ import annotations

import ctypes
import math
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from dincl.compiled.calls import DRIFT, c_type
from dincl.compiled.uncaught import uncaught_errors
from dincl.drifts import compiled
from dincl.drifts.base import CountedDrift
from dincl.drifts.functions import NOT_A_NUMBER
from dincl.errors import StepFailure
from dincl.problem import DRIFT as USER_DRIFT
from dincl.status import Status
from dincl.system.arrays import PYTHON

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from numpy.typing import NDArray

    from dincl.problem import Problem

_FLOAT64 = np.dtype(np.float64)


def numbers_at(address: int, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return an array of the numbers at an address, not a copy."""
    buffer: Any = (ctypes.c_double * math.prod(shape)).from_address(address)
    return np.frombuffer(buffer, np.float64).reshape(shape)


class PythonFunction:
    """A function that compiled code calls with the arguments of a ``signature``; arrays come as addresses.

    Compiled code gets its number, 0 if it returns none, or PYTHON if it raised.

    Attributes
    ----------
    address
        Of the C function, as long as this object lives; 0 if compiled code has nothing to call.
    calls
        How many calls were made.
    """

    address = 0
    python: Callable[..., int] | None = None
    calls = 0
    _error: BaseException | None = None

    def __init__(self, function: Callable[..., int | None], signature: Any) -> None:
        self._function = function
        self._bind(self._call, signature)

    def _bind(self, python: Callable[..., int], signature: Any) -> None:
        """Make the C function of ``python``, which raises nothing."""
        self.python = python
        self._c_function = c_type(signature)(python)
        self.address = int(ctypes.cast(self._c_function, ctypes.c_void_p).value or 0)

    def _call(self, *arguments: Any) -> int:
        self.calls += 1
        try:
            return self._function(*arguments) or 0
        except BaseException as error:  # noqa: BLE001  # raised again by ``raise_error``; here it would be printed
            self.keep(error)
            return PYTHON

    def keep(self, error: BaseException) -> None:
        """Keep what the function raised for ``raise_error``."""
        self._error = error

    def raise_error(self) -> None:
        """Raise what the function raised, if anything."""
        error, self._error = self._error, None
        if error is not None:
            raise error


@contextmanager
def catching(functions: Iterable[PythonFunction | None]) -> Iterator[None]:
    """Surround calls of kernels that call ``functions``.

    An interrupt that arrives before the first line of a function is kept as an error of it; ctypes would print it.
    """
    by_python = [one for one in functions if one is not None and one.python is not None]
    if not by_python:
        yield
        return

    def take(raised: Any) -> bool:
        for one in by_python:
            if raised.object is one.python:
                one.keep(raised.exc_value)
                return True
        return False

    with uncaught_errors(take):
        yield


class DriftPointer(PythonFunction):
    """The drift F of a problem, compiled or in Python.

    Attributes
    ----------
    address, data
        Arguments of ``dincl.drifts.functions.velocity``, valid as long as this object lives.
    """

    def __init__(self, problem: Problem) -> None:
        self._drift, self._velocity, self._shape = problem.drift, problem.velocity, problem.x0.shape
        self._compiled = compiled(problem.drift)
        if self._compiled is not None:
            self.address, self.data = self._compiled.pointer()
        else:
            self._bind(_python_drift(problem.drift, self._shape, self.keep), DRIFT)
            self.data = np.zeros(1)

    def count_evaluations(self, number: int) -> None:
        """Tell the drift of so many more evaluations; one that counts may raise an exception to end the run."""
        if self._compiled is not None:
            self._compiled.count_evaluations(number)

    def note_call(self) -> None:
        """Tell a drift that counts of another call of Python; it may raise an exception to end the run."""
        if isinstance(self._drift, CountedDrift):
            self._drift.count_evaluations(0)

    def failure(self, t: float, x: NDArray[np.float64], out: NDArray[np.float64], code: int) -> NoReturn:
        """Raise as ``problem.velocity(t, x)`` does, when the kernel wrote ``out`` and returned ``code``."""
        self.raise_error()
        if code == NOT_A_NUMBER:
            USER_DRIFT.numbers(out.reshape(self._shape))
        self._velocity(t, x.reshape(self._shape))
        raise StepFailure(Status.DRIFT_FAILED, "drift failed in its compiled form alone.")


def _python_drift(drift: Any, shape: tuple[int, ...], keep: Callable[[BaseException], None]) -> Callable[..., int]:
    """Make F as a function of addresses.

    The drift gets a read-only copy of x, which it may store: a kernel writes over its own array, or frees it.
    """
    views: dict[int, NDArray[np.float64]] = {}  # by address: a run has few arrays

    def view(address: int) -> NDArray[np.float64]:
        if address not in views:
            views[address] = numbers_at(address, shape)
        return views[address]

    def function(t: float, place: int, out: int, n: int, d: int, data: int) -> int:
        try:
            x = view(place).copy()
            x.flags.writeable = False
            value = USER_DRIFT.call(drift, t, x)
            if type(value) is not np.ndarray or value.dtype is not _FLOAT64 or value.shape != shape:
                value = USER_DRIFT.numbers(value, shape)
            view(out)[...] = value
        except BaseException as error:  # noqa: BLE001  # raised again by ``failure``; here it would be printed
            keep(error)
            return PYTHON
        return 0

    return function
