"""What an observable is: a number that is measured of a tissue at one time."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any

from dincl.callables import UserFunction
from dincl.checks import function, string
from dincl.status import Status

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.state.frame import Frame

_NAME, _UNIT = re.compile("[a-z][a-z0-9_]*"), re.compile("[a-z0-9_]*")


@dataclass(frozen=True)
class Observable:
    """A column of ``Run.summary``; one that was registered is also kept of each run of a study, at the kept times.

    Attributes
    ----------
    name, unit
        The column is NAME_UNIT, as "height_um", or NAME where there is no unit: lower-case letters, digits and "_".
    meaning
        One line.
    measure
        ``measure(frame, parameters)``, a finite number; lengths of a frame are in R_soft, times in h.

    Raises
    ------
    InvalidProblem
        If name or unit is none, or ``measure`` no function.
    """

    name: str
    meaning: str
    measure: Callable[[Frame, Parameters], float]
    unit: str = ""

    def __post_init__(self) -> None:
        for key, value, form in (("name", self.name, _NAME), ("unit", self.unit, _UNIT)):
            string(key, value, form, 'lower-case letters, digits and "_"')
        string("meaning", self.meaning)
        function(f"Observable {self.name}: measure", self.measure, "a function of frame and parameters")

    @property
    def column(self) -> str:
        """Its name in tables."""
        return f"{self.name}_{self.unit}" if self.unit else self.name

    def of(self, frame: Frame, parameters: Parameters) -> float:
        """The number; raises FunctionFailed, an InvalidProblem, if it is none, or not finite."""
        name = f"observable {self.name} at t = {frame.t:g} h: measure"
        known = UserFunction(name, ("frame", "parameters"), Status.FUNCTION_FAILED)
        value: Any = known.call(self.measure, frame, parameters)
        checked = known.numbers(value, ())
        return value if isinstance(value, Real) else float(checked)  # type: ignore[return-value]
