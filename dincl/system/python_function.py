"""A function of Python as compiled code calls it: by its address, and what it raises is raised again outside."""

from __future__ import annotations

import ctypes
import math
from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.raised import Listener
from dincl.system.arrays import PYTHON

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray


_WORD, PLACE = ctypes.c_int64, ctypes.c_void_p
C_FUNCTION = ctypes.CFUNCTYPE(_WORD, ctypes.c_double, PLACE, PLACE, _WORD, _WORD, PLACE)


def numbers_at(address: int, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """An array on the numbers at an address."""
    buffer: Any = (ctypes.c_double * math.prod(shape)).from_address(address)
    return np.frombuffer(buffer, np.float64).reshape(shape)


class Callback(Listener):
    """A context that keeps an interrupt from before the first line of ``python``, which ctypes would print."""

    python: Any = None

    @property
    def listens(self) -> bool:  # type: ignore[override]
        return self.python is not None

    @abstractmethod
    def keep(self, error: BaseException) -> None:
        """Keep what was raised, until it is raised again."""

    def hears(self, raised: Any) -> bool:
        if raised.object is not self.python:
            return False
        self.keep(raised.exc_value)
        return True


class PythonFunction(Callback):
    """A function (t, x, out, n, d, data), of which x, out and data are addresses, with the signature of ``DRIFT``.

    Attributes
    ----------
    address
        That of the function, as long as this object lives. It returns 0, or PYTHON if the function raised.
    calls
        How often it was called.
    """

    def __init__(self, function: Callable[..., None]) -> None:
        self._function, self.calls = function, 0
        self._error: BaseException | None = None
        self.python: Any = self._call
        self._callback = C_FUNCTION(self.python)
        self.address = int(ctypes.cast(self._callback, PLACE).value or 0)

    def keep(self, error: BaseException) -> None:
        self._error = error

    def failure(self) -> None:
        """Raise what the function raised, if anything."""
        error, self._error = self._error, None
        if error is not None:
            raise error

    def _call(self, t: float, x: int, out: int, n: int, d: int, data: int) -> int:
        self.calls += 1
        try:
            self._function(t, x, out, n, d, data)
        except BaseException as error:  # noqa: BLE001  # raised again by ``failure``; here it would be printed
            self.keep(error)
            return PYTHON
        return 0
