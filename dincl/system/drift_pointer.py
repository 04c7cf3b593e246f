"""The drift of a problem as a C function: what a compiled run calls."""

from __future__ import annotations

import ctypes
import sys
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from dincl.drifts import compiled
from dincl.drifts.functions import NOT_A_NUMBER
from dincl.errors import StepFailure
from dincl.problem import DRIFT
from dincl.status import Status
from dincl.system.python_function import C_FUNCTION, PLACE, Callback, numbers_at

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.problem import Problem

_FLOAT64 = np.dtype(np.float64)


class DriftPointer(Callback):
    """The address of F as a C function, and what goes with it; a context in which kernels may call it.

    Attributes
    ----------
    address, data
        What ``dincl.drifts.compiled.velocity`` takes. They are good as long as this object lives.
    """

    def __init__(self, problem: Problem) -> None:
        self._velocity, self._shape = problem.velocity, problem.x0.shape
        self._compiled = compiled(problem.drift)
        self._error: BaseException | None = None
        if self._compiled is not None:
            self.address, self.data = self._compiled.pointer()
        else:
            self.python = _python_function(problem.drift, self._shape, self.keep)
            self._callback = C_FUNCTION(self.python)
            self.address, self.data = int(ctypes.cast(self._callback, PLACE).value or 0), np.zeros(1)

    def count_evaluations(self, number: int) -> None:
        """Tell the drift of so many more evaluations; one that counts may raise an exception to end the run."""
        if self._compiled is not None:
            self._compiled.count_evaluations(number)

    def failure(self, t: float, x: NDArray[np.float64], out: NDArray[np.float64], code: int) -> NoReturn:
        """Raise as ``problem.velocity(t, x)`` does, when the kernel wrote ``out`` and returned ``code``."""
        error, self._error = self._error, None
        if error is not None:
            raise error
        if code == NOT_A_NUMBER:
            DRIFT.numbers(out.reshape(self._shape))
        self._velocity(t, x.reshape(self._shape))
        raise StepFailure(Status.DRIFT_FAILED, "drift failed in its compiled form alone.")

    def keep(self, error: BaseException) -> None:
        self._error = error


def _python_function(drift: Any, shape: tuple[int, ...], keep: Callable[[BaseException], None]) -> Callable[..., int]:
    """F as a function of addresses.

    The drift is given a read-only copy of x, which it may keep: a kernel writes over its own array, or frees it.
    """
    read = _Made(lambda address: _bytes_of(numbers_at(address, shape)))
    written = _Made(lambda address: numbers_at(address, shape))
    x, room = _read_only(shape)
    free = sys.getrefcount(x)

    def function(t: float, place: int, out: int, n: int, d: int, data: int) -> int:
        nonlocal x, room
        try:
            if sys.getrefcount(x) > free:
                x, room = _read_only(shape)
            room[:] = read[place]
            value = DRIFT.call(drift, t, x)
            if type(value) is not np.ndarray or value.dtype is not _FLOAT64 or value.shape != shape:
                value = DRIFT.numbers(value, shape)
            written[out][...] = value
        except BaseException as error:  # noqa: BLE001  # raised again by ``failure``; here it would be printed
            keep(error)
            return 1
        return 0

    return function


class _Made(dict[int, Any]):
    """By address; made when first asked for. The arrays of a run are few."""

    def __init__(self, make: Callable[[int], Any]) -> None:
        self._make = make

    def __missing__(self, address: int) -> Any:
        self[address] = self._make(address)
        return self[address]


def _bytes_of(x: Any) -> memoryview:
    return memoryview(x).cast("B")


def _read_only(shape: tuple[int, ...]) -> tuple[NDArray[np.float64], memoryview]:
    """A read-only array, and its bytes to write to."""
    x = np.empty(shape)
    room = _bytes_of(x)
    x.flags.writeable = False
    return x, room
