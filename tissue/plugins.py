"""Registry of what users add to a tissue: events, forces, rules, observables, variables of cells and parameters."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real
from types import FunctionType
from typing import TYPE_CHECKING, Any, TypeVar

from dincl.callables import UserFunction
from dincl.checks import describe, function, instance, items, number, string, text
from dincl.compiled import inner
from dincl.errors import InvalidProblem
from dincl.status import Status
from tissue.files.quantities import EXAMPLES, KINDS, POWERS, Quantity, read_quantity, sized
from tissue.files.quantities import number as plain_number
from tissue.state.cells import PARAMETERS, VARIABLES

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters
    from tissue.frames.frame import Frame

__all__ = ["DivisionRule", "EmtEvent", "Force", "Observable", "Parameter", "Variable", "inner"]

# Names of events, of forces and observables, of rules of divisions; units of observables.
_LETTERS, _NAME = re.compile("[a-z][a-z0-9]*"), re.compile("[a-z][a-z0-9_]*")
_WORD, _UNIT = re.compile(r"[^\W\d]\w*"), re.compile("[A-Za-z0-9_]*")

# The points of a cell that an event may free.
POINTS = ("apical", "basal")
_SIMPLE = 'lower-case letters, digits and "_"'
Thing = TypeVar("Thing")
# What daughters get of a variable: a x + b, as (a, whether b is the value of the start).
DAUGHTERS = {"copy": (1.0, False), "halves": (0.5, False), "start": (0.0, True)}


def _check(thing: Any, form: re.Pattern[str], words: str, **functions: bool) -> None:
    """Check name, meaning, source and functions of what a user makes; True: a function that may be None."""
    string("name", thing.name, form, words)
    string("meaning", thing.meaning)
    string("source", thing.source)
    for key, optional in functions.items():
        if not (optional and getattr(thing, key) is None):
            what = "a function, or None" if optional else "a function"
            instance(f"{type(thing).__name__} {thing.name}: {key}", getattr(thing, key), FunctionType, what)


def registry(kind: type) -> dict[str, Any]:
    """Return what was registered of a kind, by name, the first one first."""
    return _REGISTERED.setdefault(kind, {})


def _column(thing: Any) -> str:
    """Return the name of a column of a name and a unit."""
    return f"{thing.name}_{thing.unit}" if thing.unit else thing.name


def registered(kind: type[Thing]) -> tuple[Thing, ...]:
    """Return what was registered of a kind in the order of the names: the order of imports may differ in another
    process.
    """
    return tuple(thing for _, thing in sorted(registry(kind).items()))


@dataclass(frozen=True)
class EmtEvent:
    """An event that begins once in a cell, at a time that the parameters give.

    It fires in the step dt that ends at its time, or in which its time lies, and acts from the beginning of that step.
    Its functions are plain Python at top level of a file; numba compiles them, alone, when a run first needs them, and
    any function that they call must be marked with ``tissue.inner``. They change the state in place.

    Attributes
    ----------
    name
        Its key in the section [emt] of parameter files: lower-case letters and digits. Tables have ``mark``, and the
        column ``t_NAME_h``.
    meaning, source
        One line each: what happens, and who says so.
    begin
        ``begin(state, i, bit, numbers)``, called once, for cell i; ``numbers`` are those of its type. ``bit``: that of
        this event, as in ``state.cells.events``, which does not have it yet; ``state.emt.new`` has the bits of all
        events that begin in the same step. None: nothing happens at once.
    last
        ``last(state, i, rest_ax, rest_bx, numbers)``, called for each dt from then on, after the rest lengths of the
        springs have relaxed as in other cells; given are those before. Built-in events are called first,
        then others by name.
    after
        The name of an event that this one waits for, so that it begins at the later time of both.
    starts
        The names of events whose times the functions set, ``state.emt.at[k, state.cells.emt[i]] = state.t``: they
        begin in the next dt, also where the parameters say that they never do.
    frees
        "apical" or "basal": the spring to this point holds nothing from then on, and so does not count where the rest
        lengths of a cell have a cap. None: neither.

    Raises
    ------
    InvalidProblem
        If the name is none, there is nothing to do, or ``begin`` or ``last`` is no function.
    """

    name: str
    meaning: str
    source: str
    begin: Callable[..., None] | None = None
    last: Callable[..., None] | None = None
    after: str | None = None
    starts: tuple[str, ...] = ()
    frees: str | None = None

    def __post_init__(self) -> None:
        _check(self, _LETTERS, "lower-case letters and digits", begin=True, last=True)
        if self.after is not None:
            string(f"EmtEvent {self.name}: after", self.after)
        items(f"EmtEvent {self.name}: starts", self.starts, str, "names of events")
        if self.frees not in (None, *POINTS):
            raise InvalidProblem(f'EmtEvent {self.name}: frees = {self.frees!r}: must be "apical", "basal" or None')
        if self.begin is None and self.last is None:
            raise InvalidProblem(f"EmtEvent {self.name}: must have a function begin, last, or both")

    @property
    def mark(self) -> str:
        """How tables, pictures and pages write it: "A" for "a"; marks that are put together can be told apart."""
        return "AC" if self.name == "ac" else self.name.capitalize()


@dataclass(frozen=True)
class Force:
    """A force on points of cells, -grad W, beside those of the thesis: mu dZ/dt = -grad (W_thesis + W) + ....

    It acts in each substep, at the same positions as the other forces. Its functions are plain Python at top level of a
    file; numba compiles them, alone, when a run first needs them, and any function that they call must be one of
    ``tissue.inner``. They make no arrays. Lengths are in R_soft, W has no unit.

    Attributes
    ----------
    name
        Its key in the section [forces] of parameter files, where its strength is, a number >= 0 without unit; 0, the
        default: it is not called. Lower-case letters, digits and "_".
    push
        ``push(state, on, strength, numbers)`` adds to ``on``: ``on.x[i]``, ``on.y[i]`` on the nucleus of cell i,
        ``on.ax[i]``, ``on.ay[i]`` on its apical and ``on.bx[i]``, ``on.by[i]`` on its basal point, in space also to
        ``on.z[i]``, ``on.az[i]``, ``on.bz[i]``. These points are now at ``state.cells.x[i]``, ...,
        ``state.cells.by[i]``, i < ``state.sizes[0]``; all else in the state is as the rules have left it, and stays so.
        A basal point that the basal layer holds follows the part along the layer. ``state.t`` is the end of this dt.
    meaning, source
        One line each.
    energy
        ``energy(state, strength, numbers)``, W of the whole tissue; with it ``tissue.force_error`` tests ``push``.

    Raises
    ------
    InvalidProblem
        If the name is none, ``push`` or ``energy`` is no function, or another argument no text.
    """

    name: str
    push: Callable[..., None]
    meaning: str
    source: str = ""
    energy: Callable[..., float] | None = None

    def __post_init__(self) -> None:
        _check(self, _NAME, _SIMPLE, push=False, energy=True)


@dataclass(frozen=True)
class Observable:
    """A column of ``Run.summary``; one that was registered is also kept of each run of a study, at the output times.

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
            string(key, value, form, _SIMPLE)
        string("meaning", self.meaning)
        function(f"Observable {self.name}: measure", self.measure, "a function of frame and parameters")

    @property
    def column(self) -> str:
        """Its name in tables."""
        return _column(self)

    def of(self, frame: Frame, parameters: Parameters) -> float:
        """Return the number; raises FunctionFailed, an InvalidProblem, if it is none, or not finite."""
        name = f"observable {self.name} at t = {frame.t:g} h: measure"
        known = UserFunction(name, ("frame", "parameters"), Status.FUNCTION_FAILED)
        value: Any = known.call(self.measure, frame, parameters)
        checked = known.numbers(value, ())
        return value if isinstance(value, Real) else float(checked)  # type: ignore[return-value]


