"""Checks of values in parameter files: a ``Check`` reads a value, or says what is allowed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from numbers import Integral, Real
from typing import Annotated, Any

import numpy as np
from pydantic_core import CoreSchema, core_schema

from tissue.events.division import division_rules
from tissue.events.known import events
from tissue.files.own_modules import MODULES, read_modules
from tissue.files.timing import ALLOWED, Timing, timing
from tissue.files.units import (
    DIFFUSION,
    DURATION,
    LENGTH,
    METRIC_LENGTH,
    RATE,
    SPEED,
    Dimension,
    Measure,
    number,
    parse,
)

# Sizes in the units they are kept in: between these, squares and quotients stay finite and positive.
SMALLEST, LARGEST = 1e-12, 1e12
MOST_CELLS = 1_000_000
NONE = "none"
PURE = 'without unit, such as 0.2 or "1/5"'


@dataclass(frozen=True)
class Check:
    """One kind of values, as metadata of a field of pydantic.

    Attributes
    ----------
    says
        What is allowed, for messages; a function where this depends on what is registered.
    unit
        In which values are kept, or of what kind they are, for lists.
    read
        Returns the value that a file gives, or raises ValueError, whose text is the reason or empty.
    write
        The value as a file has it; None: as it is.
    options
        All values, where these are a few.
    """

    says: str | Callable[[], str]
    unit: str
    read: Callable[[Any], Any]
    write: Callable[[Any], Any] | None = None
    options: tuple[Any, ...] = ()

    @property
    def allowed(self) -> str:
        """The values that are allowed, in words."""
        return self.says if isinstance(self.says, str) else self.says()

    def __call__(self, raw: Any) -> Any:
        """Return the value; raises ValueError with what is allowed."""
        try:
            return self.read(raw)
        except ValueError as error:
            reason = f"; {error}" if str(error) else ""
            raise ValueError(f"must be {self.allowed}{reason}") from error

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Tell pydantic to read and write values by this check alone."""
        written = core_schema.plain_serializer_function_ser_schema(self.write) if self.write else None
        return core_schema.no_info_plain_validator_function(self, serialization=written)


def pure_number(*, zero: bool, most: float = LARGEST) -> Check:
    """Return the check of a pure number from 0, or > 0, to ``most``, or a fraction as text."""

    def read(raw: Any) -> float:
        raw = number(raw)
        if not _is(Real, raw) or not _signed(raw, zero) or (most < LARGEST and raw > most):
            raise ValueError
        return abs(float(_sized(raw)))  # one way to write zero

    bound = f"from 0 to {most:g}" if most < LARGEST else ">= 0" if zero else "> 0"
    return Check(f"a number {bound}, {PURE}", f"0 to {most:g}" if most < LARGEST else "number", read)


def quantity(dimension: Dimension, *, zero: bool) -> Check:
    """Return the check of a quantity >= 0, or > 0, given as text with its unit."""

    def read(raw: Any) -> Measure:
        measure = parse(raw, dimension)
        if not _signed(measure.value, zero):
            raise ValueError
        return Measure(abs(_sized(measure.value, f" {measure.unit}")), measure.unit)

    says = f"a {dimension.name} {'>= 0' if zero else '> 0'} with its unit, such as {dimension.examples}"
    return Check(says, " or ".join(dimension.units), read, str)


def count(most: int, least: int = 1) -> Check:
    """Return the check of a whole number from ``least`` to ``most``."""

    def read(raw: Any) -> int:
        if not _is(Integral, raw) or not least <= raw <= most:
            raise ValueError
        return int(raw)

    return Check(f"a whole number from {least} to {most}", "whole number", read)


def one_of(*options: str | int | bool) -> Check:
    """Return the check of one of a few values."""
    return Check(_choice(options), _choice(options), lambda raw: _chosen(raw, options), options=options)


def _choice(options: tuple[Any, ...]) -> str:
    return " or ".join(f'"{option}"' if isinstance(option, str) else f"{option}".lower() for option in options)


def _chosen(raw: Any, options: tuple[Any, ...]) -> Any:
    if not any(type(raw) is type(option) and raw == option for option in options):
        raise ValueError
    return raw


def _read_cap(raw: Any) -> Measure | None:
    return None if raw == NONE else _LENGTH.read(raw)


def _read_time(raw: Any) -> Timing:
    found = timing(raw)
    for time in (found.low, found.high):
        if time is not None:
            _sized(time.value, f" {time.unit}")
    return found


def _event_names() -> str:
    return f'a list of names of events, {", ".join(event.name for event in events())}, such as ["a"]'


def _read_events(raw: Any) -> tuple[str, ...]:
    names = {event.name for event in events()}
    if not isinstance(raw, (list, tuple)) or not all(isinstance(one, str) and one in names for one in raw):
        raise ValueError
    return tuple(dict.fromkeys(raw))


