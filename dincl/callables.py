"""Functions of users: they are called, and their results checked, in one way."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from dincl.checks import attempt, bounded, describe, plain, shape_in_words
from dincl.constants import LARGEST
from dincl.errors import FunctionFailed

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.status import Status

Shape = tuple["int | None", ...]


@dataclass(frozen=True)
class UserFunction:
    """A function of the user: what is known before it is called.

    An Exception that it raises, but a MemoryError, or a wrong result becomes a FunctionFailed. A BaseException such as
    KeyboardInterrupt ends the run.

    Attributes
    ----------
    name, arguments
        Names of the function and of its arguments, for messages: "drift", ("t", "x").
    status
        Status of a run that ends because the function fails.
    """

    name: str
    arguments: tuple[str, ...]
    status: Status

    def call(self, function: Callable[..., Any], *values: Any) -> Any:
        """Return function(*values), whatever it is."""
        try:
            return function(*values)
        except MemoryError:
            raise
        except Exception as error:
            raise self._raised(error, values) from error

    def numbers(self, raw: Any, shape: Shape | None = None) -> NDArray[np.float64]:
        """Return its result as finite float64 numbers, of a shape if one is given; None in ``shape`` is any length."""
        if type(raw) is float and not shape and abs(raw) <= LARGEST:  # as most functions of time return
            return np.array(raw)
        values = plain(raw)
        if values is None or (shape is not None and not fits(values.shape, shape)):
            wanted = "real numbers" + ("" if shape is None else f" of shape {shape_in_words(shape)}")
            found = describe(raw) if values is None else f"an array of shape {values.shape}"
            self.refuse(f"returned {found}: must be {wanted}.")
        if not bounded(values):
            where = tuple(int(k) for k in np.argwhere(~(np.abs(values) <= LARGEST))[0])
            at = f" at index {where}" if where else ""
            self.refuse(f"returned {values[where]}{at}: must be finite, of magnitude at most {LARGEST:g}.")
        return values

    def evaluated(self, function: Callable[..., Any], *values: Any, shape: Shape | None = None) -> NDArray[np.float64]:
        """Return function(*values) as finite numbers, of a shape if one is given."""
        return self.numbers(self.call(function, *values), shape)

    def failed(self, error: BaseException, how: str) -> FunctionFailed:
        """Return the failure for an error of compiled code, whose arguments are not known: ``how`` it failed."""
        said = f"{type(error).__name__}{_said(error)}"
        return FunctionFailed(self.status, f"{self.name}({', '.join(self.arguments)}) {how} {said}.")

    def refuse(self, what: str) -> NoReturn:
        """Raise FunctionFailed; ``what`` is a sentence without its subject."""
        raise FunctionFailed(self.status, f"{self.name} {what}")

    def _raised(self, error: Exception, values: tuple[Any, ...]) -> FunctionFailed:
        given = ", ".join(_given(name, value) for name, value in zip(self.arguments, values, strict=False))
        said = f"{type(error).__name__}{_said(error)}"
        return FunctionFailed(self.status, f"{self.name}({given}) raised {said}.")


def arguments_of(function: Callable[..., Any]) -> int:
    """Return how many arguments a function of the user must be given; 1 if that cannot be found out."""
    try:
        listed = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return 1
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(one.kind in positional and one.default is one.empty for one in listed)


def fits(found: tuple[int, ...], shape: Shape) -> bool:
    """Return whether an array has a shape in which None is any length."""
    return len(found) == len(shape) and all(s is None or s == n for s, n in zip(shape, found, strict=True))


def _given(name: str, value: Any) -> str:
    """Write an argument: "x of shape (4, 2)", "t = 0.5"."""
    if isinstance(value, np.ndarray) and value.ndim:
        return f"{name} of shape {value.shape}"
    return f"{name} = {value:g}" if isinstance(value, float) else f"{name} = {describe(value)}"


def _said(error: BaseException) -> str:
    """Write the message of an error after a colon; nothing if it has none, or raises."""
    text = attempt(str, error)
    return f": {text}" if text else ""