@dataclass(frozen=True)
class DivisionRule:
    """Whether a cell splits when its cycle ends, and where its daughters are; ``rule`` in the section [division].

    Cells of [emt], and of types that do not divide, never split; all others are asked. ``numbers`` are those of the
    type of the cell. Functions are plain Python at top level of a file; numba compiles them, alone, when a run first
    needs them.

    Attributes
    ----------
    name
        That of the rule in parameter files.
    meaning, source
        One line each.
    splits
        ``splits(state, i, number, numbers)``: whether cell i gets a second daughter in the plane; ``number`` is random,
        uniform in [0, 1).
    place
        ``place(state, i, numbers)``: parts the daughters i and i + 1, which are copies of the mother in one place.

    Raises
    ------
    InvalidProblem
        If the name is none, or ``splits`` or ``place`` is no function.
    """

    name: str
    meaning: str
    source: str
    splits: Callable[..., bool]
    place: Callable[..., None]

    def __post_init__(self) -> None:
        _check(self, _WORD, "letters, digits and _", splits=False, place=False)


@dataclass(frozen=True)
class Variable:
    """A number of each cell, which functions of users read and write: ``state.cells.NAME[i]``.

    Nothing else changes it but divisions. It is in saved states, and a column of ``Run.table``.

    Attributes
    ----------
    name, unit
        The column is NAME_UNIT, or NAME where there is no unit. Letters, digits and "_"; those of the name lower-case.
    meaning
        One line.
    start
        Its value in all cells at the start.
    daughters
        What a cell has of it when its cycle ends in a division, with a daughter in the tissue or not: a "copy" of its
        mother's, or what "halves" it, or the "start" value.

    Raises
    ------
    InvalidProblem
        If name or unit is none, ``start`` no finite number, or ``daughters`` none of these.
    """

    name: str
    meaning: str
    unit: str = ""
    start: float = 0.0
    daughters: str = "copy"

    def __post_init__(self) -> None:
        string("name", self.name, _NAME, _SIMPLE)
        string("unit", self.unit, _UNIT, 'letters, digits and "_"')
        string("meaning", self.meaning)
        object.__setattr__(self, "start", number(f"Variable {self.name}: start", self.start))
        text(f"Variable {self.name}: daughters", self.daughters, tuple(DAUGHTERS))

    @property
    def column(self) -> str:
        """Its name in tables."""
        return _column(self)

    @property
    def heirs(self) -> tuple[float, float]:
        """The numbers a and b of a x + b, what a daughter has of x."""
        part, fresh = DAUGHTERS[self.daughters]
        return part, fresh * self.start