def _read_span(raw: Any) -> tuple[float, float]:
    """Parts of the height; a nucleus on a layer might have no direction to its basal or apical point."""
    pair = tuple(map(number, raw)) if isinstance(raw, (list, tuple)) else ()
    if len(pair) != 2 or not all(_is(Real, part) for part in pair):
        raise ValueError
    low, high = pair
    if not 0 <= low <= high <= 1 or high == 0 or low == 1:
        raise ValueError
    return abs(float(low)), float(high)


def _read_output_times(raw: Any) -> Measure | tuple[Measure, ...]:
    several = isinstance(raw, (list, tuple))
    times = tuple(map(_DURATION.read, raw if several else [raw]))
    if not times or any(late.value <= early.value for early, late in pairwise(times)):
        raise ValueError
    return times if several else times[0]


def _read_points(raw: Any) -> tuple[tuple[Measure, Measure], ...]:
    if not isinstance(raw, (list, tuple)) or not all(isinstance(p, (list, tuple)) and len(p) == 2 for p in raw):
        raise ValueError
    points = tuple((parse(x, LENGTH), parse(y, LENGTH)) for x, y in raw)
    for measure in (part for point in points for part in point):
        _sized(abs(measure.value), f" {measure.unit}")
    return points


def _is(kind: type, raw: Any) -> bool:
    """Return whether this is a number of the kind; true and false are none."""
    return isinstance(raw, kind) and not isinstance(raw, (bool, np.timedelta64))  # that is one for Python


def _signed(value: Any, zero: bool) -> bool:
    """Return whether a number, which may be NaN, has the sign that is allowed."""
    return bool(value >= 0 if zero else value > 0)


def _sized(value: Any, unit: str = "") -> Any:
    """Return a number; raises ValueError for a size that cannot be computed with."""
    if value != 0 and not SMALLEST <= value <= LARGEST:
        raise ValueError(f"only sizes from {SMALLEST:g} to {LARGEST:g}{unit} can be computed with")
    return value


_LENGTH, _DURATION = quantity(LENGTH, zero=False), quantity(DURATION, zero=False)
EVENT_TIME = Check(ALLOWED, "h, %", _read_time, str)
NUMBER_OR_ZERO = pure_number(zero=True)
UNIT_INTERVAL = pure_number(zero=True, most=1.0)
_CAP = Check(f'"{NONE}", or {_LENGTH.allowed}', _LENGTH.unit, _read_cap, lambda cap: str(cap or NONE))
_OUTPUT_TIMES = Check(
    'a duration > 0 with its unit, such as "1 h", or a list of rising times > 0, such as ["10 h", "24 h"]',
    "h",
    _read_output_times,
    lambda times: str(times) if isinstance(times, Measure) else [str(time) for time in times],
)
_POINTS = Check(
    'a list of points, each of two lengths with unit, such as [["0 um", "0 um"], ["50 um", "-10 um"]]',
    "points of two lengths",
    _read_points,
    lambda points: [[str(x), str(y)] for x, y in points],
)
_SPAN = Check(
    'a list of two fractions 0 <= low <= high <= 1, not both 0 and not both 1, such as [0, "1/3"]',
    "two fractions",
    _read_span,
    list,
)
_RULE = Check(
    lambda: _choice(tuple(division_rules())), "a name", lambda raw: str(_chosen(raw, tuple(division_rules())))
)
MetricLength = Annotated[Measure, quantity(METRIC_LENGTH, zero=False)]
Length = Annotated[Measure, _LENGTH]
LengthOrZero = Annotated[Measure, quantity(LENGTH, zero=True)]
LengthOrNone = Annotated[Measure | None, _CAP]
Duration = Annotated[Measure, _DURATION]
DurationOrZero = Annotated[Measure, quantity(DURATION, zero=True)]
Speed = Annotated[Measure, quantity(SPEED, zero=False)]
RateOrZero = Annotated[Measure, quantity(RATE, zero=True)]
DiffusionOrZero = Annotated[Measure, quantity(DIFFUSION, zero=True)]
OutputTimes = Annotated[Measure | tuple[Measure, ...], _OUTPUT_TIMES]
Begin = Annotated[Timing, EVENT_TIME]
Positive = Annotated[float, pure_number(zero=False)]
NonNegative = Annotated[float, NUMBER_OR_ZERO]
Probability = Annotated[float, UNIT_INTERVAL]
Flag = Annotated[bool, one_of(True, False)]
Points = Annotated[tuple[tuple[Measure, Measure], ...], _POINTS]
DivisionRuleName = Annotated[str, _RULE]
Modules = Annotated[tuple[str, ...], Check(MODULES, "files", read_modules, list)]
Fractions = Annotated[tuple[float, float], _SPAN]
Events = Annotated[tuple[str, ...], Check(_event_names, "names of events", _read_events, list)]
