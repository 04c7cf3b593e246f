"""A function of Python as compiled code calls it: by its address, and what it raises is raised again outside."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

from dincl.kernels.system import PYTHON
from dincl.run.callback import Callback
from dincl.run.drift_pointer import C_FUNCTION, PLACE

if TYPE_CHECKING:
    from collections.abc import Callable


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