@dataclass(frozen=True)
class Parameter:
    """A key ``own.NAME`` of parameter files, and a number ``numbers.NAME`` for functions of users.

    Cells of a named type may have another value, the key ``types.TYPE.own.NAME``, for events and rules of divisions.

    Attributes
    ----------
    name
        Lower-case letters, digits and "_".
    meaning, source
        One line each.
    default
        As in a file, where it is not given: "0.5 1/h", or 3 for a number without unit.
    unit
        "um", "h", "1/h", "um/h" or "um^2/h": values may have any unit of this kind, and ``numbers`` has lengths over
        R_soft and times in h. Any other unit is written behind each value; "" for numbers without unit.
    least, most
        The range, in this unit.

    Raises
    ------
    InvalidProblem
        If the name is none, or the default no such value.
    """

    name: str
    meaning: str
    default: Any
    unit: str = ""
    least: float = 0.0
    most: float = math.inf
    source: str = ""

    def __post_init__(self) -> None:
        _check(self, _NAME, _SIMPLE)
        string("unit", self.unit)
        for name in ("least", "most"):
            if not isinstance(getattr(self, name), Real) or math.isnan(getattr(self, name)):
                raise InvalidProblem(f"{name} = {describe(getattr(self, name))}: must be a number, or inf")
        try:
            self.read(self.default)
        except ValueError as error:
            must = f"must be {self.allowed}; {error}"
            raise InvalidProblem(f"Parameter {self.name}: default = {describe(self.default)}: {must}") from None

    @property
    def allowed(self) -> str:
        """The values of a file, in words."""
        kind = KINDS.get(self.unit, "")
        what = f"a {kind}" if kind else "a number" + ("" if self.unit else " without unit")
        such = EXAMPLES.get(kind, f'"1 {self.unit}"' if self.unit else '0.2 or "1/5"')
        return f"{what} from {self.least:g} to {self.most:g}{f' {self.unit}' if self.unit else ''}, such as {such}"

    def read(self, raw: Any) -> Quantity | float:
        """Return the value that a file gives; raises ValueError for none, whatever the range is."""
        if self.unit:
            return read_quantity(raw, KINDS.get(self.unit, self.unit), "")
        value = plain_number(raw)
        if not isinstance(value, float):
            raise ValueError("it must have no unit")  # noqa: TRY004 - input errors are of one class
        return sized(value)

    def fits(self, value: Quantity | float, soft_radius: float) -> bool:
        """Return whether a value is in the range; ``soft_radius`` [um]."""
        if isinstance(value, Quantity):
            is_over = value.unit.startswith("R_soft")
            value = value.value * (soft_radius ** POWERS.get(self.unit, 0) if is_over else 1.0)
        return self.least <= value <= self.most


_REGISTERED: dict[type, dict[str, Any]] = {Variable: VARIABLES, Parameter: PARAMETERS}
