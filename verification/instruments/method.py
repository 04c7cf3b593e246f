"""A method: what turns a setting into positions, with a name and a family."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeVar

from dincl import InvalidProblem, Scheme
from dincl.checks import describe

T = TypeVar("T")
SchemeOf = Callable[[float], Scheme]
Methods = Mapping[str, "Method | SchemeOf"] | Sequence["Method"]


@dataclass(frozen=True)
class Method:
    """A way to solve problems, with one setting that fixes its accuracy.

    Give either ``scheme`` or ``run``; the second lets any program stand beside the schemes of ``dincl``.

    Parameters
    ----------
    label
        The name in tables and legends.
    family
        Methods of one family are drawn in one colour, and the best of each family is found; "" is the label itself.
    scheme
        setting -> Scheme, such as ``dincl.PBD``.
    run
        (problem, setting, t) -> the states at the times t, an array whose first axis is time: (K, N, d) for particles.
    setting
        What the setting is: "dt" [time], or "tol" [length] of a method that chooses its steps.
    compiled
        Whether its steps run without Python, as charts then say; None: unknown for ``run``, and for ``scheme`` true of
        runs that count no callbacks.
    look
        Keywords of matplotlib, such as ``color`` and ``marker``, where the chart is not to choose.

    Raises
    ------
    InvalidProblem
        If neither or both of ``scheme`` and ``run`` are given, or what is given cannot be called.
    """

    label: str
    family: str = ""
    scheme: SchemeOf | None = None
    run: Callable[[Any, float, Any], Any] | None = None
    setting: str = "dt"
    compiled: bool | None = None
    look: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        given = [name for name in ("scheme", "run") if getattr(self, name) is not None]
        if not isinstance(self.label, str) or not self.label:
            raise InvalidProblem(f"label = {describe(self.label)}: must be a name")
        if len(given) != 1 or not callable(getattr(self, given[0])):
            raise InvalidProblem(
                f"method {self.label!r}: give scheme, a function setting -> Scheme, or run, a function "
                f"(problem, setting, t) -> states; given are {', '.join(given) or 'neither'}"
            )
        object.__setattr__(self, "family", self.family or self.label)


class Failure(NamedTuple):
    """How a run failed: REFUSED, LEFT_OUT or FAILED, the reason, and the exception."""

    status: str
    detail: str
    error: Exception

    @property
    def columns(self) -> dict[str, str]:
        """The columns of its row."""
        return {"status": self.status, "detail": self.detail}


def attempted(function: Callable[..., T], *arguments: Any) -> T | Failure:
    """Call what a method or a user wrote; an Exception of any kind becomes a Failure, so that no other row is lost.

    REFUSED: the method cannot serve the problem (InvalidProblem). LEFT_OUT: a library is missing. FAILED: anything
    else. KeyboardInterrupt and other exceptions that are no Exception stop the study, as does the end of a budget.
    """
    try:
        return function(*arguments)
    except ModuleNotFoundError as missing:
        return Failure("LEFT_OUT", _words(missing), missing)
    except InvalidProblem as refusal:
        return Failure("REFUSED", _words(refusal), refusal)
    except Exception as failure:  # noqa: BLE001  # whatever a method raises is its result
        return Failure("FAILED", f"{type(failure).__name__}: {_words(failure)}", failure)


def _words(error: Exception) -> str:
    """Return the message of an error, which may fail to make one, or have half a character in it."""
    try:
        return str(error).encode("utf-8", "backslashreplace").decode("utf-8")
    except Exception:  # noqa: BLE001  # as a method's own error does
        return "an error without a message"


def made_scheme(label: str, made: Any, setting: str) -> Scheme:
    """Return what a method made of its setting, "0.1" or "dt = 0.1"; InvalidProblem unless it is a Scheme."""
    if not isinstance(made, Scheme):
        raise InvalidProblem(
            f"method {label!r} made {describe(made)} of the setting {setting}: must make a dincl.Scheme"
        )
    return made


def as_methods(methods: Methods) -> tuple[Method, ...]:
    """Return a list of methods from the allowed forms: label -> (setting -> scheme), or Method objects.

    Raises
    ------
    InvalidProblem
        If the list is empty, an entry is neither a Method nor a callable, or two entries have the same label.
    """
    if isinstance(methods, Mapping):
        pairs = [(str(label), method) for label, method in methods.items()]
    elif isinstance(methods, list | tuple):
        pairs = [(getattr(method, "label", ""), method) for method in methods]
    else:
        raise InvalidProblem(f"methods = {describe(methods)}: must map labels to methods, or be a list of Method")
    found = tuple(_as_method(label, method) for label, method in pairs)
    labels = [method.label for method in found]
    twice = {label for label in labels if labels.count(label) > 1}
    if twice or not found:
        what = f"has two named {sorted(twice)}: labels must differ" if found else "has no entry: must have one or more"
        raise InvalidProblem(f"methods {what}")
    return found


def _as_method(label: str, method: object) -> Method:
    if isinstance(method, Method):
        return method
    if not label:
        raise InvalidProblem(f"methods holds {describe(method)}: a list must hold Method; or map labels to functions")
    if not callable(method):
        raise InvalidProblem(
            f"methods[{label!r}] = {describe(method)}: must be a Method or a function setting -> Scheme"
        )
    return Method(label, scheme=method)
